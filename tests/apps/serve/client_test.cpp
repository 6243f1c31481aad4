// SPDX-License-Identifier: BSD-3-Clause
// The answers of `keepout serve` to a client, line by line.
#include <bit>
#include <charconv>
#include <deque>
#include <nlohmann/json.hpp>
#include <sstream>

#include "factory/tools_by_name.h"
#include "keepout/fixtures/poses.h"
#include "keepout/fixtures/robots.h"
#include "keepout/version.h"
#include "meshes.h"
#include "messages.h"
#include "serve/answer.h"
#include "serve/service.h"
#include "temporary_folder.h"
#if KEEPOUT_HAS_URDF
#include "keepout/urdf/read_chain.h"
#endif

namespace keepout::app {
namespace {

using Answer = nlohmann::json;

/// A client, and the bytes that it has sent.
class Talk {
 public:
  explicit Talk(Service& service) : client_{service} {}

  /// Sends more bytes; returns the answers that are ready then.
  std::string sent(std::string_view bytes) {
    received_ += bytes;
    std::string all;
    while (true) {
      EXPECT_LE(received_.size(), most_received(client_.service) + 1);
      std::string turn;
      const std::size_t done = take_turn(client_, received_, turn);
      received_.erase(0, done);
      all += turn;
      if (done == 0) return all;
    }
  }

  std::string ask(std::string_view line) { return sent(std::string(line) + "\n"); }
  std::size_t unread() const { return received_.size(); }
  Answer told(std::string_view line) { return Answer::parse(ask(line)); }
  std::string refusal(std::string_view line) { return told(line)["error"]["kind"]; }

 private:
  Client client_;
  std::string received_;
};

std::string numbers(std::span<const double> values) {
  std::string text;
  append_value(text, values);
  return text;
}

std::string step_line(const Vec3& tip, const Vec3& desired) {
  return R"({"do":"step","tip":)" + numbers({tip.data(), 3}) + R"(,"desired":)" +
         numbers({desired.data(), 3}) + '}';
}

/// Returns the motion of an answer, read as a client in another language would read it.
Vec3 motion_in(std::string_view answer) {
  Vec3 motion;
  const char* at = answer.data() + answer.find("\"motion\":[") + 9;
  for (double& x : motion) at = std::from_chars(at + 1, answer.data() + answer.size(), x).ptr;
  return motion;
}

bool same_bits(const Vec3& a, const Vec3& b) {
  using Bits = std::array<std::uint64_t, 3>;
  return std::bit_cast<Bits>(std::array{a.x(), a.y(), a.z()}) ==
         std::bit_cast<Bits>(std::array{b.x(), b.y(), b.z()});
}

/// Lines to a service for small requests.
class RequestLine : public testing::Test {
 protected:
  static ServiceSettings settings() {
    ServiceSettings settings;
    settings.limits = {.joints = 4, .rows = 2, .motions = 3};
    settings.longest_line = 1 << 20;
    return settings;
  }

  /// Returns the id, the kind of error and its message.
  std::string outcome(std::string_view line) {
    const Answer answer = talk_.told(line);
    const Answer error = answer.value("error", Answer{{"kind", "none"}, {"message", ""}});
    return answer["id"].dump() + " " + std::string(error["kind"]) + ": " +
           std::string(error["message"]);
  }

  double radius_in(const std::string& text) {
    std::string id;
    Json request;
    service_.requests.read(R"({"do":"polytope","tip":[0,0,0],"radius":)" + text + "}", id, request);
    return app::numbers(request, "radius").at(0);
  }

