// SPDX-License-Identifier: BSD-3-Clause
// Lines that are broken in every way at hand: each is answered once, by what it is, and moves
// nothing unless it is a request.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/factory/make_motion_constraint.h"
#include "keepout/fixtures/shapes.h"
#include "serve/service.h"

namespace keepout::test {
namespace {

using Json = nlohmann::json;

std::shared_ptr<const Mesh> mesh() {
  static const auto shared = std::make_shared<const Mesh>(make_cube(10.0));
  return shared;
}

app::ServiceSettings settings(std::size_t longest_line) {
  app::ServiceSettings settings;
  settings.mesh = "cube";
  settings.constraint.options.radius = 2.0;
  settings.constraint.options.damping = 1e-3;
  settings.constraint.options.distances = Distances::always;
  settings.limits = {.joints = 7, .rows = 4, .motions = 8};
  settings.longest_line = longest_line;
  return settings;
}

/// The line as JSON; discarded if it is none, or has a key twice.
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

bool is_row(const Json& value, const app::TableShape& shape) {
  return value.is_array() && value.size() >= shape.fewest_columns &&
         value.size() <= shape.most_columns &&
         std::ranges::all_of(value, [](const Json& n) { return n.is_number(); });
}

/// True if a value has the shape of the service's documentation.
bool has_shape(const Json& value, const app::TableShape& shape) {
  if (shape.rank == 0) return value.is_number();
  if (shape.rank == 1) return is_row(value, shape);
  return value.is_array() && value.size() >= shape.fewest_rows && value.size() <= shape.most_rows &&
         std::ranges::all_of(value, [&](const Json& row) {
           return is_row(row, shape) && row.size() == value[0].size();
         });
}

bool is_id(const Json& id) {
  return id.is_null() || id.is_number_integer() ||
         (id.is_string() && id.get_ref<const std::string&>().size() <= 128);
}

/// True if a line is a request of the keys that the service lists.
bool is_request(const Json& line, const app::Request& schema) {
  if (!line.is_object() || !line.contains("do") || !line["do"].is_string()) return false;
  if (line.contains("id") && !is_id(line["id"])) return false;
  const auto verb = std::ranges::find(app::verb_keys(), line["do"].get<std::string>(),
                                      [](const app::VerbKeys& v) { return std::string(v.name); });
  if (verb == app::verb_keys().end()) return false;
  for (const std::string_view key : verb->needed) {
    if (!key.empty() && !line.contains(key)) return false;
  }
  for (const auto& [key, value] : line.items()) {
    if (key != "id" && key != "do" && !verb->takes(key)) return false;
  }
  for (const app::NumberTable& table : schema.tables) {
    if (line.contains(table.name) && !has_shape(line[table.name], table.shape)) return false;
  }
  for (const app::TextValue& text : schema.texts) {
    if (line.contains(text.name) && !line[text.name].is_string()) return false;
  }
  if (verb->verb == app::Verb::joint_step) {
    const bool has_twist = line.contains("linear") || line.contains("angular");
    return has_twist != line.contains("increment") && !(has_twist && line.contains("weights"));
  }
  if (line.contains("rows") != line.contains("bounds")) return false;
  if (!line.contains("rows")) return true;
  const std::size_t columns = line.contains("jacobian") ? line["jacobian"][0].size() : 3;
  return line["rows"].size() == line["bounds"].size() &&
         (line["rows"].empty() || line["rows"][0].size() == columns);
}

Vec3 vector(const Json& array, std::size_t from = 0) {
  return {array[from].get<double>(), array[from + 1].get<double>(), array[from + 2].get<double>()};
}

bool is_same(const Json& answer, const Step& step) {
  return answer["ok"] == step.ok() && answer["status"] == name(step.status) &&
         vector(answer["motion"]) == step.motion && answer["planes"] == step.planes.size() &&
         answer["triangles"] == step.triangles &&
         answer.contains("distance") == step.distance.has_value() &&
         (!step.distance || answer["distance"] == *step.distance) &&
         answer.contains("reason") == !step.ok();
}

bool is_same(const Json& answer, const Polytope& polytope) {
  if (answer["status"] != name(polytope.status)) return false;
  const Json& normals = answer["normals"];
  const Json& offsets = answer["offsets"];
  if (normals.size() != polytope.planes.size() || offsets.size() != normals.size()) return false;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    if (vector(normals[i]) != polytope.planes[i].normal) return false;
    if (offsets[i] != polytope.planes[i].offset) return false;
  }
  return true;
}

bool is_same_step(const Json& request, const Json& answer, MotionConstraint& constraint,
                  SideWatch& tip) {
  Motion motion{.tip = vector(request["tip"]), .desired = vector(request["desired"])};
  TipJacobian::Matrix jacobian;
  if (request.contains("jacobian")) {
    jacobian.resize(3, std::ssize(request["jacobian"][0]));
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < jacobian.cols(); ++c) jacobian(r, c) = request["jacobian"][r][c];
    }
    motion.jacobian = TipJacobian(jacobian);
  }
  std::vector<double> matrix;
  std::vector<double> bounds;
  if (request.contains("rows")) {
    for (const Json& row : request["rows"]) {
      for (const Json& number : row) matrix.push_back(number.get<double>());
    }
    bounds = request["bounds"].get<std::vector<double>>();
    motion.rows = ExtraRows(matrix.data(), bounds.data(), std::ssize(bounds));
  }
  const Step step = constraint.step(motion, tip);
  if (!is_same(answer, step)) return false;
  if (!motion.jacobian) return !answer.contains("increment");
  const auto increment = answer["increment"].get<std::vector<double>>();
  if (!step.ok()) return increment == std::vector<double>(jacobian.cols(), 0.0);
  return std::equal(increment.begin(), increment.end(), step.increment.begin(),
                    step.increment.end());
}

