// SPDX-License-Identifier: BSD-3-Clause
#include "serve/request.h"

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "keepout/robot/instrument_options.h"
#include "keepout/step/guide.h"
#include "serve/answer.h"
#include "shared/names.h"

namespace keepout::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t longest_id = 128;  // [bytes]
constexpr int deepest = 8;               // more than any request needs

/// JSON, but no request.
[[noreturn]] void refuse(std::string message) {
  throw Refusal{"not_a_request", std::move(message)};
}

[[noreturn]] void refuse_as_json(const std::string& why) {
  throw Refusal{"not_json", "the line is not JSON: " + why};
}

constexpr std::array<VerbKeys, 12> verbs{
    {{"step", Verb::step, {"tip", "desired"}, {"jacobian", "rows", "bounds"}},
     {"steps", Verb::steps, {"motions"}, {}},
     {"polytope", Verb::polytope, {"tip", "radius"}, {}},
     {"instrument",
      Verb::instrument,
      {"urdf", "capsules"},
      {"base_link", "tip_link", "scale", "frame"},
      true},
     {"joint_step", Verb::joint_step, {"q"}, {"linear", "angular", "increment", "weights"}},
     {"tool", Verb::tool, {"tool"}, {"narrow_phase"}},
     {"guides", Verb::guides, {"guides"}, {"of"}},
     {"anatomy", Verb::anatomy, {"file"}, {"margin"}},
     {"place", Verb::place, {"mesh", "frame"}, {"linear", "angular"}},
     {"info", Verb::info, {}, {}},
     {"statuses", Verb::statuses, {}, {}},
     {"ping", Verb::ping, {}, {}}}};

void add_to_list(std::string& list, std::string_view name) {
  if (!name.empty()) list += (list.empty() ? "" : ", ") + in_quotes(name);
}

std::string verb_list() {
  std::string list;
  for (const VerbKeys& known : verbs) add_to_list(list, known.name);
  return list;
}

template <class Names, class Project = std::identity>
bool contains(const Names& names, std::string_view name, Project project = {}) {
  return std::ranges::find(names, name, project) != names.end();
}

/// Returns the value of that name, or null.
template <class Values>
auto* named(Values& values, std::string_view name) noexcept {
  const auto found = std::ranges::find_if(values, [&](const auto& v) { return v.name == name; });
  return found == values.end() ? nullptr : &*found;
}

bool is_id(const Json& value) {
  return value.is_null() || value.is_number_integer() ||
         (value.is_string() && value.get_ref<const std::string&>().size() <= longest_id);
}

void take_id(const Json& value, std::string& id) {
  if (value.is_string()) {
    id.clear();
    append_string(id, value.get_ref<const std::string&>());
  } else {
    id = value.dump();
  }
}

/// Fills the table with a value; false where it has not the shape.
bool fill(NumberTable& table, const Json& value) {
  const auto add = [&](const Json& number) {
    if (!number.is_number()) return false;
    // Of integers with a sign, only "-0" is zero: what C++ prints for a negative zero.
    const bool is_negative_zero = number.type() == Json::value_t::number_integer && number == 0;
    table.numbers.push_back(is_negative_zero ? -0.0 : number.get<double>());
    return true;
  };
  const TableShape& shape = table.shape;
  const auto add_row = [&](const Json& row) {
    if (!row.is_array() || row.size() < shape.fewest_columns || row.size() > shape.most_columns) {
      return false;
    }
    if (table.rows++ > 0 && row.size() != table.columns) return false;
    table.columns = row.size();
    return std::ranges::all_of(row, add);
  };
  if (shape.rank == 1) return add_row(value);
  if (shape.rank == 2) {
    return value.is_array() && value.size() >= shape.fewest_rows &&
           value.size() <= shape.most_rows && std::ranges::all_of(value, add_row);
  }
  table.rows = table.columns = 1;
  return add(value);
}

/// Takes the value of an option; false if it is of another kind.
bool fill(OptionOfRequest& option, const Json& value) {
  const OptionKind kind = option.option->kind;
  if (kind == OptionKind::number && value.is_number()) {
    option.value = value.get<double>();
  } else if (kind == OptionKind::whole_number && value.is_number_integer()) {
    option.value = value.get<std::int64_t>();
  } else if (kind == OptionKind::flag && value.is_boolean()) {
    option.value = value.get<bool>();
  } else if (kind == OptionKind::choice && value.is_string()) {
    option.value = value.get<std::string>();
  } else {
    return false;
  }
  return true;
}