  Service service_{test::cube(), settings()};
  Talk talk_{service_};
};

TEST_F(RequestLine, ValuesAreReadRowByRow) {
  std::string id;
  Json request;
  const Verb& step = service_.requests.read(
      R"( { "desired" : [4,5.5,-6e0] , "do":"step", "tip":[1,2,3],"rows":[[1,2,3],[4,5,6]],)"
      R"("bounds":[-1,-2], "id":9 } )",
      id, request);
  EXPECT_EQ(step.name, "step");
  EXPECT_EQ(id, "9");
  EXPECT_EQ(app::numbers(request, "tip"), (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(app::numbers(request, "desired"), (std::vector<double>{4, 5.5, -6}));
  EXPECT_EQ(app::numbers(request, "rows"), (std::vector<double>{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(app::numbers(request, "bounds"), (std::vector<double>{-1, -2}));
  EXPECT_EQ(app::numbers(request, "jacobian"), std::vector<double>{});
  const Verb& ping = service_.requests.read(R"({"do":"ping"})", id, request);
  EXPECT_EQ(ping.name, "ping");
  EXPECT_EQ(id, "null") << "of the request before";
  EXPECT_EQ(request.size(), 1u) << "of the request before";
}

TEST_F(RequestLine, EachRequestIsCarriedOutOrRefusedByWhatItIs) {
  const std::string step = R"({"id":1,"do":"step","tip":[1,2,3],"desired":[0,0,0],)";
  const std::string open = R"({"id":1,"do":"instrument","urdf":"a.urdf","capsules":)";
  const std::string capsule = "[[0,1,2,3,4,5,6,7,8]]";
  const std::string joints = R"({"id":1,"do":"joint_step",)";
  const std::string good = "none: ";
#if KEEPOUT_HAS_URDF
  const std::string no_file = "no_instrument: 'urdf' must name a file, which 'a.urdf' does not";
#else
  const std::string no_file = "no_instrument: this build reads no URDF: install liburdfdom-dev";
#endif
  const std::string closed = "no_instrument: there is no instrument yet";
  const std::string wrong = "not_a_request: ";
  const std::string one_tip = wrong + "'tip' must be an array of three numbers";
  const std::string two_kinds = wrong + "a 'joint_step' takes either";
  std::vector<std::pair<std::string, std::string>> table{
      {step + R"("jacobian":[[1],[2],[3]]})", good},
      {step + R"("jacobian":[[1,2,3,4],[5,6,7,8],[9,10,11,12]],)"
              R"("rows":[[1,2,3,4],[5,6,7,8]],"bounds":[-1,-2]})",
       good},
      {step + R"("rows":[[1,2,3]],"bounds":[0]})", good},
      {step + R"("rows":[],"bounds":[]})", good},
      {step + R"("rows":[[1,2,3]]})", wrong + "'rows' and 'bounds' belong together"},
      {step + R"("bounds":[1]})", wrong + "'rows' and 'bounds' belong together"},
      {step + R"("rows":[[1,2,3]],"bounds":[]})", wrong + "'bounds' must have one number"},
      {step + R"("rows":[[1,2,3]],"bounds":[1,2]})", wrong + "'bounds' must have one number"},
      {step + R"("rows":[[1,2,3,4]],"bounds":[1]})", wrong + "each of the 'rows' must have"},
      {step + R"("rows":[[1,2]],"bounds":[1]})", wrong + "each of the 'rows' must have"},
      {step + R"("jacobian":[[1],[2],[3]],"rows":[[1,2,3]],"bounds":[1]})", wrong + "each of"},
      {step + R"("jacobian":[[1],[2],[3]],"radius":1})",
       wrong + "'radius' is not a key that 'step'"},
      {step + R"("radius":1})", wrong + "'radius' is not a key that 'step' takes; it takes 'id'"},
      {open + capsule + R"(,"tip_link":"t","margin":0.5})", no_file},
      {open + "[]}", wrong + "'capsules' must be"},
      {open + "[[0,1,2,3,4,5,6,7]]}", wrong + "'capsules' must be"},
      {open + capsule + R"(,"tip":"t"})", one_tip},
      {open + capsule + R"(,"base_link":7})", wrong + "'base_link' must be a string"},
      {open + capsule + R"(,"margin":"wide"})", wrong + "'margin' must be a"},
      {open + capsule + R"(,"check_sides":1})", wrong + "'check_sides' must be true or false"},
      {open + capsule + R"(,"refinements":1.5})", wrong + "'refinements' must be a whole number"},
      {open + capsule + R"(,"frame":[[1,0,0,0],[0,1,0,0],[0,0,1,0]]})", wrong + "'frame' must be"},
      {R"({"id":1,"do":"instrument","capsules":)" + capsule + "}", wrong + "'urdf' is missing"},
      {R"({"id":1,"do":"ping","urdf":"a.urdf"})", wrong + "'urdf' is not a key that 'ping' takes"},
      {joints + R"("q":[1,2],"linear":[0,0,1],"angular":[0,0,1]})", closed},
      {joints + R"("q":[1],"increment":[1],"weights":[1]})", closed},
      {joints + R"("q":[1]})", two_kinds},
      {joints + R"("q":[],"increment":[1]})", wrong + "'q' must be"},
      {joints + R"("q":[1,2,3,4,5,6,7,8,9],"increment":[1]})", wrong + "'q' must be"},
      {joints + R"("q":[1],"increment":[1],"linear":[0,0,1]})", two_kinds},
      {joints + R"("q":[1],"linear":[0,0,1],"weights":[1]})", wrong + "'weights' belong to"},
      {R"({"id":1,"do":"guides","guides":["ball:0,0,0:1"],"of":"arm"})", wrong + "'of' must be"},
      {R"({"id":1,"do":"guides","guides":["ball:0,0,0:1",7]})",
       wrong + "'guides' must be an array"},
      {R"({"id":1,"do":"guides"})", wrong + "'guides' is missing"},
      {R"({"id":1,"do":"polytope","tip":[1,2,3],"radius":[1]})", wrong + "'radius' must be a num"},
      {R"({"id":1,"do":"polytope","tip":[1,2,3]})", wrong + "'radius' is missing"},
      {R"({"id":1,"do":"step","tip":[1,2,3]})", wrong + "'desired' is missing"},
      {R"({"id":1,"do":"step","desired":[0,0,0]})", wrong + "'tip' is missing"},
      {R"({"id":1,"do":"steps"})", wrong + "'motions' is missing"},
      {R"({"id":1,"do":"steps","motions":[[1,2,3,4,5]]})",
       wrong + "'motions' must be an array of arrays of six numbers"},
      {R"({"id":1,"do":"steps","motions":[[1,2,3,4,5,6],[1,2,3,4,5,6],[1,2,3,4,5,6],[1,2,3,4,5,6]]})",
       wrong + "'motions' must be an array of arrays of six numbers, tip and desired increment, at "
               "most 3 of them"},
      {R"({"id":1})", wrong + "'do' is missing"},
      {R"({"id":1,"tip":[1,2,3],"desired":[0,0,0]})", wrong + "'do' is missing"},
      {R"({"id":1,"do":7})", wrong + "'do' must be one of 'step', 'steps'"},
      {R"({"id":1,"do":["step"]})", wrong + "'do' must be one of"},
      {R"({"id":1,"do":"Step"})", wrong + "there is nothing to do by the name 'Step'"},
      {R"({"id":1,"do":"ping","Tip":[1]})", wrong + "there is no key 'Tip'"},
      {R"({"id":1,"do":"ping","\u0007\u00e9":1})", wrong + "there is no key '?"},
      {R"({"id":1,"do":"ping","tip":[1,2,3]})", wrong + "'tip' is not a key that 'ping' takes"},
      {R"({"id":1,"do":"ping","do":"ping"})", wrong + "'do' is given twice"},
      {R"({"id":1,"id":1,"do":"ping"})", wrong + "'id' is given twice"},
      {R"({"id":1,"do":"step","tip":[1,2,3],"tip":[1,2,3]})", wrong + "'tip' is given twice"}};
  for (const std::string bad :
       {"[]", "[[1,2],[3,4]]", "[[],[],[]]", "[[1],[2],[3],[4]]", "{}", "[[1],[2],3]",
        "[[1],[2],[[3]]]", "[[1,2,3,4,5],[1,2,3,4,5],[1,2,3,4,5]]"}) {
    table.emplace_back(step + R"("jacobian":)" + bad + '}', wrong + "'jacobian' must be");
  }
  for (const std::string bad :
       {R"([1,2,3],"bounds":[1])", R"([[]],"bounds":[1])", R"([[1,2,3],[1,2]],"bounds":[1,2])",
        R"([[1,2,3],[1,2,3],[1,2,3]],"bounds":[1,2,3])"}) {
    table.emplace_back(step + R"("rows":)" + bad + '}', wrong + "'rows' must be");
  }
  for (const std::string bad : {"[1,2]", "[1,2,3,4]", "[1,[2],3]", R"([1,"2",3])", "[1,null,3]",
                                "[1,true,3]", "null", R"({"x":1})", "1"}) {
    table.emplace_back(R"({"id":1,"do":"step","tip":)" + bad + '}', one_tip);
  }
  for (const auto& [line, beginning] : table) {
    EXPECT_TRUE(outcome(line).starts_with("1 " + beginning)) << line << '\n' << outcome(line);
  }
}

TEST_F(RequestLine, WhatIsNotJsonOrNoObjectIsTold) {
  std::vector<std::string> lines{"{",
                                 "}",
                                 "{}}",
                                 "x",
                                 "{\"id\":1,}",
                                 "{\"do\":ping}",
                                 "{'do':'ping'}",
                                 "{\"do\":\"ping\"} {}",
                                 "{\"tip\":[1,,2]}",
                                 "{\"tip\":[1,2,3}",
                                 "// comment"};
  for (const char* number :
       {"NaN", "Infinity", "-Infinity", "1e999", "0x10", "01", "+1", ".5", "5."}) {
    lines.push_back("{\"tip\":[1,2," + std::string(number) + "]}");
  }
  for (const char* word : {"\xff", "\xc0\x80", "\xed\xa0\x80", "\\ud800", "a\tb"}) {
    lines.push_back("{\"do\":\"" + std::string(word) + "\"}");
  }
  lines.push_back("\xff\xfe{\"do\":\"ping\"}");
  for (const std::string& line : lines) {
    const std::string told = talk_.ask(line);
    EXPECT_CONTAINS(told, R"("kind":"not_json","message":"the line is not JSON: )") << line;
    for (const char c : told) EXPECT_TRUE((c >= ' ' && c <= '~') || c == '\n') << line;
  }
  for (const std::string_view nul :
       {std::string_view("{\"do\":\"ping\"}\0", 14), std::string_view("{\"do\":\0\"ping\"}", 14)}) {
    EXPECT_TRUE(outcome(nul).starts_with("null not_json: ")) << outcome(nul);
  }
  for (const char* line : {"[]", "7", "null", "true", "\"step\"", "1.5", "-3", "[[1,2],{\"id\":3}]",
                           "[{\"id\":3,\"do\":\"ping\"}]"}) {
    EXPECT_TRUE(outcome(line).starts_with("null not_a_request: a request is one object")) << line;
  }
}

TEST_F(RequestLine, DeepNestingEndsTheReading) {
  for (const char* open : {"[", "{\"tip\":", "{\"x\":[", "{\"id\":["}) {
    std::string line;
    for (int i = 0; i < 100'000; ++i) line += open;
    EXPECT_CONTAINS(outcome(line), "nested more deeply");
  }
}

TEST_F(RequestLine, AnIdIsEchoedAsTheSameValueOrRefused) {
  const std::vector<std::pair<std::string, std::string>> table{
      {"0", "0"},
      {"-7", "-7"},
      {"18446744073709551615", "18446744073709551615"},
      {"-9223372036854775808", "-9223372036854775808"},
      {"null", "null"},
      {R"("")", R"("")"},
      {R"("a\"\\\/\n\u0000\u00e9")", "\"a\\\"\\\\/\\u000a\\u0000\u00e9\""},
      {'"' + std::string(128, 'x') + '"', '"' + std::string(128, 'x') + '"'}};
  for (const auto& [id, echo] : table) {
    const std::string begin = "{\"id\":" + echo + ",";
    EXPECT_EQ(talk_.ask("{\"id\":" + id + ",\"do\":\"ping\"}"), begin + "\"ok\":true}\n");
    for (const auto& [line, kind] :
         {std::pair("{\"do\":\"fly\",\"tip\":7,\"id\":" + id + "}", "not_a_request"),
          std::pair("{\"id\":" + id + ",\"tip\":[", "not_json")}) {
      EXPECT_TRUE(talk_.ask(line).starts_with(begin + R"("error":{"kind":")" + kind)) << line;
    }
  }
  for (const std::string& id : {std::string("1.5"), std::string("18446744073709551616"),
                                std::string("true"), std::string("[1]"), std::string("{\"id\":1}"),
                                std::string("1e2"), '"' + std::string(129, 'x') + '"'}) {
    const std::string told = outcome("{\"id\":" + id + ",\"do\":\"ping\"}");
    EXPECT_TRUE(told.starts_with("null not_a_request: 'id' must")) << id << told;
  }
}

TEST_F(RequestLine, NumbersAreTheNearestDoublesAndThoseWrittenReadBackBitForBit) {
  std::vector<std::pair<std::string, double>> table{
      {"0.1", 0.1},
      {"1e-320", 1e-320},
      {"1e-999", 0.0},
      {"-0", -0.0},
      {"-0.0", -0.0},
      {"9007199254740993", 9007199254740992.0},
      {"18446744073709551617", 18446744073709551616.0},
      {"123456789012345678901234567890", 123456789012345678901234567890.0},
      {"1.7976931348623157e308", 1.7976931348623157e308},
      {"2.2250738585072011e-308", 2.2250738585072011e-308}};
  std::uint64_t bits = 0x9E3779B97F4A7C15u;
  for (int i = 0; i < 20'000; ++i) {
    bits = bits * 6364136223846793005u + 1442695040888963407u;
    const auto value = i == 0 ? -0.0 : std::bit_cast<double>(bits);
    if (!std::isfinite(value)) continue;
    append_number(table.emplace_back("", value).first, value);
  }
  for (const auto& [text, value] : table) {
    ASSERT_EQ(std::bit_cast<std::uint64_t>(radius_in(text)), std::bit_cast<std::uint64_t>(value))
        << text;
  }
}

using Lines = std::vector<std::string>;

TEST_F(RequestLine, LinesDoNotDependOnThePiecesTheyComeIn) {
  ServiceSettings short_lines = settings();
  short_lines.longest_line = 8;
  Service service(test::cube(), short_lines);
  const std::string text = "not_json";
  const std::string number = "not_a_request";
  const std::string large = "line_too_long";
  std::vector<std::pair<std::string, Lines>> table{
      {"one\ntwo\r\n\n\r\n \t\n12345678\n12345678\r\n123456789\nafter\n",
       {text, text, number, number, large, text}},
      // Bytes after the last line end are a line.
      {"a\nb", {text, text}},
      {"a\nb\r", {text, text}},
      {"a\n", {text}},
      {"", {}},
      {"12345678", {number}},
      {"1234567890", {large}},
      {"1234567890123", {large}},
      {"12345678901234567890", {large}},
      {"         ", {large}},
      // A carriage return within a line, and a NUL.
      {"7\r7\n", {text}},
      {"7\r\r\n", {number}},
      {std::string("7\0\n", 3), {text}}};
  for (const std::size_t length : {9, 10, 11, 12, 20, 21, 1000}) {
    for (const char* end : {"\n", "\r\n"}) {
      table.push_back({std::string(length, 'x') + end + "7\n", {large, number}});
    }
  }
  for (const auto& [bytes, expected] : table) {
    for (std::size_t piece = 1; piece <= most_received(service); ++piece) {
      Talk talk(service);
      std::string answers;
      for (std::size_t at = 0; at < bytes.size();) {
        const std::size_t count = std::min(piece, most_received(service) - talk.unread());
        answers += talk.sent(bytes.substr(at, count));
        at += count;
      }
      std::istringstream answered(answers + talk.ask(""));  // the last line needs no line end
      Lines kinds;
      for (std::string line; std::getline(answered, line);) {
        kinds.push_back(Answer::parse(line)["error"]["kind"]);
      }
      EXPECT_EQ(kinds, expected) << bytes << ' ' << piece;
    }
  }
}

/// Several clients of one service.
class ClientTest : public testing::Test {
 protected:
  static ServiceSettings settings() {
    ServiceSettings settings;
    settings.mesh = "bunny";
    settings.constraint.options.radius = 1.0;
    settings.longest_line = 4096;
    return settings;
  }

  std::shared_ptr<const Mesh> mesh_ = mesh_of("cortex");
  Service service_{mesh_, settings()};
  Talk talk_{service_};
};

TEST_F(ClientTest, ClosedLoopsOfSeveralClientsAreThoseOfTheirOwnConstraintsBitForBit) {
  Random random(3);
  std::vector<Vec3> tips = surface_points(*mesh_, 4, 0.6, random);
  tips.push_back(surface_points(*mesh_, 1, -0.3, random).front());  // inside: it escapes
  std::deque<Talk> talks;
  std::vector<MotionConstraint> own;
  for (std::size_t i = 0; i < tips.size(); ++i) {
    talks.emplace_back(service_);
    own.push_back(make_motion_constraint(mesh_, settings().constraint));
  }
  std::vector<Vec3> desired(tips.size(), Vec3::Zero());
  std::size_t limited = 0;
  std::size_t recovering = 0;
  for (int cycle = 0; cycle < 400; ++cycle) {
    for (std::size_t i = 0; i < tips.size(); ++i) {
      if (cycle % 40 == 0) desired[i] = 0.4 * random.direction();
      const Step step = own[i].step({.tip = tips[i], .desired = desired[i]});
      const std::string answer = talks[i].ask(step_line(tips[i], desired[i]));
      ASSERT_TRUE(same_bits(motion_in(answer), step.motion)) << answer;
      ASSERT_NE(answer.find('"' + std::string(name(step.status)) + '"'), std::string::npos);
      limited += step.status == Status::limited;
      recovering += step.status == Status::recovering;
      tips[i] += step.motion;
    }
  }
  EXPECT_GT(limited, 100u);
  EXPECT_GT(recovering, 0u);
}

TEST(ClientWithTools, AToolThatAClientOpensStepsAsPutTogetherByHandBitForBit) {
  ServiceSettings settings;
  settings.constraint.tool = ConvexTool::sphere(3.0);
  Service service(test::cube(), settings);
  Talk other(service);
  const std::string line = step_line({0, 0, 54}, {0, 0, -3});
  const std::string sphere = other.ask(line);
  EXPECT_NEAR(motion_in(sphere).z(), -0.8, 1e-9);
  const auto phases = narrow_phase_backends();
  std::size_t number = 0;
  for (const auto& [text, tool] : test::tools_by_name()) {
    const std::string phase(phases[number++ % phases.size()].name);  // each of them in turn
    Talk talk(service);
    EXPECT_EQ(talk.ask(R"({"do":"tool","tool":")" + text + R"(","narrow_phase":")" + phase + "\"}"),
              "{\"id\":null,\"ok\":true}\n");
    for (const auto& [tip, desired, status, motion] : test::loop_by_hand(tool, phase)) {
      const std::string answer = talk.ask(step_line(tip, desired));
      EXPECT_TRUE(same_bits(motion_in(answer), motion)) << text << " " << phase << " " << answer;
      EXPECT_EQ(Answer::parse(answer)["status"], name(status));
    }
  }
  for (const char* wrong :
       {R"("tool":"sphere:0,0")", R"("tool":"blade:4:2:1","narrow_phase":"a")"}) {
    const std::string request = R"({"do":"tool",)" + std::string(wrong) + '}';
    EXPECT_EQ(other.refusal(request), "no_tool");
  }
  EXPECT_EQ(other.ask(line), sphere) << "neither the tool of others nor one that is none";
  EXPECT_EQ(other.told(R"({"do":"info"})")["settings"]["convex_tool"], true);
}

TEST_F(ClientTest, GuidesThatAClientSetsHoldHisTipAsByHandAndNobodyElses) {
  Talk other(service_);
  EXPECT_EQ(
      talk_.ask(R"({"do":"guides","guides":["corridor=slab:0,0,0:1,0,0:0.5","ball:0,0,0:90"]})"),
      "{\"id\":null,\"ok\":true}\n");
  MotionConstraint own = make_motion_constraint(mesh_, settings().constraint);
  own.set_guides({Guide::point("corridor", Region::slab(Vec3::Zero(), Vec3::UnitX(), 0.5)),
                  Guide::point("ball", Region::ball(Vec3::Zero(), 90.0))});
  Vec3 tip(0, 0, 80);
  std::size_t held = 0;
  Random random(4);
  for (int cycle = 0; cycle < 200; ++cycle) {
    const Vec3 desired = 0.3 * random.direction() + Vec3(0.1, 0, 0.2);
    const Step step = own.step({.tip = tip, .desired = desired});
    const std::string answer = talk_.ask(step_line(tip, desired));
    ASSERT_TRUE(same_bits(motion_in(answer), step.motion)) << answer;
    const Answer told = Answer::parse(answer);
    ASSERT_EQ(told["relaxation"], "none");
    for (std::size_t g = 0; g < 2; ++g) {
      ASSERT_EQ(told["guides"][g]["excess"], step.guides[g].excess);
      ASSERT_EQ(told["guides"][g]["limits"], step.guides[g].limits);
      held += step.guides[g].limits;
    }
    tip += step.motion;
  }
  EXPECT_GT(held, 100u);
  EXPECT_FALSE(other.told(step_line(tip, {1, 0, 0})).contains("guides"));
  EXPECT_EQ(talk_.refusal(R"({"do":"guides","guides":["slab:0,0,0:1,0,0"]})"), "no_guide");
  EXPECT_EQ(talk_.told(step_line(tip, {1, 0, 0}))["guides"].size(), 2u) << "left";
  EXPECT_EQ(talk_.told(R"({"do":"guides","guides":[]})")["ok"], true);
  EXPECT_FALSE(talk_.told(step_line(tip, {1, 0, 0})).contains("guides"));
  EXPECT_EQ(talk_.refusal(R"({"do":"guides","guides":[],"of":"instrument"})"), "no_instrument");
}

#if KEEPOUT_HAS_URDF
/// Opens the psm() of fixtures/robots.h, with its port 200 above the middle of the mesh.
constexpr std::string_view open_line =
    R"({"do":"instrument","urdf":")" KEEPOUT_ROBOTS
    R"(/psm.urdf","frame":[[1,0,0,0],[0,1,0,0],[0,0,1,200],[0,0,0,1]],"margin":0.5,"capsules":)"
    "[[0,0,0,0,4,0,0,0,4.5],[4,0,0,0,5,9.1,0,0,3],[5,9.1,0,0,6,0,10.2,0,1]]}";

TEST_F(ClientTest, InstrumentsOfTwoClientsStepAsTheirOwnConstraintsBitForBit) {
  const Pose base{.position = {0, 0, 200}};
  const Chain read = [&] {
    const UrdfChain chain = read_chain(KEEPOUT_ROBOTS "/psm.urdf", "", "");
    return Chain(chain.joints, base, chain.flange);
  }();
  const Instrument robot = psm();
  const Instrument instrument(read, {robot.bodies().begin(), robot.bodies().end()});
  std::deque<Talk> talks;
  std::vector<InstrumentConstraint> own;
  std::vector<std::vector<double>> q(2, {0, 0, 90, 0, 0, 0});
  for (int i = 0; i < 2; ++i) {
    own.push_back(make_instrument_constraint(mesh_, instrument, {.options = {.margin = 0.5}}));
    talks.emplace_back(service_);
    EXPECT_EQ(talks[i].told(open_line)["bodies"], 3);
  }
  std::size_t limited = 0;
  for (int cycle = 0; cycle < 600; ++cycle) {
    for (std::size_t i = 0; i < 2; ++i) {
      const Twist twist{.linear = {i == 0 ? 0.05 : -0.05, 0, -0.1}};
      const std::vector<double> down{0, 0, 0.1, 0.01, 0, 0};
      const bool by_joints = cycle % 3 == 0;
      const InstrumentStep step = by_joints ? own[i].step(q[i], down) : own[i].step(q[i], twist);
      const std::string line = R"({"do":"joint_step","q":)" + numbers(q[i]) +
                               (by_joints ? R"(,"increment":)" + numbers(down)
                                          : R"(,"linear":)" + numbers({twist.linear.data(), 3})) +
                               '}';
      const std::string answer = talks[i].ask(line);
      ASSERT_TRUE(step.ok());
      ASSERT_NE(answer.find("\"increment\":" + numbers(step.increment) + ","), std::string::npos)
          << answer;
      const Answer told = Answer::parse(answer);
      ASSERT_EQ(told["status"], name(step.status));
      ASSERT_EQ(told["fraction"], step.fraction);
      ASSERT_EQ(told.contains("distance"), step.distance.has_value());
      if (step.distance) {
        ASSERT_EQ(told["distance"], *step.distance);
      }
      limited += step.status == Status::limited;
      for (std::size_t k = 0; k < 6; ++k) q[i][k] += step.increment[k];
    }
  }
  EXPECT_GT(limited, 100u);
}

TEST_F(ClientTest, AnInstrumentKeepsGuidesAndAnatomyThatIsAddedAndMoves) {
  const auto step = [&](const char* linear) {
    return talk_.told(R"({"do":"joint_step","q":[0,0,60,0,0,0],"linear":)" + std::string(linear) +
                      '}');
  };
  const auto place = [](int mesh, const std::string& height, const std::string& more = {}) {
    return R"({"do":"place","mesh":)" + std::to_string(mesh) +
           R"(,"frame":[[1,0,0,0],[0,1,0,0],[0,0,1,)" + height + "],[0,0,0,1]]" + more + '}';
  };
  EXPECT_EQ(talk_.refusal(place(0, "0")), "no_instrument");
  std::string slowed(open_line);
  slowed.insert(slowed.size() - 1, R"(,"slowing_within":20,"slowing_time":0.1)");
  ASSERT_EQ(talk_.told(slowed)["bodies"], 3);
  EXPECT_FALSE(step("[0,0,-0.1]").contains("guides"));

  const std::string over_tip = R"({"do":"guides","of":"instrument","guides":)"
                               R"(["upright=axis:4:0,0,1:0,0,-1:0.5"]})";
  ASSERT_EQ(talk_.told(over_tip)["ok"], true);
  const Answer guided = step("[0.1,0,0]");
  EXPECT_EQ(guided["guides"][0]["name"], "upright");
  EXPECT_EQ(talk_.refusal(R"({"do":"guides","of":"instrument","guides":["ball:0,0,0:1"]})"),
            "no_guide");

  const TemporaryFolder folder;
  const std::string file = folder.write(
      "wall.off", "OFF\n4 2 0\n-300 -300 0\n300 -300 0\n300 300 0\n-300 300 0\n3 0 1 2\n3 0 2 3\n");
  const Answer added = talk_.told(R"({"do":"anatomy","margin":2,"file":")" + file + "\"}");
  ASSERT_EQ(added["mesh"], 1) << added;
  EXPECT_EQ(added["notices"], Answer::array());
  EXPECT_EQ(added["warnings"].size(), 1u);
  EXPECT_CONTAINS(std::string(added["warnings"][0]), "wall.off: the surface is open");
  EXPECT_EQ(talk_.refusal(R"({"do":"anatomy","file":"/none.stl"})"), "no_anatomy");
  // The tip is at 200 - 60 - 3.7. The wall approaches the jaw from 2.001 mm below.
  ASSERT_EQ(talk_.told(place(1, "133.299", R"(,"linear":[0,0,200])"))["ok"], true);
  const Answer pushed = step("[0,0,0]");
  EXPECT_EQ(pushed["nearest_mesh"], 1) << pushed;
  EXPECT_EQ(pushed["status"], "limited");
  EXPECT_LT(pushed["increment"][2], -0.05) << "it is drawn back";
  ASSERT_EQ(talk_.told(place(1, "133.25", R"(,"linear":[0,0,30000])"))["ok"], true);
  const Answer outrun = step("[0,0,0]");
  EXPECT_TRUE(!outrun["ok"] || outrun["status"] == "degraded") << outrun;
  EXPECT_LT(outrun["clearance_fraction"], 1.0);
  EXPECT_EQ(talk_.refusal(place(2, "0")), "no_anatomy");
  const auto add_wall = [&](const std::string& more) {
    return talk_.told(R"({"do":"anatomy","file":")" + file + "\"," + more + '}');
  };
  const Answer scaled = add_wall(R"("unit":"cm","flip":true,"untagged":"lps","space":"RAS")");
  EXPECT_EQ(scaled["notices"],
            Answer({"wall.off: turned from LPS to RAS: x and y have changed their signs",
                    "wall.off: scaled by 10, from cm to mm",
                    "wall.off: flipped: each triangle is wound the other way"}))
      << scaled;
  EXPECT_CONTAINS(std::string(add_wall(R"("unit":"inch")")["error"]["message"]), "not 'inch'");
  EXPECT_CONTAINS(std::string(add_wall(R"("scale":0)")["error"]["message"]), "above 0");
  EXPECT_CONTAINS(std::string(add_wall(R"("space":"rsa")")["error"]["message"]), "'RAS' or 'LPS'");
  EXPECT_CONTAINS(std::string(add_wall(R"("flip":1)")["error"]["message"]), "true or false");
}

TEST_F(ClientTest, WhatIsNoInstrumentIsToldAndLeavesTheOneThereIs) {
  const std::string line = R"({"id":1,"do":"joint_step","q":[0,0,90,0,0,0],"linear":[0,0,0]})";
  EXPECT_EQ(talk_.refusal(line), "no_instrument");
  EXPECT_EQ(talk_.told(open_line)["joints"][2], "insertion");
  EXPECT_EQ(talk_.told(line)["ok"], true);
  for (const auto& [right, wrong] :
       {std::pair("/psm.urdf", "/none.urdf"), std::pair("/psm.urdf", ""),
        std::pair("[[0,0,0,0,4,", "[[0.5,0,0,0,4,"), std::pair("[[0,0,0,0,4,", "[[0,0,0,0,7,"),
        std::pair("4.5]", "-4.5]"), std::pair("[0,0,0,1]]", "[0,0,0,2]]"),
        std::pair("\"margin\":0.5", "\"margin\":0.001")}) {
    std::string changed(open_line);
    changed.replace(changed.find(right), std::string_view(right).size(), wrong);
    const Answer told = talk_.told(changed);
    EXPECT_EQ(told["error"]["kind"], "no_instrument") << changed << told;
    EXPECT_EQ(talk_.told(line)["ok"], true) << "the one before";
  }
  const Answer few = talk_.told(R"({"do":"joint_step","q":[0],"increment":[0]})");
  EXPECT_CONTAINS(std::string(few["error"]["message"]), "'q' must have 6 numbers");
  const Answer failing =
      talk_.told(R"({"do":"joint_step","q":[0,0,1e300,0,0,0],"increment":[0,0,1,0,0,0]})");
  EXPECT_EQ(failing["status"], "invalid_input");
  EXPECT_EQ(failing["increment"], Answer({0, 0, 0, 0, 0, 0}));
  EXPECT_TRUE(failing.contains("reason"));
}
#endif

TEST_F(ClientTest, JointsOfATipAndAPolytopeAreAnsweredAsByItsOwnConstraint) {
  MotionConstraint own = make_motion_constraint(mesh_, settings().constraint);
  Random random(6);
  std::size_t carried_out = 0;
  for (const Vec3& tip : surface_points(*mesh_, 20, 0.6, random)) {
    const Vec3 desired = 0.4 * random.direction();
    const TipJacobian::Matrix identity = Eigen::Matrix3d::Identity();
    const Step step = own.step({.tip = tip, .desired = desired, .jacobian = TipJacobian(identity)});
    std::string line = step_line(tip, desired);
    line.insert(line.size() - 1, R"(,"jacobian":[[1,0,0],[0,1,0],[0,0,1]])");
    std::vector<double> increment(step.increment.begin(), step.increment.end());
    increment.resize(3, 0.0);  // zero motion unless the step is ok
    EXPECT_EQ(talk_.told(line)["increment"], Answer(increment));
    carried_out += step.ok();
    const Polytope polytope = own.free_polytope(tip, 1.5);
    const Answer told =
        talk_.told(R"({"do":"polytope","radius":1.5,"tip":)" + numbers({tip.data(), 3}) + '}');
    EXPECT_EQ(told["status"], name(polytope.status));
    ASSERT_EQ(told["normals"].size(), polytope.planes.size());
    ASSERT_EQ(told["offsets"].size(), polytope.planes.size());
    for (std::size_t i = 0; i < polytope.planes.size(); ++i) {
      const Vec3& normal = polytope.planes[i].normal;
      EXPECT_EQ(told["normals"][i], Answer({normal.x(), normal.y(), normal.z()}));
      EXPECT_EQ(told["offsets"][i], polytope.planes[i].offset);
    }
  }
  EXPECT_GT(carried_out, 10u);
}

TEST_F(ClientTest, AFailingStepIsAnAnswerWithZeroMotionAndAReason) {
  const Answer answer = talk_.told(step_line({0, 0, 60}, {0, 0, -5}));
  EXPECT_EQ(answer["ok"], false);
  EXPECT_EQ(answer["status"], "beyond_reach");
  EXPECT_EQ(answer["reason"], reason(Status::beyond_reach, Subject::tip));
  EXPECT_EQ(answer["motion"], Answer({0, 0, 0}));
  const Answer joints = talk_.told(
      R"({"do":"step","tip":[0,0,60],"desired":[0,0,-5],"jacobian":[[1,0],[0,1],[0,0]]})");
  EXPECT_EQ(joints["increment"], Answer({0, 0}));
}

TEST_F(ClientTest, InfoAndStatusesTellWhatThereIs) {
  const Answer info = talk_.told(R"({"id":"i","do":"info"})");
  EXPECT_EQ(info["id"], "i");
  EXPECT_EQ(info["version"], KEEPOUT_VERSION);
  EXPECT_EQ(info["mesh"]["space"], "unstated");
  EXPECT_EQ(info["mesh"]["notices"], Answer::array());
  EXPECT_EQ(info["mesh"]["triangles"], mesh_->triangle_count());
  EXPECT_EQ(info["settings"]["radius"], 1.0);
  EXPECT_EQ(info["limits"]["line"], 4096);
  const Answer statuses = talk_.told(R"({"do":"statuses"})");
  EXPECT_EQ(statuses["statuses"].size(), status_count);
  for (const Answer& status : statuses["statuses"]) EXPECT_NE(status["status"], "unknown");
  EXPECT_EQ(statuses["statuses"].back()["status"], "unconfirmed");
  EXPECT_EQ(statuses["limits"].size(), limit_count);
}

TEST_F(ClientTest, ATurnEndsSoThatOthersHaveTheirsAndAnswersTakeUpLittle) {
  // A client that does not read gets no more answers.
  for (const std::string line : {"{\"do\":\"ping\"}\n", "{\"do\":\"statuses\"}\n", " \n"}) {
    std::string lines;
    while (lines.size() < 3900) lines += line;
    Client client{service_};
    std::string turn;
    const std::size_t done = take_turn(client, lines, turn);
    EXPECT_GE(done, line.size());
    EXPECT_LE(done, 16 * line.size());
    EXPECT_LT(turn.size(), 80'000u);
    const auto count = line == " \n" ? 0 : std::ranges::count(lines, '\n');
    const std::string all = turn + talk_.sent(lines.substr(done));
    EXPECT_EQ(std::ranges::count(all, '\n'), count);
  }
}

}  // namespace
}  // namespace keepout::app