bool is_same_batch(const Json& request, const Json& answer, MotionConstraint& constraint,
                   SideWatch& tip) {
  const Json& motions = request["motions"];
  if (answer["steps"].size() != motions.size()) return false;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const Motion motion{.tip = vector(motions[i]), .desired = vector(motions[i], 3)};
    if (!is_same(answer["steps"][i], constraint.step(motion, tip))) return false;
  }
  return true;
}

/// What must hold of a step of an instrument, whatever it is.
bool is_joint_step(const Json& request, const Json& answer) {
  const bool ok = answer["ok"];
  const auto increment = answer["increment"].get<std::vector<double>>();
  const std::vector<double> zeros(request["q"].size(), 0.0);
  return answer.contains("reason") == !ok && increment.size() == zeros.size() &&
         (ok ? answer["share"] >= 0.0 && answer["share"] <= 1.0 : increment == zeros);
}

/// The lines of a text that are to be answered.
std::vector<std::string_view> lines_of(std::string_view bytes, std::size_t longest) {
  std::vector<std::string_view> lines;
  while (!bytes.empty()) {
    const std::size_t end = std::min(bytes.find('\n'), bytes.size());
    std::string_view line = bytes.substr(0, end);
    if (line.ends_with('\r')) line.remove_suffix(1);
    const bool is_blank = line.find_first_not_of(" \t\r") == std::string_view::npos;
    if (!is_blank || line.size() > longest) lines.push_back(line);
    bytes.remove_prefix(std::min(end + 1, bytes.size()));
  }
  return lines;
}

/// A service, and one who knows what it must answer: by another JSON parser, and by a motion
/// constraint of his own.
class JudgedService {
 public:
  explicit JudgedService(std::size_t longest_line);

  /// Sends bytes as one client, in pieces of random sizes, and judges all that is answered: one
  /// line for each that is not blank, in order, with its id; motions and planes for requests alone,
  /// and those of the constraint. Returns what is wrong; empty if nothing is.
  std::string converse(std::string_view bytes, std::mt19937_64& random);

  std::size_t lines() const noexcept { return lines_; }              // that were answered
  std::size_t refusals() const noexcept { return refusals_; }        // among them
  std::size_t joint_steps() const noexcept { return joint_steps_; }  // that were carried out

 private:
  std::string judge(std::string_view line, std::string_view answer, SideWatch& tip);

  app::ServiceSettings settings_;
  app::Service service_;
  app::Request schema_{settings_.limits};
  MotionConstraint reference_;
  std::size_t lines_ = 0;
  std::size_t refusals_ = 0;
  std::size_t joint_steps_ = 0;
};

JudgedService::JudgedService(std::size_t longest_line)
    : settings_(settings(longest_line)), service_(mesh(), settings_), reference_([&] {
        MotionConstraintSettings own = settings_.constraint;
        own.capacity.extra_rows = settings_.limits.rows;
        return make_motion_constraint(mesh(), own);
      }()) {}

std::string JudgedService::converse(std::string_view bytes, std::mt19937_64& random) {
  app::Session session(service_);
  std::string answers;
  const auto take_all = [&] {
    while (session.has_work() || !session.unsent().empty()) {
      session.take_turn();
      const std::size_t part = std::min<std::size_t>(session.unsent().size(), 1 + random() % 5000);
      answers += session.unsent().substr(0, part);
      session.sent(part);
    }
  };
  for (std::string_view rest = bytes; !rest.empty();) {
    const std::span<char> room = session.room();
    if (room.empty()) return "there is no room for more";
    const std::size_t part = std::min({rest.size(), room.size(), 1 + random() % 600});
    std::copy_n(rest.begin(), part, room.begin());
    rest.remove_prefix(part);
    session.added(part);
    take_all();
  }
  session.ended();
  take_all();
  if (!session.is_done()) return "it does not end";

  SideWatch tip;
  std::string_view rest = answers;
  for (const std::string_view line : lines_of(bytes, settings_.longest_line)) {
    const std::size_t end = rest.find('\n');
    if (end == std::string_view::npos) return "no answer to: " + std::string(line);
    ++lines_;
    const std::string fault = judge(line, rest.substr(0, end), tip);
    if (!fault.empty()) {
      return fault + "\n" + std::string(line) + "\n" + std::string(rest.substr(0, end));
    }
    rest.remove_prefix(end + 1);
  }
  return rest.empty() ? std::string() : "an answer to nothing: " + std::string(rest);
}

