// SPDX-License-Identifier: BSD-3-Clause
// Garbled lines: each gets one answer of the right kind, and moves nothing unless it is a request.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "factory/tools_by_name.h"
#include "keepout/factory/make_motion_constraint.h"
#include "serve/answer.h"
#include "serve/request_schema.h"
#include "serve/service.h"
#include "temporary_folder.h"

namespace keepout::test {
namespace {

using Json = nlohmann::json;

constexpr std::size_t longest_line = 600;

app::ServiceSettings settings() {
  app::ServiceSettings settings;
  settings.mesh = "cube";
  settings.constraint.options.radius = 2.0;
  settings.constraint.options.damping = 1e-3;
  settings.constraint.options.distances = Distances::always;
  settings.limits = {.joints = 7, .rows = 4, .motions = 8};
  settings.longest_line = longest_line;
  return settings;
}

/// Returns the line as JSON; discarded if it is not JSON, or has a key twice.
Json parsed(std::string_view line) {
  if (line.find('\0') != std::string_view::npos) return Json(Json::value_t::discarded);
  std::set<std::string> keys;
  bool is_twice = false;
  const auto note = [&](int depth, Json::parse_event_t event, Json& value) {
    if (event == Json::parse_event_t::key && depth == 1) {
      is_twice |= !keys.insert(value.get<std::string>()).second;
    }
    return true;
  };
  Json json = Json::parse(line, note, false);
  return is_twice ? Json(Json::value_t::discarded) : json;
}

/// Returns true if a value has the type that a field's documentation states.
bool is_value(const Json& value, const app::Field& field) {
  if (field.option != nullptr) {
    const OptionKind kind = field.option->kind;
    return kind == OptionKind::number         ? value.is_number()
           : kind == OptionKind::whole_number ? value.is_number_integer()
           : kind == OptionKind::flag         ? value.is_boolean()
                                              : value.is_string();
  }
  const auto is_row = [&](const Json& row) {
    return row.is_array() && row.size() >= field.columns.least &&
           row.size() <= field.columns.most && std::ranges::all_of(row, [&](const Json& item) {
             return field.is_text   ? item.is_string()
                    : field.is_flag ? item.is_boolean()
                                    : item.is_number();
           });
  };
  if (field.rank == 0) return is_row(Json::array({value}));
  if (field.rank == 1) return is_row(value);
  return value.is_array() && value.size() >= field.rows.least && value.size() <= field.rows.most &&
         std::ranges::all_of(
             value, [&](const Json& row) { return is_row(row) && row.size() == value[0].size(); });
}

bool is_id(const Json& id) {
  return id.is_null() || id.is_number_integer() ||
         (id.is_string() && id.get_ref<const std::string&>().size() <= 128);
}

bool contains(const std::vector<std::string_view>& names, std::string_view name) {
  return std::ranges::find(names, name) != names.end();
}

/// Returns the verb of a line that has the keys and values of a request; null if it is no request.
const app::Verb* verb_of(const Json& line, std::span<const app::Field> fields) {
  if (!line.is_object() || !line.contains("do") || !line["do"].is_string()) return nullptr;
  if (line.contains("id") && !is_id(line["id"])) return nullptr;
  const auto verbs = app::verbs();
  const auto verb = std::ranges::find(verbs, line["do"].get<std::string>(), &app::Verb::name);
  if (verb == verbs.end()) return nullptr;
  for (const std::string_view key : verb->needed) {
    if (!line.contains(key)) return nullptr;
  }
  for (const auto& [key, value] : line.items()) {
    if (key == "id" || key == "do") continue;
    if (!contains(verb->needed, key) && !contains(verb->optional, key)) return nullptr;
    if (!is_value(value, *std::ranges::find(fields, key, &app::Field::name))) return nullptr;
  }
  return &*verb;
}

/// Returns true if the values of a request fit together.
bool is_consistent(const Json& request) {
  if (request.contains("of") && request["of"] != "tip" && request["of"] != "instrument") {
    return false;
  }
  if (request["do"] == "joint_step") {
    const bool has_twist = request.contains("linear") || request.contains("angular");
    return has_twist != request.contains("increment") &&
           !(has_twist && request.contains("weights"));
  }
  if (request.contains("rows") != request.contains("bounds")) return false;
  if (!request.contains("rows")) return true;
  const std::size_t columns = request.contains("jacobian") ? request["jacobian"][0].size() : 3;
  return request["rows"].size() == request["bounds"].size() &&
         (request["rows"].empty() || request["rows"][0].size() == columns);
}

/// Returns a number as the service reads it.
double number(const Json& value) {
  return value.is_number_integer() && !value.is_number_unsigned() && value == 0
             ? -0.0
             : value.get<double>();
}

Vec3 vector(const Json& array, std::size_t from = 0) {
  return {number(array[from]), number(array[from + 1]), number(array[from + 2])};
}

std::vector<double> row_by_row(const Json& rows) {
  std::vector<double> numbers;
  for (const Json& row : rows) std::ranges::transform(row, std::back_inserter(numbers), number);
  return numbers;
}

/// Returns the expected answer to a step.
std::string step_text(const Json& request, MotionConstraint& constraint, SideWatch& tip) {
  Motion motion{.tip = vector(request["tip"]), .desired = vector(request["desired"])};
  const Json jacobian = request.value("jacobian", Json::array({Json::array()}));
  TipJacobian::Matrix matrix(3, std::ssize(jacobian[0]));
  for (int c = 0; c < matrix.cols(); ++c) {
    for (int r = 0; r < 3; ++r) matrix(r, c) = number(jacobian[r][c]);
  }
  if (matrix.cols() > 0) motion.jacobian = TipJacobian(matrix);
  const std::vector<double> rows = row_by_row(request.value("rows", Json::array()));
  const std::vector<double> bounds = row_by_row({request.value("bounds", Json::array())});
  if (request.contains("rows")) {
    motion.rows = ExtraRows(rows.data(), bounds.data(), std::ssize(bounds));
  }
  std::string text;
  app::append_step(text, constraint.step(motion, tip), static_cast<std::size_t>(matrix.cols()));
  return text;
}

/// Returns the expected answer to a batch.
std::string steps_text(const Json& request, MotionConstraint& constraint, SideWatch& tip) {
  std::string text;
  for (const Json& motion : request["motions"]) {
    text += text.empty() ? "{" : ",{";
    app::append_step(text, constraint.step({vector(motion), vector(motion, 3)}, tip), 0);
    text += '}';
  }
  return ",\"steps\":[" + text + ']';
}

/// Returns true if a step is one of an instrument with six joints.
bool has_six_joints(const Json& request) {
  return std::ranges::all_of(std::array{"q", "increment", "weights"}, [&](const char* key) {
    return !request.contains(key) || request[key].size() == 6;
  });
}

/// Returns true if the answer has the properties of any step of an instrument.
bool is_joint_step(const Json& request, const Json& answer) {
  const bool ok = answer["ok"];
  const auto increment = answer["increment"].get<std::vector<double>>();
  const std::vector<double> zeros(request["q"].size(), 0.0);
  return answer.contains("reason") == !ok && increment.size() == zeros.size() &&
         (ok ? answer["fraction"] >= 0.0 && answer["fraction"] <= 1.0 : increment == zeros);
}

/// Returns the lines of a text that the service must answer.
std::vector<std::string_view> lines_of(std::string_view bytes) {
  std::vector<std::string_view> lines;
  while (!bytes.empty()) {
    const std::size_t end = std::min(bytes.find('\n'), bytes.size());
    std::string_view line = bytes.substr(0, end);
    if (line.ends_with('\r')) line.remove_suffix(1);
    const bool is_blank = line.find_first_not_of(" \t\r") == std::string_view::npos;
    if (!is_blank || line.size() > longest_line) lines.push_back(line);
    bytes.remove_prefix(std::min(end + 1, bytes.size()));
  }
  return lines;
}

/// A service and its judge. The judge has another JSON parser and a motion constraint of its own.
class JudgedService {
 public:
  /// Sends bytes as one client, in pieces of random sizes, and judges all answers. Each line that
  /// is not blank gets one answer, in order, with its id. Only requests get motions and planes, and
  /// these are those of the judge's constraint. Returns what is wrong; empty if nothing is.
  std::string converse(std::string_view bytes, std::mt19937_64& random) {
    app::Client client{service_};
    std::string received;
    std::string answers;
    const auto take = [&](std::string_view piece) {
      received += piece;
      for (std::size_t done = 1; done > 0; received.erase(0, done)) {
        std::string turn;
        done = app::take_turn(client, received, turn);
        answers += turn;
      }
    };
    for (std::string_view rest = bytes; !rest.empty();) {
      const std::size_t room = app::most_received(service_) - received.size();
      if (room == 0) return "there is no room for more";
      const std::size_t part = std::min({rest.size(), room, 1 + random() % 600});
      take(rest.substr(0, part));
      rest.remove_prefix(part);
    }
    take("\n");
    if (!received.empty()) return "it does not end";

    tip_ = {};
    has_own_tip_ = has_instrument_ = false;
    std::string_view rest = answers;
    for (const std::string_view line : lines_of(bytes)) {
      const std::size_t end = rest.find('\n');
      if (end == std::string_view::npos) return "no answer to: " + std::string(line);
      ++lines_;
      const std::string fault = judge(line, rest.substr(0, end));
      if (!fault.empty()) {
        return fault + "\n" + std::string(line) + "\n" + std::string(rest.substr(0, end));
      }
      rest.remove_prefix(end + 1);
    }
    return rest.empty() ? std::string() : "an answer to nothing: " + std::string(rest);
  }

