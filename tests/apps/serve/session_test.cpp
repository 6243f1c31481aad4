// SPDX-License-Identifier: BSD-3-Clause
#include <bit>
#include <charconv>
#include <nlohmann/json.hpp>

#include "factory/tools_by_name.h"
#include "keepout/fixtures/poses.h"
#include "keepout/fixtures/robots.h"
#include "keepout/version.h"
#include "serve/answer.h"
#include "serve/service.h"
#include "temporary_folder.h"
#if KEEPOUT_HAS_URDF
#include "keepout/urdf/read_chain.h"
#include "meshes.h"
#endif

namespace keepout::app {
namespace {

using Json = nlohmann::json;

/// With a memory and a constraint for one client or several.
class SessionTest : public testing::Test {
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
};

void send(Session& session, std::string_view bytes) {
  const std::span<char> room = session.room();
  ASSERT_LE(bytes.size(), room.size());
  std::copy(bytes.begin(), bytes.end(), room.begin());
  session.added(bytes.size());
}

/// All that is answered so far.
std::string taken(Session& session) {
  std::string all;
  while (session.has_work() || !session.unsent().empty()) {
    session.take_turn();
    all += session.unsent();
    session.sent(session.unsent().size());
  }
  return all;
}

std::string ask(Session& session, std::string_view line) {
  send(session, line);
  send(session, "\n");
  return taken(session);
}

std::string step_line(const Vec3& tip, const Vec3& desired) {
  std::string line = "{\"do\":\"step\"";
  for (const auto& [key, v] : {std::pair(",\"tip\":", tip), std::pair(",\"desired\":", desired)}) {
    line += key;
    for (int i = 0; i < 3; ++i) append_number(line += i == 0 ? '[' : ',', v[i]);
    line += ']';
  }
  return line + '}';
}

/// As a client in another language would read it.
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

TEST_F(SessionTest, ClosedLoopsOfSeveralClientsAreThoseOfTheirOwnConstraintsBitForBit) {
  Random random(3);
  std::vector<Vec3> tips = surface_points(*mesh_, 4, 0.6, random);
  tips.push_back(surface_points(*mesh_, 1, -0.3, random).front());  // inside: it is led out
  std::vector<std::unique_ptr<Session>> sessions;
  std::vector<MotionConstraint> own;
  for (std::size_t i = 0; i < tips.size(); ++i) {
    sessions.push_back(std::make_unique<Session>(service_));
    own.push_back(make_motion_constraint(mesh_, settings().constraint));
  }
  std::vector<Vec3> desired(tips.size(), Vec3::Zero());
  std::size_t limited = 0;
  std::size_t recovering = 0;
  for (int cycle = 0; cycle < 400; ++cycle) {
    for (std::size_t i = 0; i < tips.size(); ++i) {
      if (cycle % 40 == 0) desired[i] = 0.4 * random.direction();
      const Step step = own[i].step({.tip = tips[i], .desired = desired[i]});
      const std::string answer = ask(*sessions[i], step_line(tips[i], desired[i]));
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

TEST(SessionWithTools, AToolThatAClientOpensStepsAsPutTogetherByHandBitForBit) {
  ServiceSettings settings;
  settings.constraint.tool = ConvexTool::sphere(3.0);
  Service service(test::cube(), settings);
  Session other(service);
  const std::string line = step_line({0, 0, 54}, {0, 0, -3});
  const std::string sphere = ask(other, line);
  EXPECT_NEAR(motion_in(sphere).z(), -0.8, 1e-9);
  const auto phases = narrow_phase_backends();
  std::size_t number = 0;
  for (const auto& [text, tool] : test::tools_by_name()) {
    const std::string phase(phases[number++ % phases.size()].name);  // each of them once
    Session session(service);
    EXPECT_EQ(
        ask(session, R"({"do":"tool","tool":")" + text + R"(","narrow_phase":")" + phase + "\"}"),
        "{\"id\":null,\"ok\":true}\n");
    for (const auto& [tip, desired, status, motion] : test::loop_by_hand(tool, phase)) {
      const std::string answer = ask(session, step_line(tip, desired));
      EXPECT_TRUE(same_bits(motion_in(answer), motion)) << text << " " << phase << " " << answer;
      EXPECT_EQ(Json::parse(answer)["status"], name(status));
    }
  }
  for (const char* wrong :
       {R"("tool":"sphere:0,0")", R"("tool":"blade:4:2:1","narrow_phase":"a")"}) {
    const std::string request = R"({"do":"tool",)" + std::string(wrong) + '}';
    EXPECT_EQ(Json::parse(ask(other, request))["error"]["kind"], "no_tool");
  }
  EXPECT_EQ(ask(other, line), sphere) << "neither the tool of others nor one that is none";
  EXPECT_EQ(Json::parse(ask(other, R"({"do":"info"})"))["settings"]["convex_tool"], true);
}

TEST_F(SessionTest, GuidesThatAClientSetsHoldHisTipAsByHandAndNobodyElses) {
  Session session(service_);
  Session other(service_);
  EXPECT_EQ(
      ask(session, R"({"do":"guides","guides":["corridor=slab:0,0,0:1,0,0:0.5","ball:0,0,0:90"]})"),
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
    const std::string answer = ask(session, step_line(tip, desired));
    ASSERT_TRUE(same_bits(motion_in(answer), step.motion)) << answer;
    const Json told = Json::parse(answer);
    ASSERT_EQ(told["relaxation"], "none");
    for (std::size_t g = 0; g < 2; ++g) {
      ASSERT_EQ(told["guides"][g]["excess"], step.guides[g].excess);
      ASSERT_EQ(told["guides"][g]["limits"], step.guides[g].limits);
      held += step.guides[g].limits;
    }
    tip += step.motion;
  }
  EXPECT_GT(held, 100u);
  EXPECT_FALSE(Json::parse(ask(other, step_line(tip, {1, 0, 0}))).contains("guides"));
  const Json wrong = Json::parse(ask(session, R"({"do":"guides","guides":["slab:0,0,0:1,0,0"]})"));
  EXPECT_EQ(wrong["error"]["kind"], "no_guide");
  EXPECT_EQ(Json::parse(ask(session, step_line(tip, {1, 0, 0})))["guides"].size(), 2u) << "left";
  EXPECT_EQ(Json::parse(ask(session, R"({"do":"guides","guides":[]})"))["ok"], true);
  EXPECT_FALSE(Json::parse(ask(session, step_line(tip, {1, 0, 0}))).contains("guides"));
  const Json early = Json::parse(ask(session, R"({"do":"guides","guides":[],"of":"instrument"})"));
  EXPECT_EQ(early["error"]["kind"], "no_instrument");
}

#if KEEPOUT_HAS_URDF
std::string numbers(std::span<const double> values) {
  std::string text;
  for (const double value : values) append_number(text += text.empty() ? '[' : ',', value);
  return text + ']';
}

/// Opens what fixtures/robots.h has as psm(), its port in the middle of the mesh, 200 above.
constexpr std::string_view open_line =
    R"({"do":"instrument","urdf":")" KEEPOUT_ROBOTS
    R"(/psm.urdf","frame":[[1,0,0,0],[0,1,0,0],[0,0,1,200],[0,0,0,1]],"margin":0.5,"capsules":)"
    "[[0,0,0,0,4,0,0,0,4.5],[4,0,0,0,5,9.1,0,0,3],[5,9.1,0,0,6,0,10.2,0,1]]}";

TEST_F(SessionTest, InstrumentsOfTwoClientsStepAsTheirOwnConstraintsBitForBit) {
  const Pose base{.position = {0, 0, 200}};
  const Chain read = [&] {
    const UrdfChain chain = read_chain(KEEPOUT_ROBOTS "/psm.urdf", "", "");
    return Chain(chain.joints, base, chain.flange);
  }();
  const Instrument robot = psm();
  const Instrument instrument(read, {robot.bodies().begin(), robot.bodies().end()});
  std::vector<std::unique_ptr<Session>> sessions;
  std::vector<InstrumentConstraint> own;
  std::vector<std::vector<double>> q(2, {0, 0, 90, 0, 0, 0});
  for (int i = 0; i < 2; ++i) {
    own.push_back(make_instrument_constraint(mesh_, instrument, {.options = {.margin = 0.5}}));
    sessions.push_back(std::make_unique<Session>(service_));
    EXPECT_EQ(Json::parse(ask(*sessions[i], open_line))["bodies"], 3);
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
      const std::string answer = ask(*sessions[i], line);
      ASSERT_TRUE(step.ok());
      ASSERT_NE(answer.find("\"increment\":" + numbers(step.increment) + ","), std::string::npos)
          << answer;
      const Json told = Json::parse(answer);
      ASSERT_EQ(told["status"], name(step.status));
      ASSERT_EQ(told["share"], step.share);
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

TEST_F(SessionTest, AnInstrumentKeepsGuidesAndAnatomyThatIsAddedAndMoves) {
  Session session(service_);
  const auto done = [&](const std::string& line) { return Json::parse(ask(session, line)); };
  const auto step = [&](const char* linear) {
    return done(R"({"do":"joint_step","q":[0,0,60,0,0,0],"linear":)" + std::string(linear) + '}');
  };
  EXPECT_EQ(
      done(R"({"do":"place","mesh":0,"frame":[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]})")["error"]
                                                                                          ["kind"],
      "no_instrument");
  std::string slowed(open_line);
  slowed.insert(slowed.size() - 1, R"(,"slowing_within":20,"slowing_time":0.1)");
  ASSERT_EQ(done(slowed)["bodies"], 3);
  EXPECT_FALSE(step("[0,0,-0.1]").contains("guides"));

  const std::string over_tip = R"({"do":"guides","of":"instrument","guides":)"
                               R"(["upright=axis:4:0,0,1:0,0,-1:0.5"]})";
  ASSERT_EQ(done(over_tip)["ok"], true);
  const Json guided = step("[0.1,0,0]");
  EXPECT_EQ(guided["guides"][0]["name"], "upright");
  EXPECT_EQ(done(R"({"do":"guides","of":"instrument","guides":["ball:0,0,0:1"]})")["error"]["kind"],
            "no_guide");

  const TemporaryFolder folder;
  const std::string file = folder.write(
      "wall.off", "OFF\n4 2 0\n-300 -300 0\n300 -300 0\n300 300 0\n-300 300 0\n3 0 1 2\n3 0 2 3\n");
  const Json added = done(R"({"do":"anatomy","margin":2,"file":")" + file + "\"}");
  ASSERT_EQ(added["mesh"], 1) << added;
  EXPECT_EQ(done(R"({"do":"anatomy","file":"/none.stl"})")["error"]["kind"], "no_anatomy");
  const auto place = [](const std::string& height, const std::string& more) {
    return R"({"do":"place","mesh":1,"frame":[[1,0,0,0],[0,1,0,0],[0,0,1,)" + height +
           "],[0,0,0,1]]" + more + '}';
  };
  // The tip is at 200 - 60 - 3.7, and the wall comes up to the jaw from 2.001 mm below.
  ASSERT_EQ(done(place("133.299", R"(,"linear":[0,0,200])"))["ok"], true);
  const Json pushed = step("[0,0,0]");
  EXPECT_EQ(pushed["nearest_mesh"], 1) << pushed;
  EXPECT_EQ(pushed["status"], "limited");
  EXPECT_LT(pushed["increment"][2], -0.05) << "it is drawn back";
  ASSERT_EQ(done(place("133.25", R"(,"linear":[0,0,30000])"))["ok"], true);
  const Json outrun = step("[0,0,0]");
  EXPECT_TRUE(!outrun["ok"] || outrun["status"] == "yielding") << outrun;
  EXPECT_LT(outrun["level"], 1.0);
  EXPECT_EQ(
      done(R"({"do":"place","mesh":2,"frame":[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]})")["error"]
                                                                                          ["kind"],
      "no_anatomy");
}

TEST_F(SessionTest, WhatIsNoInstrumentIsToldAndLeavesTheOneThereIs) {
  const std::string line = R"({"id":1,"do":"joint_step","q":[0,0,90,0,0,0],"linear":[0,0,0]})";
  Session session(service_);
  EXPECT_EQ(Json::parse(ask(session, line))["error"]["kind"], "no_instrument");
  EXPECT_EQ(Json::parse(ask(session, open_line))["joints"][2], "insertion");
  EXPECT_EQ(Json::parse(ask(session, line))["ok"], true);
  for (const auto& [right, wrong] :
       {std::pair("/psm.urdf", "/none.urdf"), std::pair("/psm.urdf", ""),
        std::pair("[[0,0,0,0,4,", "[[0.5,0,0,0,4,"), std::pair("[[0,0,0,0,4,", "[[0,0,0,0,7,"),
        std::pair("4.5]", "-4.5]"), std::pair("[0,0,0,1]]", "[0,0,0,2]]"),
        std::pair("\"margin\":0.5", "\"margin\":0.001")}) {
    std::string changed(open_line);
    changed.replace(changed.find(right), std::string_view(right).size(), wrong);
    const Json told = Json::parse(ask(session, changed));
    EXPECT_EQ(told["error"]["kind"], "no_instrument") << changed << told;
    EXPECT_EQ(Json::parse(ask(session, line))["ok"], true) << "the one before";
  }
  const Json few = Json::parse(ask(session, R"({"do":"joint_step","q":[0],"increment":[0]})"));
  EXPECT_CONTAINS(std::string(few["error"]["message"]), "'q' must have 6 numbers");
  const Json failing = Json::parse(
      ask(session, R"({"do":"joint_step","q":[0,0,1e300,0,0,0],"increment":[0,0,1,0,0,0]})"));
  EXPECT_EQ(failing["status"], "invalid_input");
  EXPECT_EQ(failing["increment"], Json({0, 0, 0, 0, 0, 0}));
  EXPECT_TRUE(failing.contains("reason"));
}
#endif

TEST_F(SessionTest, AFailingStepIsAnAnswerWithZeroMotionAndAReason) {
  Session session(service_);
  const Json answer = Json::parse(ask(session, step_line({0, 0, 60}, {0, 0, -5})));
  EXPECT_EQ(answer["ok"], false);
  EXPECT_EQ(answer["status"], "beyond_reach");
  EXPECT_EQ(answer["reason"], reason(Status::beyond_reach, Subject::tip));
  EXPECT_EQ(answer["motion"], Json({0, 0, 0}));
  const Json joints = Json::parse(
      ask(session,
          R"({"do":"step","tip":[0,0,60],"desired":[0,0,-5],"jacobian":[[1,0],[0,1],[0,0]]})"));
  EXPECT_EQ(joints["increment"], Json({0, 0}));
}

TEST_F(SessionTest, InfoAndStatusesTellWhatThereIs) {
  Session session(service_);
  const Json info = Json::parse(ask(session, R"({"id":"i","do":"info"})"));
  EXPECT_EQ(info["id"], "i");
  EXPECT_EQ(info["version"], KEEPOUT_VERSION);
  EXPECT_EQ(info["mesh"]["space"], "unstated");
  EXPECT_EQ(info["mesh"]["triangles"], mesh_->triangle_count());
  EXPECT_EQ(info["settings"]["radius"], 1.0);
  EXPECT_EQ(info["limits"]["line"], 4096);
  const Json statuses = Json::parse(ask(session, R"({"do":"statuses"})"));
  EXPECT_EQ(statuses["statuses"].size(), status_count);
  for (const Json& status : statuses["statuses"]) EXPECT_NE(status["status"], "unknown");
  EXPECT_EQ(statuses["statuses"].back()["status"], "unsupported");
  EXPECT_EQ(statuses["limits"].size(), limit_count);
}

TEST_F(SessionTest, AClientWhoDoesNotReadIsNotAnsweredAnyFurther) {
  Session session(service_);
  std::string lines;
  while (lines.size() < 3900) lines += "{\"do\":\"statuses\"}\n";
  send(session, lines);
  session.take_turn();
  const std::size_t unsent = session.unsent().size();
  EXPECT_GT(unsent, 0u);
  EXPECT_LT(unsent, 80'000u);
  EXPECT_FALSE(session.has_work());
  EXPECT_FALSE(session.wants_bytes());
  session.sent(unsent - 1);
  EXPECT_FALSE(session.has_work());
  session.sent(1);
  EXPECT_TRUE(session.has_work());
  const std::string rest = taken(session);
  EXPECT_TRUE(session.wants_bytes());
  EXPECT_GT(std::count(rest.begin(), rest.end(), '\n'), 100);
}

TEST_F(SessionTest, ATurnEndsSoThatOthersHaveTheirs) {
  Session session(service_);
  std::string lines;
  for (int i = 0; i < 100; ++i) lines += "{\"do\":\"ping\"}\n";
  send(session, lines);
  session.take_turn();
  const std::string_view first = session.unsent();
  EXPECT_LE(std::count(first.begin(), first.end(), '\n'), 16);
  const std::string all = taken(session);
  EXPECT_EQ(std::count(all.begin(), all.end(), '\n'), 100);
}

TEST_F(SessionTest, TheEndInTheMiddleOfALineIsAnswered) {
  Session whole(service_);
  send(whole, R"({"id":1,"do":"ping"})");
  EXPECT_EQ(taken(whole), "");
  whole.ended();
  EXPECT_EQ(taken(whole), "{\"id\":1,\"ok\":true}\n");
  EXPECT_TRUE(whole.is_done());

  Session cut(service_);
  send(cut, R"({"id":1,"do":"pi)");
  cut.ended();
  EXPECT_EQ(Json::parse(taken(cut))["error"]["kind"], "not_json");
  EXPECT_TRUE(cut.is_done());
}

}  // namespace
}  // namespace keepout::app
