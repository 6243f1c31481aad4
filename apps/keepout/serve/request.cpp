// SPDX-License-Identifier: BSD-3-Clause
#include "serve/request.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <ranges>
#include <set>
#include <utility>

#include "keepout/robot/instrument_options.h"
#include "keepout/step/guide.h"
#include "serve/answer.h"
#include "shared/names.h"

namespace keepout::app {
namespace {

constexpr int deepest = 8;  // more levels than any request needs

[[noreturn]] void refuse_as_json(const std::string& why) {
  throw Refusal{"not_json", "the line is not JSON: " + why};
}

template <class Names>
std::string quoted(const Names& names) {
  std::string list;
  for (const std::string_view name : names) list += (list.empty() ? "" : ", ") + in_quotes(name);
  return list;
}

bool is_id(const Json& value) {
  return value.is_null() || value.is_number_integer() ||
         (value.is_string() && value.get_ref<const std::string&>().size() <= longest_id);
}

bool fits(const Json& value, const Field& field) {
  if (field.option != nullptr) return option_value(value, field.option->kind).has_value();
  const auto is_item = [&](const Json& item) {
    return field.is_text ? item.is_string() : field.is_flag ? item.is_boolean() : item.is_number();
  };
  const auto is_row = [&](const Json& row) {
    return row.is_array() && field.columns.has(row.size()) && std::ranges::all_of(row, is_item);
  };
  if (field.rank == 0) return is_item(value);
  if (field.rank == 1) return is_row(value);
  return value.is_array() && field.rows.has(value.size()) &&
         std::ranges::all_of(value, [&](const Json& row) {
           return is_row(row) && row.size() == value.front().size();
         });
}

/// Returns the line as JSON. Sets the id as soon as it is read, so that it is known for an
/// incomplete line. Throws the library's exceptions, and Refusal for faults that are not visible in
/// the value.
Json parsed(std::string_view line, std::string& id) {
  std::set<std::string> keys;
  std::string key;
  std::string given_twice;
  const auto listen = [&](int depth, Json::parse_event_t event, const Json& value) {
    if (depth > deepest) refuse("the line is nested more deeply than any request");
    if (depth == 1 && event == Json::parse_event_t::key) {
      key = value.get_ref<const std::string&>();
      if (!keys.insert(key).second) given_twice = key;
    } else if (depth == 1 && event == Json::parse_event_t::value && key == "id" && is_id(value)) {
      id.clear();
      value.is_string() ? append_string(id, value.get_ref<const std::string&>())
                        : void(id = value.dump());
    }
    return true;
  };
  Json json = Json::parse(line.begin(), line.end(), listen);
  if (!given_twice.empty()) refuse(in_quotes(given_twice) + " is given twice");
  return json;
}

/// Returns the library's message in printable characters, and only the useful part of the line.
std::string cause(std::string_view text) {
  if (const std::size_t at = text.find("column "); at != std::string_view::npos) {
    text.remove_prefix(at);
  } else if (const std::size_t end = text.find("] "); end != std::string_view::npos) {
    text.remove_prefix(end + 2);  // the library's error number
  }
  return printable(text);
}

void append_numbers(const Json& value, std::vector<double>& numbers) {
  if (value.is_array()) {
    for (const Json& item : value) append_numbers(item, numbers);
  } else {
    // The parser returns a signed integer 0 only for "-0", which C++ prints for a negative zero.
    const bool is_negative_zero = value.type() == Json::value_t::number_integer && value == 0;
    numbers.push_back(is_negative_zero ? -0.0 : value.get<double>());
  }
}

std::vector<Field> fields_within(const RequestLimits& limits) {
  const auto up_to = [](std::size_t count) { return "at most " + std::to_string(count); };
  const auto number = [](std::string_view name) { return Field{name, "a number"}; };
  const auto vector = [](std::string_view name) {
    return Field{name, "an array of three numbers", 1, {3, 3}};
  };
  const auto of_joints = [](std::string_view name) {
    return Field{name,
                 "an array of one number for each joint of the instrument",
                 1,
                 {1, Chain::most_joints}};
  };
  const auto rows_of = [](std::string_view name, std::string expected, Field::Count columns,
                          Field::Count rows) {
    return Field{name, std::move(expected), 2, columns, rows};
  };
  std::vector<Field> fields{
      vector("tip"),
      vector("desired"),
      rows_of("jacobian",
              "three arrays, the rows of the Jacobian, of one number for each joint, " +
                  up_to(limits.joints) + " (--joints)",
              {1, limits.joints}, {3, 3}),
      rows_of("rows",
              "an array of arrays of one number for each joint, or three without a Jacobian, " +
                  up_to(limits.rows) + " of them (--rows)",
              {1, std::max<std::size_t>(limits.joints, 3)}, {0, limits.rows}),
      {"bounds",
       "an array of one number for each of the rows, " + up_to(limits.rows) + " (--rows)",
       1,
       {0, limits.rows}},
      number("radius"),
      rows_of("motions",
              "an array of arrays of six numbers, tip and desired increment, " +
                  up_to(limits.motions) + " of them",
              {6, 6}, {0, limits.motions}),
      number("scale"),
      rows_of("frame", "four arrays of four numbers, a homogeneous matrix", {4, 4}, {4, 4}),
      rows_of(
          "capsules",
          "an array of arrays of nine numbers, a link and a point of it, another, and a radius; at "
          "least one, and " +
              up_to(Instrument::most_bodies),
          {9, 9}, {1, Instrument::most_bodies}),
      of_joints("q"),
      vector("linear"),
      vector("angular"),
      of_joints("increment"),
      of_joints("weights"),
      number("mesh")};
  for (const char* name : {"urdf", "bodies", "base_link", "tip_link", "tool", "narrow_phase", "of",
                           "file", "unit", "space", "untagged", "index", "solver"}) {
    fields.push_back({.name = name, .expected = "a string", .is_text = true});
  }
  fields.push_back({.name = "flip", .expected = "true or false", .is_flag = true});
  for (const auto& option : instrument_options) {
    fields.push_back({.name = option.name, .expected = option.expected(), .option = &option});
  }
  fields.push_back({.name = "guides",
                    .expected = "an array of strings, " + up_to(Guide::most),
                    .rank = 1,
                    .columns = {0, Guide::most},
                    .is_text = true});
  return fields;
}

}  // namespace

void refuse(std::string message) { throw Refusal{"not_a_request", std::move(message)}; }

RequestReader::RequestReader(const RequestLimits& limits, std::span<const Verb> verbs)
    : fields_(fields_within(limits)), verbs_(verbs) {}

const Verb& RequestReader::read(std::string_view line, std::string& id, Json& request) const {
  id = "null";
  // The library would read it as the end of the line.
  if (const std::size_t at = line.find('\0'); at != std::string_view::npos) {
    refuse_as_json("column " + std::to_string(at + 1) + ": a NUL byte");
  }
  try {
    request = parsed(line, id);
  } catch (const Json::exception& error) {
    refuse_as_json(cause(error.what()));
  }
  check_values(request);
  return checked_verb(request);
}

/// Throws Refusal unless each key is known and its value is valid for its field.
void RequestReader::check_values(const Json& request) const {
  if (!request.is_object()) {
    refuse("a request is one object on a line: {\"id\":1,\"do\":\"ping\"}");
  }
  for (const auto& [key, value] : request.get_ref<const Json::object_t&>()) {
    if (key == "id") {
      if (is_id(value)) continue;
      refuse("'id' must be a whole number of at most 64 bits, a string of at most " +
             std::to_string(longest_id) + " bytes, or null");
    }
    if (key == "do") {
      if (value.is_string()) continue;
      refuse("'do' must be one of " + quoted(verbs_ | std::views::transform(&Verb::name)));
    }
    const auto field = std::ranges::find(fields_, key, &Field::name);
    if (field == fields_.end()) {
      refuse("there is no key " + in_quotes(key) + " in a request; see 'keepout serve --help'");
    }
    if (!fits(value, *field)) refuse(in_quotes(key) + " must be " + field->expected);
  }
}

/// Returns the verb of a request. Throws Refusal unless the request has all keys that the verb
/// needs, and no other key than the verb takes.
const Verb& RequestReader::checked_verb(const Json& request) const {
  const std::string asked = request.value("do", std::string());
  const auto verb = std::ranges::find(verbs_, asked, &Verb::name);
  if (verb == verbs_.end()) {
    const std::string known = quoted(verbs_ | std::views::transform(&Verb::name));
    refuse(asked.empty() ? "'do' is missing: it must be one of " + known
                         : "there is nothing to do by the name " + in_quotes(asked) +
                               "; 'do' must be one of " + known);
  }
  std::vector<std::string_view> takes{"id", "do"};
  takes.insert(takes.end(), verb->needed.begin(), verb->needed.end());
  takes.insert(takes.end(), verb->optional.begin(), verb->optional.end());
  for (const Field& field : fields_) {
    const bool is_given = request.contains(field.name);
    if (!is_given && std::ranges::find(verb->needed, field.name) != verb->needed.end()) {
      refuse(in_quotes(field.name) + " is missing: " + in_quotes(verb->name) + " needs it, " +
             field.expected);
    }
    if (is_given && std::ranges::find(takes, field.name) == takes.end()) {
      refuse(in_quotes(field.name) + " is not a key that " + in_quotes(verb->name) +
             " takes; it takes " + quoted(takes));
    }
  }
  return *verb;
}

std::optional<OptionValue> option_value(const Json& value, OptionKind kind) {
  if (kind == OptionKind::number && value.is_number()) return value.get<double>();
  if (kind == OptionKind::whole_number && value.is_number_integer()) {
    return value.get<std::int64_t>();
  }
  if (kind == OptionKind::flag && value.is_boolean()) return value.get<bool>();
  if (kind == OptionKind::choice && value.is_string()) return value.get<std::string>();
  return std::nullopt;
}

std::vector<double> numbers(const Json& value) {
  std::vector<double> numbers;
  append_numbers(value, numbers);
  return numbers;
}

std::vector<double> numbers(const Json& request, std::string_view key) {
  return request.contains(key) ? numbers(request[key]) : std::vector<double>();
}

}  // namespace keepout::app