  std::span<const app::Field> fields() const noexcept { return service_.requests.fields(); }
  std::size_t lines() const noexcept { return lines_; }        // answered lines
  std::size_t refusals() const noexcept { return refusals_; }  // lines refused
  /// Returns how often a verb was carried out.
  std::size_t done(const std::string& verb) { return done_[verb]; }

 private:
  std::string judge(std::string_view line, std::string_view answer) {
    const Json told = Json::parse(answer, nullptr, false);
    if (!told.is_object() || !told.contains("id")) return "no answer but";
    const bool is_too_long = line.size() > longest_line;
    const Json request = is_too_long ? Json(Json::value_t::discarded) : parsed(line);
    if (request.is_object() && request.contains("id") && is_id(request["id"]) &&
        told["id"] != request["id"]) {
      return "another id";
    }
    const app::Verb* verb = verb_of(request, fields());
    if (verb != nullptr && !is_consistent(request)) verb = nullptr;
    if (!told.contains("error")) {
      return verb == nullptr ? "not refused" : judge_answer(request, *verb, answer);
    }
    const std::string kind = told["error"]["kind"];
    if (told["error"]["message"] == "" || told.size() != 2) return "no message";
    if (verb != nullptr) return may_refuse(request, *verb, kind) ? "" : "refused";
    ++refusals_;
    const bool is_right =
        is_too_long ? kind == "line_too_long" : kind == "not_json" || kind == "not_a_request";
    return is_right ? "" : "another kind of error";
  }