std::string JudgedService::judge(std::string_view line, std::string_view answer, SideWatch& tip) {
  const Json told = Json::parse(answer, nullptr, false);
  if (!told.is_object() || !told.contains("id")) return "no answer but";
  const Json request =
      line.size() > settings_.longest_line ? Json(Json::value_t::discarded) : parsed(line);
  const bool is_refused = told.contains("error");
  // Whether there is an instrument depends on files, and on what was opened before.
  if (is_refused && is_request(request, schema_) &&
      (request["do"] == "instrument" || request["do"] == "joint_step")) {
    const std::string kind = told["error"]["kind"];
    const bool is_joint_step = request["do"] == "joint_step";
    return kind == "no_instrument" || (is_joint_step && kind == "not_a_request") ? ""
                                                                                 : "another kind";
  }
  if (is_refused == is_request(request, schema_)) return is_refused ? "refused" : "not refused";
  if (request.is_object() && request.contains("id") && is_id(request["id"]) &&
      told["id"] != request["id"]) {
    return "another id";
  }
  if (is_refused) {
    ++refusals_;
    const std::string kind = told["error"]["kind"];
    if (kind == "line_too_long" ? line.size() <= settings_.longest_line
                                : kind != "not_json" && kind != "not_a_request") {
      return "another kind of error";
    }
    return told["error"]["message"].get<std::string>().empty() || told.size() != 2 ? "no message"
                                                                                   : "";
  }
  const std::string verb = request["do"];
  if (verb == "step" && !is_same_step(request, told, reference_, tip)) return "another step";
  if (verb == "steps" && !is_same_batch(request, told, reference_, tip)) return "other steps";
  if (verb == "joint_step" && !is_joint_step(request, told)) return "no step of joints";
  joint_steps_ += verb == "joint_step";
  if (verb == "polytope" &&
      !is_same(told, reference_.free_polytope(vector(request["tip"]), request["radius"]))) {
    return "another polytope";
  }
  return {};
}

constexpr std::size_t longest_line = 600;

#if defined(__SANITIZE_ADDRESS__)
constexpr std::size_t enough = 10'000;  // lines
#else
constexpr std::size_t enough = 100'000;
#endif

class Garbler {
 public:
  explicit Garbler(std::mt19937_64& random) : random_(random) {}

  /// A request, or what is left of one.
  std::string line() {
    std::string text = request();
    const std::size_t changes = below(2) == 0 ? 0 : 1 + below(4);
    for (std::size_t i = 0; i < changes; ++i) change(text);
    return text;
  }

 private:
  std::size_t below(std::size_t end) { return random_() % end; }
  template <std::size_t n>
  std::string_view any(const std::array<std::string_view, n>& of) {
    return of[below(n)];
  }

  std::string number() {
    static constexpr std::array<std::string_view, 22> odd{
        "0",      "-0",      "-0.0",  "1e999",
        "-1e999", "1e-999",  "NaN",   "Infinity",
        "null",   "true",    "\"1\"", "[]",
        "{}",     "1e30",    "1e31",  "123456789012345678901234567890",
        "01",     "1.5e3",   "+1",    "1.",
        "-",      "4.9e-324"};
    if (below(100) == 0) return std::string(any(odd));
    std::array<char, 32> text;
    const double value = std::uniform_real_distribution<double>(-1.0, 1.0)(random_);
    std::snprintf(text.data(), text.size(), "%.17g", value * size_);
    return text.data();
  }

  /// In a wrong number now and then.
  std::string array(std::size_t count) {
    if (below(100) == 0) count = below(9);
    std::string text = "[";
    for (std::size_t i = 0; i < count; ++i) text += (i > 0 ? "," : "") + number();
    return text + "]";
  }
  std::string matrix(std::size_t rows, std::size_t columns) {
    std::string text = "[";
    for (std::size_t i = 0; i < rows; ++i) text += (i > 0 ? "," : "") + array(columns);
    return text + "]";
  }
  std::string tip() { return size_ = 6.0, array(3); }
  std::string increment() { return size_ = 1.2, array(3); }