/// Fills the request with a line; what a request must have beside is checked by check(). Throws
/// Refusal.
void take(const Json& line, Request& request) {
  if (!line.is_object()) {
    refuse("a request is one object on a line: {\"id\":1,\"do\":\"ping\"}");
  }
  for (const auto& [key, value] : line.get_ref<const Json::object_t&>()) {
    if (key == "id") {
      if (is_id(value)) continue;
      refuse("'id' must be a whole number of at most 64 bits, a string of at most " +
             std::to_string(longest_id) + " bytes, or null");
    }
    if (key == "do") {
      if (!value.is_string()) refuse("'do' must be one of " + verb_list());
      continue;
    }
    if (TextValue* const text = named(request.texts, key)) {
      if (!value.is_string()) refuse(in_quotes(key) + " must be a string");
      text->is_given = true;
      text->text = value.get_ref<const std::string&>();
      continue;
    }
    if (OptionOfRequest* const option = named(request.options, key)) {
      option->is_given = fill(*option, value);
      if (!option->is_given) refuse(in_quotes(key) + " must be " + option->option->expected());
      continue;
    }
    if (key == request.guides.name) {
      TextList& list = request.guides;
      list.is_given = value.is_array() && value.size() <= list.most &&
                      std::ranges::all_of(value, [](const Json& v) { return v.is_string(); });
      if (!list.is_given) {
        refuse(in_quotes(key) + " must be an array of strings, at most " +
               std::to_string(list.most));
      }
      for (const Json& text : value) list.texts.push_back(text.get<std::string>());
      continue;
    }
    NumberTable* const table = named(request.tables, key);
    if (table == nullptr) {
      refuse("there is no key " + in_quotes(key) + " in a request; see 'keepout serve --help'");
    }
    table->is_given = fill(*table, value);
    if (!table->is_given) refuse(in_quotes(key) + " must be " + table->description);
  }
}

/// Throws Refusal unless a value is given just where the verb takes it.
void check(std::string_view value, bool is_given, const std::string& description,
           const VerbKeys& verb) {
  if (verb.needs(value) && !is_given) {
    refuse(in_quotes(value) + " is missing: " + in_quotes(verb.name) + " needs it, " + description);
  }
  if (!is_given || verb.takes(value)) return;
  std::string takes = "'id', 'do'";
  for (const std::string_view name : verb.needed) add_to_list(takes, name);
  for (const std::string_view name : verb.optional) add_to_list(takes, name);
  if (verb.takes_options) {
    for (const auto& option : instrument_options) add_to_list(takes, option.name);
  }
  refuse(in_quotes(value) + " is nothing that " + in_quotes(verb.name) + " takes; it takes " +
         takes);
}

/// Whether all is there that `asked`, the value of 'do', needs, and fits together. Throws
/// Refusal.
void check(Request& request, const std::string& asked) {
  const auto known = std::ranges::find(verbs, asked, &VerbKeys::name);
  if (known == verbs.end()) {
    refuse(asked.empty() ? "'do' is missing: say what to do, one of " + verb_list()
                         : "there is nothing to do by the name " + in_quotes(asked) +
                               "; 'do' must be one of " + verb_list());
  }
  request.verb = known->verb;
  for (const NumberTable& table : request.tables) {
    check(table.name, table.is_given, table.description, *known);
  }
  for (const TextValue& text : request.texts) check(text.name, text.is_given, "a string", *known);
  for (const OptionOfRequest& option : request.options) {
    check(option.name, option.is_given, option.option->expected(), *known);
  }
  check(request.guides.name, request.guides.is_given, "an array of strings", *known);
  const TextValue& of = request.text("of");
  if (of.is_given && of.text != "tip" && of.text != "instrument") {
    refuse("'of' must be 'tip' or 'instrument'");
  }
  if (request.verb == Verb::joint_step) {
    const bool has_twist = request.table("linear").is_given || request.table("angular").is_given;
    if (has_twist == request.table("increment").is_given) {
      refuse("a 'joint_step' takes either 'linear' or 'angular' of the flange, or an 'increment'");
    }
    if (has_twist && request.table("weights").is_given) {
      refuse("'weights' belong to an 'increment'");
    }
  }
  const NumberTable& rows = request.table("rows");
  const NumberTable& bounds = request.table("bounds");
  const NumberTable& jacobian = request.table("jacobian");
  if (rows.is_given != bounds.is_given) {
    refuse("'rows' and 'bounds' belong together: rows . u >= bounds");
  }
  if (rows.rows != bounds.columns) refuse("'bounds' must have one number for each of the 'rows'");
  if (rows.rows > 0 && rows.columns != (jacobian.is_given ? jacobian.columns : 3)) {
    refuse(
        "each of the 'rows' must have one number for each column of the 'jacobian', or three "
        "without one");
  }
}

/// The line as JSON. The id is taken as soon as it is read, for a line that breaks off. Throws what
/// the library throws, and Refusal, for what its value no longer tells.
Json parsed(std::string_view line, Request& request) {
  std::set<std::string> keys;
  std::string key;
  std::string given_twice;
  const auto listen = [&](int depth, Json::parse_event_t event, const Json& value) {
    if (depth > deepest) refuse("the line is nested more deeply than any request");
    if (depth == 1 && event == Json::parse_event_t::key) {
      key = value.get_ref<const std::string&>();
      if (!keys.insert(key).second) given_twice = key;
    } else if (depth == 1 && event == Json::parse_event_t::value && key == "id" && is_id(value)) {
      take_id(value, request.id);
    }
    return true;
  };
  Json json = Json::parse(line.begin(), line.end(), listen);
  if (!given_twice.empty()) refuse(in_quotes(given_twice) + " is given twice");
  return json;
}