  /// Returns true if a request may be refused in this way: because a file, text or number is
  /// invalid, or because of what was opened before.
  bool may_refuse(const Json& request, const app::Verb& verb, std::string_view kind) const {
    if (verb.name == "joint_step" && has_instrument_) {
      return kind == "not_a_request" && !has_six_joints(request);
    }
    const bool needs_instrument = verb.name == "joint_step" || !verb.refusal.empty();
    return (kind == "no_instrument" && needs_instrument && !has_instrument_) ||
           (kind == verb.refusal && !verb.refusal.empty());
  }

  /// Returns what is wrong with the answer to a request that was carried out; empty if nothing is.
  std::string judge_answer(const Json& request, const app::Verb& verb, std::string_view answer) {
    const Json told = Json::parse(answer);
    ++done_[std::string(verb.name)];
    if (verb.name == "joint_step") {
      return has_instrument_ && has_six_joints(request) && is_joint_step(request, told)
                 ? ""
                 : "no step of joints";
    }
    if (verb.name == "ping" || !verb.refusal.empty()) {
      has_instrument_ |= verb.name == "instrument";
      has_own_tip_ |= verb.name == "tool" || (verb.name == "guides" && !request["guides"].empty() &&
                                              request.value("of", "tip") == "tip");
      return told.value("ok", false) ? "" : "not done";
    }
    if (has_own_tip_) return {};
    std::string expected;
    if (verb.name == "step") expected = step_text(request, reference_, tip_);
    if (verb.name == "steps") expected = steps_text(request, reference_, tip_);
    if (verb.name == "polytope") {
      app::append_polytope(
          expected, reference_.free_polytope(vector(request["tip"]), number(request["radius"])));
    }
    return answer.ends_with(expected + '}') ? "" : "another answer than " + expected;
  }