  std::string request() {
    static constexpr std::array<std::string_view, 8> ids{
        "1", "\"a\"", "null", "-5", "1.5", "\"\\u0000\\\"\"", "[1]", "18446744073709551615"};
    std::string text = "{\"id\":" + std::string(any(ids));
    const std::size_t kind = below(14);
    if (kind < 4) {
      text += ",\"do\":\"step\",\"tip\":" + tip() + ",\"desired\":" + increment();
      const std::size_t joints = 1 + below(7);
      if (kind == 1) text += ",\"jacobian\":" + matrix(3, joints);
      if (kind < 3) {
        const std::size_t rows = below(4);
        text += ",\"rows\":" + matrix(rows, kind == 1 ? joints : 3) + ",\"bounds\":" + array(rows);
      }
    } else if (kind == 4) {
      text += ",\"do\":\"steps\",\"motions\":" + (size_ = 6.0, matrix(below(5), 6));
    } else if (kind < 7) {
      text += ",\"do\":\"polytope\",\"tip\":" + tip() + ",\"radius\":" + (size_ = 2.0, number());
    } else if (kind == 12 && below(3) == 0) {
      text += ",\"do\":\"instrument\",\"urdf\":\"" KEEPOUT_ROBOTS "/psm.urdf\",\"capsules\":" +
              std::string(below(2) == 0 ? "[[5,9.1,0,0,6,0,10.2,0,1]]" : matrix(below(3), 9));
    } else if (kind >= 12) {
      const bool has_twist = below(2) == 0;
      text += ",\"do\":\"joint_step\",\"q\":" + (size_ = 3.0, array(6));
      text += has_twist ? ",\"linear\":" + increment() : ",\"increment\":" + array(6);
    } else {
      static constexpr std::array<std::string_view, 4> others{"info", "ping", "ping", "fly"};
      text += ",\"do\":\"" + std::string(any(others)) + "\"";
    }
    return text + "}";
  }

  void change(std::string& text) {
    static constexpr std::array<std::string_view, 24> tokens{"{",
                                                             "}",
                                                             "[",
                                                             "]",
                                                             ",",
                                                             ":",
                                                             "\"",
                                                             "\\",
                                                             "\n",
                                                             "\r",
                                                             "\r\n",
                                                             "\xff",
                                                             "\xc3\xa9",
                                                             "\xef\xbb\xbf",
                                                             "\"tip\":",
                                                             "\"do\":",
                                                             "NaN",
                                                             "-0",
                                                             "\"id\":",
                                                             "\"x\":1,",
                                                             "\\ud800",
                                                             "[[[[[[[[[[[[",
                                                             "{\"a\":{\"b\":",
                                                             "1e400"};
    const std::size_t at = below(text.size() + 1);
    switch (below(8)) {
      case 0:
        if (at < text.size()) text[at] = static_cast<char>(below(256));
        break;
      case 1:
        text.erase(at, 1 + below(6));
        break;
      case 2:
        text.insert(at, any(tokens));
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
        if (below(20) == 0) text.insert(at, std::string(below(3 * longest_line), ' '));
        break;
      default:
        for (std::size_t i = below(20); i > 0; --i) text += static_cast<char>(below(256));
    }
  }

  std::mt19937_64& random_;
  double size_ = 1.0;  // of the numbers to come
};

TEST(ServeFuzz, EveryGarbledLineIsAnsweredOnceAndMovesNothing) {
  std::mt19937_64 random(20260728);
  Garbler garbler(random);
  JudgedService service(longest_line);
  while (service.lines() < enough) {
    std::string bytes;
    for (std::size_t lines = 1 + random() % 60; lines > 0; --lines) {
      bytes += garbler.line() + (random() % 8 == 0 ? "\r\n" : "\n");
    }
    const std::string fault = service.converse(bytes, random);
    ASSERT_TRUE(fault.empty()) << fault;
  }
  // It is worth something only if both kinds of line are there.
  EXPECT_GT(service.refusals(), service.lines() / 4);
  EXPECT_LT(service.refusals(), 3 * service.lines() / 4);
#if KEEPOUT_HAS_URDF
  EXPECT_GT(service.joint_steps(), service.lines() / 500);
#endif
}

TEST(ServeFuzz, BytesThatAreNoTextAreAnsweredOnceALine) {
  std::mt19937_64 random(7);
  JudgedService service(longest_line);
  while (service.lines() < enough / 5) {
    std::string bytes(random() % 4000, '\0');
    for (char& c : bytes) c = random() % 40 == 0 ? '\n' : static_cast<char>(random() % 256);
    const std::string fault = service.converse(bytes, random);
    ASSERT_TRUE(fault.empty()) << fault;
  }
  EXPECT_EQ(service.refusals(), service.lines());
}

}  // namespace
}  // namespace keepout::test