/// What the library says, in printable characters, and no more of the line than helps.
std::string cause(std::string_view text) {
  if (const std::size_t at = text.find("column "); at != std::string_view::npos) {
    text.remove_prefix(at);
  } else if (const std::size_t end = text.find("] "); end != std::string_view::npos) {
    text.remove_prefix(end + 2);  // the library's number for it
  }
  return printable(text);
}

NumberTable empty_table(std::string_view name, const TableShape& shape, std::string description) {
  NumberTable empty{.name = name, .shape = shape, .description = std::move(description)};
  empty.numbers.reserve(shape.most_rows * shape.most_columns);
  return empty;
}

std::string up_to(std::size_t count) { return "at most " + std::to_string(count); }

NumberTable number(std::string_view name) { return empty_table(name, {0, 1, 1, 1, 1}, "a number"); }

NumberTable three_numbers(std::string_view name) {
  return empty_table(name, {1, 1, 1, 3, 3}, "an array of three numbers");
}

NumberTable joints(std::string_view name) {
  return empty_table(name, {1, 1, 1, 1, Chain::most_joints},
                     "an array of one number for each joint of the instrument");
}

}  // namespace

Request::Request(const RequestLimits& limits)
    : guides{.name = "guides", .most = Guide::most},
      tables{three_numbers("tip"),
             three_numbers("desired"),
             empty_table("jacobian", {2, 3, 3, 1, limits.joints},
                         "three arrays, the rows of the Jacobian, of one number for each joint, " +
                             up_to(limits.joints) + " (--joints)"),
             empty_table(
                 "rows", {2, 0, limits.rows, 1, std::max<std::size_t>(limits.joints, 3)},
                 "an array of arrays of one number for each joint, or three without a Jacobian, " +
                     up_to(limits.rows) + " of them (--rows)"),
             empty_table("bounds", {1, 0, 1, 0, limits.rows},
                         "an array of one number for each of the rows, " + up_to(limits.rows) +
                             " (--rows)"),
             number("radius"),
             empty_table("motions", {2, 0, limits.motions, 6, 6},
                         "an array of arrays of six numbers, tip and desired increment, " +
                             up_to(limits.motions) + " of them"),
             number("scale"),
             empty_table("frame", {2, 4, 4, 4, 4},
                         "four arrays of four numbers, a homogeneous matrix"),
             empty_table(
                 "capsules", {2, 1, Instrument::most_bodies, 9, 9},
                 "an array of arrays of nine numbers, a link and a point of it, another, and a "
                 "radius, " +
                     up_to(Instrument::most_bodies) + " of them"),
             joints("q"),
             three_numbers("linear"),
             three_numbers("angular"),
             joints("increment"),
             joints("weights"),
             number("mesh")},
      texts{{"urdf"}, {"base_link"}, {"tip_link"}, {"tool"}, {"narrow_phase"}, {"of"}, {"file"}} {
  for (const auto& option : instrument_options) options.push_back({option.name, &option});
  id.reserve(6 * longest_id + 2);
}

const NumberTable& Request::table(std::string_view key) const noexcept {
  return *named(tables, key);
}

const TextValue& Request::text(std::string_view key) const noexcept { return *named(texts, key); }

const OptionOfRequest& Request::option(std::string_view key) const noexcept {
  return *named(options, key);
}

bool VerbKeys::needs(std::string_view key) const noexcept { return contains(needed, key); }

bool VerbKeys::takes(std::string_view key) const noexcept {
  if (key.empty()) return false;  // as the unused ends of the lists are
  return needs(key) || contains(optional, key) ||
         (takes_options && contains(instrument_options, key, &OptionText::name));
}

std::span<const VerbKeys> verb_keys() noexcept { return verbs; }

void read_request(std::string_view line, Request& request) {
  request.id = "null";
  for (NumberTable& table : request.tables) {
    table.is_given = false;
    table.rows = table.columns = 0;
    table.numbers.clear();
  }
  for (TextValue& text : request.texts) text.is_given = false, text.text.clear();
  for (OptionOfRequest& option : request.options) option.is_given = false;
  request.guides.is_given = false;
  request.guides.texts.clear();
  // The library would take it for the end of the line.
  if (const std::size_t at = line.find('\0'); at != std::string_view::npos) {
    refuse_as_json("column " + std::to_string(at + 1) + ": a NUL byte");
  }
  try {
    const Json json = parsed(line, request);
    take(json, request);
    check(request, json.value("do", std::string()));
  } catch (const Json::exception& error) {
    refuse_as_json(cause(error.what()));
  }
}

}  // namespace keepout::app