  app::ServiceSettings settings_ = settings();
  app::Service service_{cube(), settings_};
  MotionConstraint reference_ = [this] {
    MotionConstraintSettings own = settings_.constraint;
    own.capacity.extra_rows = settings_.limits.rows;
    return make_motion_constraint(cube(), own);
  }();
  SideWatch tip_;             // of the client
  bool has_own_tip_ = false;  // a tool or guides: the reference has no such steps
  bool has_instrument_ = false;
  std::size_t lines_ = 0;
  std::size_t refusals_ = 0;
  std::map<std::string, std::size_t> done_;
};

#if defined(__SANITIZE_ADDRESS__)
constexpr std::size_t enough = 10'000;  // lines
#else
constexpr std::size_t enough = 100'000;
#endif

/// Returns a value that a service may accept, for keys whose random values are rarely valid.
std::string_view useful_value(std::string_view key) {
  static const TemporaryFolder folder;
  static const std::string file =
      '"' + folder.write("wall.off", "OFF\n3 1 0\n-9 -9 0\n9 -9 0\n0 9 0\n3 0 1 2\n").string() +
      '"';
  static const std::string bodies =
      '"' +
      folder
          .write("bodies.json", R"({"bodies":[{"name":"jaw","radius_mm":1,"points":[
                 {"link":"wrist_yaw_link","xyz_mm":[0,0,0]},{"link":"tip","xyz_mm":[0,0,0]}]}]})")
          .string() +
      '"';
  static const std::map<std::string_view, std::string_view> values{
      {"file", file},
      {"bodies", bodies},
      {"urdf", "\"" KEEPOUT_ROBOTS "/psm.urdf\""},
      {"capsules", "[[5,9.1,0,0,6,0,10.2,0,1]]"},
      {"base_link", "\"\""},
      {"tip_link", "\"\""},
      {"scale", "1000"},
      {"unit", R"("m")"},
      {"flip", "true"},
      {"space", R"("RAS")"},
      {"untagged", R"("LPS")"},
      {"frame", "[[1,0,0,0],[0,1,0,0],[0,0,1,20],[0,0,0,1]]"},
      {"tool", R"("blade:4:2:0.5")"},
      {"narrow_phase", R"("exact")"},
      {"guides", R"(["up=axis:4:0,0,1:0,0,1:0.5"])"},
      {"of", R"("instrument")"},
      {"mesh", "0"},
      {"certified", R"("actual")"}};
  const auto value = values.find(key);
  return value == values.end() ? std::string_view() : value->second;
}

class Garbler {
 public:
  Garbler(std::mt19937_64& random, std::span<const app::Field> fields)
      : random_(random), fields_(fields) {}

  /// Returns a request, half of the time with changes.
  std::string line() {
    std::string text = request();
    const std::size_t changes = below(2) == 0 ? 0 : 1 + below(4);
    for (std::size_t i = 0; i < changes; ++i) change(text);
    return text;
  }

