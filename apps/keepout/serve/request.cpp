// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "serve/request.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>
#include <vector>

#include "serve/json_text.h"

namespace keepout::app {
namespace {

using Json = nlohmann::json;

constexpr std::size_t longest_id = 128;  // [bytes]
constexpr int deepest = 8;               // more than any request needs

struct VerbKeys {
  std::string_view name;
  Verb verb;
  std::span<const std::string_view> needed;
  std::span<const std::string_view> optional;
};

constexpr std::array<std::string_view, 2> step_needs{"tip", "desired"};
constexpr std::array<std::string_view, 3> step_takes{"jacobian", "rows", "bounds"};
constexpr std::array<std::string_view, 1> steps_needs{"motions"};
constexpr std::array<std::string_view, 2> polytope_needs{"tip", "radius"};

constexpr std::array<VerbKeys, 6> verbs{{{"step", Verb::step, step_needs, step_takes},
                                         {"steps", Verb::steps, steps_needs, {}},
                                         {"polytope", Verb::polytope, polytope_needs, {}},
                                         {"info", Verb::info, {}, {}},
                                         {"statuses", Verb::statuses, {}, {}},
                                         {"ping", Verb::ping, {}, {}}}};

std::string listed(std::span<const std::string_view> names) {
  std::string list;
  for (const std::string_view name : names)
    list += (list.empty() ? "'" : ", '") + std::string(name) + "'";
  return list;
}

std::string verb_list() {
  std::string list;
  for (const VerbKeys& known : verbs)
    list += (list.empty() ? "'" : ", '") + std::string(known.name) + "'";
  return list;
}

bool contains(std::span<const std::string_view> names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Hears what the parser finds in a line, and fills a request. After the first thing that is wrong
/// it listens for the id alone.
class Listener : public nlohmann::json_sax<Json> {
 public:
  Listener(Request& request, std::string& message) : request_(request), message_(message) {}

  Refusal refusal() const noexcept { return refusal_; }

  bool null() override {
    if (is_id()) return true;  // as it is from the start
    return wrong_value();
  }
  bool boolean(bool) override { return is_id() ? wrong_id() : wrong_value(); }
  bool number_integer(std::int64_t value) override {
    if (is_id()) return take_id(std::to_string(value));
    // Of integers with a sign, only "-0" is zero: what C++ prints for a negative zero.
    return number(value == 0 ? -0.0 : static_cast<double>(value));
  }
  bool number_unsigned(std::uint64_t value) override {
    if (is_id()) return take_id(std::to_string(value));
    return number(static_cast<double>(value));
  }
  bool number_float(double value, const std::string&) override {
    return is_id() ? wrong_id() : number(value);
  }
  bool string(std::string& value) override {
    if (is_id()) {
      if (value.size() > longest_id) return wrong_id();
      std::string text;
      append_string(text, value);
      return take_id(text);
    }
    if (depth_ == 1 && key_ == Key::verb && is_object_) {
      verb_ = value.substr(0, longest_id);
      return true;
    }
    return wrong_value();
  }
  bool binary(Json::binary_t&) override { return false; }  // there is none in text

  bool start_object(std::size_t) override {
    if (depth_ == 0) {
      is_object_ = true;
    } else if (!(is_id() ? wrong_id() : wrong_value())) {
      return false;
    }
    return ++depth_ <= deepest || too_deep();
  }
  bool key(std::string& name) override {
    if (depth_ != 1 || !is_object_) return true;
    return begin_value(name);
  }
  bool end_object() override {
    --depth_;
    return true;
  }
  bool start_array(std::size_t) override {
    if (depth_ == 0) {
      refuse("a request is one object on a line: {\"id\":1,\"do\":\"ping\"}");
    } else if (is_id()) {
      wrong_id();
    } else if (refusal_ == Refusal::none && (table_ == nullptr || !table_->open())) {
      wrong_value();
    }
    return ++depth_ <= deepest || too_deep();
  }
  bool end_array() override {
    --depth_;
    if (refusal_ == Refusal::none && table_ != nullptr && !table_->close()) wrong_value();
    return true;
  }

  bool parse_error(std::size_t, const std::string&, const Json::exception& error) override {
    refusal_ = Refusal::not_json;
    message_ = "the line is not JSON: ";
    append_cause(error.what());
    return false;
  }

  /// Whether all is there, once the line has been read.
  void check();

 private:
  enum class Key : std::uint8_t { id, verb, table, none };

  bool is_id() const noexcept { return is_object_ && depth_ == 1 && key_ == Key::id; }

  bool begin_value(const std::string& name);

  bool take_id(std::string_view text) {
    request_.id = text;
    return true;
  }

  bool number(double value) {
    if (refusal_ != Refusal::none) return true;
    if (table_ == nullptr || !table_->add(value)) wrong_value();
    return true;
  }

  bool refuse(std::string message) {
    if (refusal_ == Refusal::none) {
      refusal_ = Refusal::not_a_request;
      message_ = std::move(message);
    }
    return true;  // goes on
  }

  bool wrong_id() {
    return refuse("'id' must be a whole number of at most 64 bits, a string of at most " +
                  std::to_string(longest_id) + " bytes, or null");
  }

  bool wrong_value() {
    if (refusal_ != Refusal::none) return true;
    if (!is_object_) return refuse("a request is one object on a line: {\"id\":1,\"do\":\"ping\"}");
    if (key_ == Key::verb) return refuse("'do' must be one of " + verb_list());
    if (table_ == nullptr) return refuse("a value has no key");  // not in JSON
    return refuse("'" + std::string(table_->name()) + "' must be " + table_->description());
  }

  bool too_deep() {
    refuse("the line is nested more deeply than any request");
    return false;
  }

  /// What the library says, in printable characters, and no more of the line than helps.
  void append_cause(std::string_view cause);

  Request& request_;
  std::string& message_;
  Refusal refusal_ = Refusal::none;
  std::string verb_;
  NumberTable* table_ = nullptr;  // whose value is read
  std::array<bool, 10> was_given_{};
  Key key_ = Key::none;
  bool is_object_ = false;
  int depth_ = 0;
};

bool Listener::begin_value(const std::string& name) {
  const auto tables = request_.tables();
  const auto found = std::find_if(tables.begin(), tables.end(),
                                  [&](const NumberTable* table) { return table->name() == name; });
  table_ = nullptr;
  key_ = Key::none;
  std::size_t place = tables.size();
  if (found != tables.end()) {
    place = static_cast<std::size_t>(found - tables.begin());
    key_ = Key::table;
    table_ = *found;
  } else if (name == "do") {
    place += 1;
    key_ = Key::verb;
  } else if (name == "id") {
    key_ = Key::id;
  } else {
    std::string text;
    append_quoted(text, name);
    return refuse("there is no key " + text + " in a request; see 'keepout serve --help'");
  }
  if (was_given_[place]) {
    key_ = Key::none;
    table_ = nullptr;
    return refuse("'" + name + "' is given twice");
  }
  was_given_[place] = true;
  return true;
}

void Listener::append_cause(std::string_view cause) {
  if (const std::size_t at = cause.find("column "); at != std::string_view::npos) {
    cause.remove_prefix(at);
  } else if (const std::size_t end = cause.find("] "); end != std::string_view::npos) {
    cause.remove_prefix(end + 2);  // the library's number for it
  }
  append_printable(message_, cause);
}

void Listener::check() {
  if (refusal_ != Refusal::none) return;
  if (!is_object_) {
    wrong_value();
    return;
  }
  const auto known = std::find_if(verbs.begin(), verbs.end(),
                                  [&](const VerbKeys& keys) { return keys.name == verb_; });
  if (known == verbs.end()) {
    std::string asked;
    append_quoted(asked, verb_);
    refuse(verb_.empty() ? "'do' is missing: say what to do, one of " + verb_list()
                         : "there is nothing to do by the name " + asked +
                               "; 'do' must be one of " + verb_list());
    return;
  }
  request_.verb = known->verb;
  for (const NumberTable* table : request_.tables()) {
    const bool is_needed = contains(known->needed, table->name());
    if (is_needed && !table->is_given()) {
      refuse("'" + std::string(table->name()) + "' is missing: '" + std::string(known->name) +
             "' needs it, " + table->description());
    } else if (!is_needed && table->is_given() && !contains(known->optional, table->name())) {
      std::vector<std::string_view> takes{"id", "do"};
      takes.insert(takes.end(), known->needed.begin(), known->needed.end());
      takes.insert(takes.end(), known->optional.begin(), known->optional.end());
      refuse("'" + std::string(table->name()) + "' is nothing that '" + std::string(known->name) +
             "' takes; it takes " + listed(takes));
    }
  }
  const Request& r = request_;
  if (r.rows.is_given() != r.bounds.is_given()) {
    refuse("'rows' and 'bounds' belong together: rows . u >= bounds");
  } else if (r.rows.rows() != r.bounds.columns()) {
    refuse("'bounds' must have one number for each of the 'rows'");
  } else if (r.rows.rows() > 0 &&
             r.rows.columns() != (r.jacobian.is_given() ? r.jacobian.columns() : 3)) {
    refuse(
        "each of the 'rows' must have one number for each column of the 'jacobian', or three "
        "without one");
  }
}

std::string up_to(std::size_t count) { return "at most " + std::to_string(count); }

}  // namespace

Request::Request(const RequestLimits& limits)
    : tip("tip", {1, 1, 1, 3, 3}, "an array of three numbers"),
      desired("desired", {1, 1, 1, 3, 3}, "an array of three numbers"),
      jacobian("jacobian", {2, 3, 3, 1, limits.joints},
               "three arrays, the rows of the Jacobian, of one number for each joint, " +
                   up_to(limits.joints) + " (--joints)"),
      rows("rows", {2, 0, limits.rows, 1, std::max<std::size_t>(limits.joints, 3)},
           "an array of arrays of one number for each joint, or three without a Jacobian, " +
               up_to(limits.rows) + " of them (--rows)"),
      bounds("bounds", {1, 0, 1, 0, limits.rows},
             "an array of one number for each of the rows, " + up_to(limits.rows) + " (--rows)"),
      radius("radius", {0, 1, 1, 1, 1}, "a number"),
      motions("motions", {2, 0, limits.motions, 6, 6},
              "an array of arrays of six numbers, tip and desired increment, " +
                  up_to(limits.motions) + " of them") {
  id.reserve(6 * longest_id + 2);
}

std::string_view name(Refusal refusal) noexcept {
  switch (refusal) {
    case Refusal::none:
      return "none";
    case Refusal::line_too_long:
      return "line_too_long";
    case Refusal::not_json:
      return "not_json";
    case Refusal::not_a_request:
      return "not_a_request";
  }
  return "unknown";
}

RequestReader::RequestReader(const RequestLimits& limits) : request_(limits) {}

Refusal RequestReader::read(std::string_view line) {
  request_.id = "null";
  for (NumberTable* table : request_.tables()) table->clear();
  // The library would take it for the end of the line.
  if (const std::size_t at = line.find('\0'); at != std::string_view::npos) {
    message_ = "the line is not JSON: column " + std::to_string(at + 1) + ": a NUL byte";
    return Refusal::not_json;
  }
  Listener listener(request_, message_);
  Json::sax_parse(line.begin(), line.end(), &listener);
  listener.check();
  return listener.refusal();
}

}  // namespace keepout::app