 private:
  std::size_t below(std::size_t end) { return random_() % end; }

  /// Returns one of the words of a text.
  std::string any(std::string_view text) {
    std::istringstream stream{std::string(text)};
    const std::vector<std::string> words{std::istream_iterator<std::string>(stream), {}};
    return words[below(words.size())];
  }

  std::string number() {
    if (below(100) == 0) {
      return any(R"(0 -0 -0.0 1e999 -1e999 1e-999 NaN Infinity null true "1" [] {} 1e30 1e31)"
                 " 123456789012345678901234567890 01 1.5e3 +1 1. - 4.9e-324");
    }
    std::array<char, 32> text;
    const double value = std::uniform_real_distribution<double>(-1.0, 1.0)(random_);
    std::snprintf(text.data(), text.size(), "%.17g", value * size_);
    return text.data();
  }

  /// Returns an array with about `wanted` values, as the field allows; rarely, with another number.
  template <class Value>
  std::string array(std::size_t wanted, const app::Field::Count& count, const Value& value) {
    const std::size_t items =
        below(100) == 0 ? below(9) : std::clamp(wanted, count.least, count.most);
    std::string text = "[";
    for (std::size_t i = 0; i < items; ++i) text += (i > 0 ? "," : "") + value();
    return text + "]";
  }

  /// Returns a value of a field's shape, or one that may be accepted.
  std::string value(const app::Field& field) {
    const std::string_view useful = useful_value(field.name);
    if (!useful.empty() && below(3) > 0) return std::string(useful);
    if (field.option != nullptr) return any(R"(0.5 1 true -7 "other" [0.5])");
    size_ = field.name == "tip" || field.name == "motions" || field.name == "q" ? 6.0 : 1.2;
    const auto item = [&] {
      return field.is_text   ? std::string(R"("ball:0,0,0:9")")
             : field.is_flag ? any("true false")
                             : number();
    };
    const auto row = [&] {
      return array(field.columns.least == 0 ? rows_ : columns_, field.columns, item);
    };
    return field.rank == 0 ? item() : field.rank == 1 ? row() : array(rows_, field.rows, row);
  }

  /// Returns a request with a verb that the service lists, or with an unknown one.
  std::string request() {
    const auto verbs = app::verbs();
    std::string text = "{\"id\":" + any(R"(1 "a" null -5 1.5 "\u0000\"" [1] 18446744073709551615)");
    if (below(40) == 0) return text + R"(,"do":"fly"})";
    const app::Verb* verb = &verbs.front();
    // Requests that open something take long, and end the comparison with the reference.
    if (below(2) > 0) {
      do verb = &verbs[below(verbs.size())];
      while (!verb->refusal.empty() && below(6) > 0);
    }
    rows_ = below(5);
    columns_ = std::array<std::size_t, 5>{3, 6, 6, 6, 1 + below(7)}[below(5)];
    const std::size_t optional = below(6);  // none, all or some of the optional fields
    text += ",\"do\":\"" + std::string(verb->name) + '"';
    for (const app::Field& field : fields_) {
      const bool is_drawn = optional == 1 || (optional > 1 && below(3) == 0);
      if (contains(verb->needed, field.name) ||
          (is_drawn && contains(verb->optional, field.name))) {
        text += ",\"" + std::string(field.name) + "\":" + value(field);
      }
    }
    return text + "}";
  }

  void change(std::string& text) {
    const std::size_t at = below(text.size() + 1);
    switch (below(8)) {
      case 0:
        if (at < text.size()) text[at] = static_cast<char>(below(256));
        break;
      case 1:
        text.erase(at, 1 + below(6));
        break;
      case 2:
        text.insert(at,
                    any(R"({ } [ ] , : " \ "tip": "do": NaN -0 "id": "x":1, \ud800 [[[[[[[[[[[[)"
                        " {\"a\":{\"b\": 1e400 \xff \xc3\xa9 \xef\xbb\xbf"));
        break;
      case 3:
        text.insert(at, text.substr(below(text.size() + 1), below(40)));
        break;
      case 4:
        text.resize(at);
        break;
      case 5:
        text.insert(at, 1, '\0');
        break;
      case 6:
        switch (below(20)) {
          case 0:
            text.insert(at, std::string(below(3 * longest_line), ' '));
            break;
          case 1:
            text.insert(at, std::array{"\n", "\r", "\r\n"}[below(3)]);
            break;
        }
        break;
      default:
        for (std::size_t i = below(20); i > 0; --i) text += static_cast<char>(below(256));
    }
  }

  std::mt19937_64& random_;
  std::span<const app::Field> fields_;
  double size_ = 1.0;        // of the next numbers
  std::size_t rows_ = 0;     // of the next arrays, if any number is allowed
  std::size_t columns_ = 3;  // of the next arrays, if any number is allowed
};

TEST(ServeFuzz, EveryGarbledLineIsAnsweredOnceAndMovesNothing) {
  const std::string open = R"({"do":"instrument","urdf":)" + std::string(useful_value("urdf")) +
                           R"(,"capsules":)" + std::string(useful_value("capsules")) + "}\n";
  std::mt19937_64 random(20260728);
  JudgedService service;
  Garbler garbler(random, service.fields());
  while (service.lines() < enough) {
    std::string bytes = random() % 4 > 0 ? open : "";
    for (std::size_t lines = 1 + random() % 120; lines > 0; --lines) {
      bytes += garbler.line() + (random() % 8 == 0 ? "\r\n" : "\n");
    }
    const std::string fault = service.converse(bytes, random);
    ASSERT_TRUE(fault.empty()) << fault;
  }
  // The test is meaningful only if it has many lines of both kinds.
  EXPECT_GT(service.refusals(), service.lines() / 4);
  EXPECT_LT(service.refusals(), 3 * service.lines() / 4);
#if KEEPOUT_HAS_URDF
  for (const app::Verb& verb : app::verbs()) {
    const std::string name(verb.name);
    EXPECT_GT(service.done(name), service.lines() / (name == "joint_step" ? 500 : 2000)) << name;
  }
#endif
}

TEST(ServeFuzz, BytesThatAreNoTextAreAnsweredOnceALine) {
  std::mt19937_64 random(7);
  JudgedService service;
  while (service.lines() < enough / 5) {
    std::string bytes(random() % 4000, '\0');
    for (char& c : bytes) c = random() % 40 == 0 ? '\n' : static_cast<char>(random() % 256);
    const std::string fault = service.converse(bytes, random);
    ASSERT_TRUE(fault.empty()) << fault;
  }
  EXPECT_EQ(service.refusals(), service.lines());
}

// Writes the schema of requests, and garbled requests with the kinds of their errors, to the file
// that KEEPOUT_LINES names. tests/apps/test_schemas.py compares them.
TEST(ServeFuzz, WritesRequestsForTheTestOfTheSchema) {
  const TemporaryFolder folder;
  const char* const named = std::getenv("KEEPOUT_LINES");
  const auto file = named != nullptr ? std::filesystem::path(named) : folder.path() / "lines";
  std::ofstream out(file);
  const app::ServiceSettings of = settings();
  app::Service service{cube(), of};
  app::Client client{service};
  out << Json::parse(app::request_schema(of.limits)).dump() << '\n';
  std::mt19937_64 random(11);
  Garbler garbler(random, service.requests.fields());
  for (std::size_t written = 0; written < 3000;) {
    const std::string line = garbler.line();
    const bool is_line = line.size() < longest_line && line.find('\n') == std::string::npos;
    const Json request = is_line ? parsed(line) : Json();
    if (!request.is_object()) continue;
    std::string answer;
    app::take_turn(client, line + '\n', answer);
    const Json told = Json::parse(answer);
    out << Json{{"request", line},
                {"error", told.contains("error") ? told["error"]["kind"] : Json()}}
               .dump()
        << '\n';
    ++written;
  }
  EXPECT_TRUE(out.flush());
}

}  // namespace
}  // namespace keepout::test
