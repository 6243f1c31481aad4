// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cstdio>

#include "keepout/fixtures/random.h"
#include "keepout/fixtures/robots.h"
#include "keepout/urdf/read_chain.h"
#include "messages.h"
#include "trials.h"

namespace keepout {
namespace {

/// An arm with a mount of fixed joints, one joint of each kind, and two tips.
const std::string arm = R"(<?xml version="1.0"?>
<robot name="arm">
  <!-- A comment with a <tag> in it. -->
  <link name="world"/><link name="base"/><link name="upper"/><link name="fore"/><link name="hand"/>
  <link name="tool"/><link name="camera"/>
  <joint name="mount" type="fixed"><parent link="world"/><child link="base"/>
    <origin xyz="0 0 0.5" rpy="0 0 1.5707963267948966"/></joint>
  <joint name="turn" type="revolute"><parent link="base"/><child link="upper"/>
    <origin xyz="0.1 0 0"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="2" effort="1" velocity="3"/></joint>
  <joint name="slide" type="prismatic"><parent link="upper"/><child link="fore"/>
    <axis xyz="0.5774 0.5774 0.5774"/><limit lower="-0.1" upper="0.2" effort="1" velocity="0.3"/></joint>
  <joint name="spin" type="continuous"><parent link="fore"/><child link="hand"/></joint>
  <joint name="grip" type="fixed"><parent link="hand"/><child link="tool"/>
    <origin xyz="0 0 0.05"/></joint>
  <joint name="bracket" type="fixed"><parent link="hand"/><child link="camera"/></joint>
</robot>
)";

std::string with(std::string text, const std::string& old, const std::string& other) {
  const std::size_t at = text.find(old);
  EXPECT_NE(at, std::string::npos) << old;
  return text.replace(at, old.size(), other);
}

/// Fails unless a text is rejected with these words, after the name of the file.
void expect_refused(const std::string& text, const std::string& words, const std::string& base = "",
                    const std::string& tip = "tool", double scale = 1000.0) {
  const std::string said = error_of([&] { parse_chain(text, "arm.urdf", base, tip, scale); });
  EXPECT_TRUE(said.starts_with("arm.urdf: ")) << said;
  EXPECT_CONTAINS(said, words);
}

/// Fails unless the arm, with `old` replaced by `other`, is rejected with these words.
void expect_fault(const std::string& old, const std::string& other, const std::string& words) {
  expect_refused(with(arm, old, other), words);
}

void expect_same(const Chain& expected, const std::string& name) {
  const UrdfChain read = read_chain(std::string(KEEPOUT_ROBOTS) + "/" + name + ".urdf", "", "");
  EXPECT_EQ(read.robot, name);
  const Chain chain(read.joints, {}, read.flange);
  ASSERT_EQ(chain.size(), expected.size());
  const auto expect_near = [](const Pose& a, const Pose& b) {
    EXPECT_LT((a.position - b.position).norm(), 1e-12);
    EXPECT_LT((a.rotation - b.rotation).cwiseAbs().maxCoeff(), 1e-15);
  };
  for (int k = 1; k <= chain.size(); ++k) {
    const Joint& joint = chain.joint(k);
    EXPECT_EQ(joint.name, expected.joint(k).name);
    EXPECT_EQ(joint.kind, expected.joint(k).kind);
    EXPECT_EQ(joint.axis, expected.joint(k).axis);
    expect_near(joint.origin, expected.joint(k).origin);
    EXPECT_DOUBLE_EQ(joint.limits.lower, expected.joint(k).limits.lower);
    EXPECT_DOUBLE_EQ(joint.limits.upper, expected.joint(k).limits.upper);
    EXPECT_DOUBLE_EQ(joint.limits.velocity, expected.joint(k).limits.velocity);
    EXPECT_EQ(read.links[static_cast<std::size_t>(k)], joint.name + "_link");
  }
  expect_near(chain.flange(), expected.flange());
}

TEST(Urdf, TheRobotsOfTheFilesAreThoseOfTheFixtures) {
  expect_same(psm().chain(), "psm");
  expect_same(seven_joint_arm().chain(), "seven_joint_arm");
}

TEST(Urdf, FixedJointsAreMergedAndLengthsAreScaled) {
  const UrdfChain chain = parse_chain(arm, "arm.urdf", "", "tool");
  EXPECT_EQ(chain.links, (std::vector<std::string>{"world", "upper", "fore", "hand"}));
  ASSERT_EQ(chain.joints.size(), 3u);
  EXPECT_LT((chain.joints[0].origin.position - Vec3(0, 100, 500)).norm(), 1e-12);
  EXPECT_LT((chain.joints[0].origin.rotation.col(0) - Vec3::UnitY()).norm(), 1e-15);
  EXPECT_EQ(chain.joints[0].limits.upper, 2.0) << "radians are not scaled";
  EXPECT_EQ(chain.joints[0].limits.velocity, 3.0);
  EXPECT_EQ(chain.joints[1].limits.lower, -100.0);
  EXPECT_EQ(chain.joints[1].limits.velocity, 300.0);
  EXPECT_DOUBLE_EQ(chain.joints[1].axis.norm(), 1.0) << "to three digits it was";
  EXPECT_EQ(chain.joints[2].axis, Vec3::UnitX()) << "where none is told";
  EXPECT_EQ(chain.joints[2].limits.upper, test::infinity);
  EXPECT_EQ(chain.joints[2].limits.velocity, test::infinity);
  EXPECT_EQ(chain.flange.position, Vec3(0, 0, 50));
  const UrdfChain part = parse_chain(arm, "arm.urdf", "base", "fore", 1.0);
  EXPECT_EQ(part.links, (std::vector<std::string>{"base", "upper", "fore"}));
  EXPECT_EQ(part.joints[0].origin.position, Vec3(0.1, 0, 0));
}

TEST(Urdf, WhatIsOffTheWayIsNotAskedFor) {
  const std::string other =
      with(arm, "\"bracket\" type=\"fixed\"", "\"bracket\" type=\"floating\"");
  EXPECT_EQ(parse_chain(other, "arm.urdf", "", "tool").joints.size(), 3u);
  expect_refused(other, "joint 'bracket' is floating", "", "camera");
}

TEST(Urdf, EachFaultOfTheTextHasAMessageOfItsOwn) {
  expect_fault("</robot>", "", "not XML");
  expect_fault("</robot>", "<!-- </robot>", "not XML: '<!--");
  expect_fault("<robot name=\"arm\">", "<robot>", "No name given for the robot");
  expect_fault("<link name=\"hand\"/>", "", "hand");
  expect_fault("<link name=\"hand\"/>", "<link name=\"fore\"/>", "'fore' is not unique");
  expect_fault("name=\"slide\"", "name=\"turn\"", "two joints are called 'turn'");
  expect_fault("</robot>", "</robot><robot/>", "one element <robot>");
  expect_refused("", "not XML: Error document empty");
  expect_refused("solid cube", "arm.urdf: not XML");
  expect_refused("<mujoco/>", "one element <robot>");
}

TEST(Urdf, EachFaultOfTheTreeHasAMessageOfItsOwn) {
  expect_refused(arm, "no link 'bass'; did you mean 'base'?", "bass");
  expect_refused(arm, "name one of base, camera, fore, hand", "", "x7");
  expect_refused(arm, "'fore' is not below 'tool'", "tool", "fore");
  expect_refused(arm, "name one of camera, tool", "", "");
  expect_refused(arm, "0 joints move between", "hand", "tool");
  expect_refused(arm, "the scale", "", "tool", 0.0);
  expect_fault("child link=\"camera\"", "child link=\"upper\"", "'upper' is the child of joint");
  expect_fault("child link=\"camera\"", "child link=\"world\"", "is part of a loop");
  expect_fault("parent link=\"base\"", "parent link=\"fore\"", "is part of a loop");
  expect_fault("child link=\"camera\"", "child link=\"hand\"", "'hand' is the child of joint");
  expect_fault("parent link=\"hand\"", "parent link=\"hans\"", "parent link [hans] of joint");
  expect_fault("parent link=\"fore\"", "parent", "missing a parent");
}

TEST(Urdf, EachFaultOfAJointHasAMessageOfItsOwn) {
  const std::string axis = "<axis xyz=\"0 0 1\"/>";
  const std::string limit = "<limit lower=\"-1\" upper=\"2\" effort=\"1\" velocity=\"3\"/>";
  expect_fault(axis, "<axis xyz=\"0 0 0\"/>", "joint 'turn' has a zero axis");
  expect_fault(axis, "<axis/>", "joint 'turn' has a zero axis");
  expect_fault(axis, "<axis xyz=\"0 0 2\"/>", "joint 'turn' has an axis of length 2.0");
  expect_fault(axis, "<axis xyz=\"0 0 0.998\"/>", "joint 'turn' has an axis of length 0.998");
  expect_fault(axis, "<axis xyz=\"0 0 1e300\"/>", "joint 'turn' has an axis of length");
  expect_fault(axis, "<axis xyz=\"0 1\"/>", "Malformed axis element for joint [turn]");
  expect_fault(axis, axis + "<axis xyz=\"1 0 0\"/>", "joint 'turn' has <axis> twice");
  expect_fault("\"revolute\"", "\"floating\"", "joint 'turn' is floating");
  expect_fault("\"revolute\"", "\"planar\"", "joint 'turn' is planar");
  expect_fault("\"revolute\"", "\"ball\"", "no known type [ball]");
  expect_fault(axis, axis + "<mimic joint=\"spin\"/>", "joint 'turn' mimics");
  expect_fault(limit, "", "turn");
  expect_fault("upper=\"2\" ", "", "joint 'turn' has no upper limit");
  expect_fault("lower=\"-1\" ", "", "joint 'turn' has no lower limit");
  expect_fault("effort=\"1\" ", "", "no effort");
  expect_fault(" velocity=\"3\"", "", "no velocity");
  expect_fault("velocity=\"3\"", "velocity=\"0\"", "'turn' has a velocity limit not above zero");
  expect_fault("velocity=\"3\"", "velocity=\"-1\"", "'turn' has a velocity limit not above zero");
  expect_fault("velocity=\"3\"", "velocity=\"inf\"", "joint [turn]");
  expect_fault("velocity=\"0.3\"", "velocity=\"1e307\"",
               "'slide' has a velocity limit that is not");
  expect_fault("upper=\"0.2\"", "upper=\"1e307\"", "'slide' has a limit that is not finite");
  expect_fault("upper=\"2\"", "upper=\"-2\"", "joint 'turn' has lower above upper limit");
  expect_fault("upper=\"2\"", "upper=\"nan\"", "joint [turn]");
  expect_fault("xyz=\"0.1 0 0\"", "xyz=\"1e307 0 0\"",
               "the origin of joint 1 ('turn') is not a pose");
  expect_fault("xyz=\"0.1 0 0\"", "xyz=\"0.1 0 nan\"", "joint [turn]");
}

TEST(Urdf, MoreJointsThanAChainMayHaveAreRefused) {
  std::string robot = "<robot name=\"worm\"><link name=\"l0\"/>";
  for (const char digit : std::string("012345678")) {
    std::string joint = R"(<link name="l!"/><joint name="j@" type="continuous">)"
                        R"(<parent link="l@"/><child link="l!"/></joint>)";
    std::replace(joint.begin(), joint.end(), '@', digit);
    std::replace(joint.begin(), joint.end(), '!', static_cast<char>(digit + 1));
    robot += joint;
  }
  robot += "</robot>";
  expect_refused(robot, "9 joints move between 'l0' and 'l9', not 1 to 8", "", "");
  EXPECT_EQ(parse_chain(robot, "worm.urdf", "", "l8").joints.size(), 8u);
}

TEST(Urdf, HostileSizesAreRefusedBeforeTheParserSeesThem) {
  const auto repeated = [](const std::string& piece, int times) {
    std::string text;
    for (int i = 0; i < times; ++i) text += piece;
    return text;
  };
  const auto grown = [](const std::string& inside) {
    return with(arm, "</robot>", inside + "</robot>");
  };
  expect_refused(grown(std::string(std::size_t{16} << 20, ' ')), "16 MiB");
  expect_refused(grown(std::string(1, '\0')), "zero byte");
  expect_refused(grown(repeated("<x>", 1'000'000)), "nested too deep");
  expect_refused(grown(repeated("<x><!--</x>-->", 1000)), "too deep");
  expect_refused(grown(repeated("<x y=\"</x>\">", 1000)), "not XML");
  expect_refused(grown("<?x > " + repeated("<x>", 1000)), "too deep");
  expect_refused("</x>" + repeated("<x>", 1000), "no beginning");
  expect_refused(grown("<x " + repeated("a ", 9000) + "/>"), "2048");
  expect_refused(grown(repeated("<x/>", 300'000)), "too many");
  std::string joints;
  for (int i = 0; i < 1100; ++i) joints += "<joint name=\"extra" + std::to_string(i) + "\"/>";
  expect_refused(grown(joints), "more than 1000 joints");
}

TEST(Urdf, WhatCannotBeReadIsSaid) {
  for (const char* path : {"/nowhere/arm.urdf", "/", "/dev/null", "/dev/zero"}) {
    const std::string said = error_of([&] { read_chain(path, "", ""); });
    EXPECT_TRUE(said.starts_with(std::string(path) + ": ")) << said;
  }
}

TEST(Urdf, NothingIsPrintedAboutAFaultyFile) {
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  expect_fault("\"revolute\"", "\"ball\"", "Joint [turn] has no known type [ball]");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

using std::string;

/// Returns the position and the length of a random part of a text, of at most `longest` bytes.
std::pair<std::size_t, std::size_t> stretch(const string& text, std::size_t longest,
                                            Random& random) {
  const std::size_t at = random.below(text.size());
  return {at, std::min(text.size() - at, 1 + random.below(longest))};
}

/// Returns the position of one of these characters from a random place on, or the last position.
std::size_t next(const string& text, const char* characters, Random& random) {
  const std::size_t at = text.find_first_of(characters, random.below(text.size()));
  return at == string::npos ? text.size() - 1 : at;
}

/// Returns the text from one '<' to the next '>'.
string element(const string& text, std::size_t at) {
  return text.substr(at, text.find('>', at) - at + 1);
}

void mutate(string& text, Random& random) {
  static constexpr std::array numbers{"nan", "-inf",   "1e400", "1e308", "-1e308", "0", "-0",
                                      "-1",  "1e-320", "1e17",  "0x1p3", "1,5",    "",  "00.5e0"};
  const std::size_t kind = random.below(6);
  if (kind == 0) {
    text[random.below(text.size())] ^= static_cast<char>(1 << random.below(8));
  } else if (kind == 1) {
    const auto [at, length] = stretch(text, 60, random);
    text.erase(at, length);
  } else if (kind == 2) {
    const auto [at, length] = stretch(text, 400, random);
    text.insert(random.below(text.size()), text.substr(at, length));
  } else if (kind == 3) {
    const std::size_t at = next(text, "0123456789-", random);
    const std::size_t end = text.find_first_not_of("0123456789-.e", at);
    text.replace(at, std::min(end, text.size()) - at, numbers[random.below(numbers.size())]);
  } else if (kind == 4) {
    // Exchanges two elements.
    const std::size_t first = next(text, "<", random);
    const string one = element(text, first);
    const std::size_t second = next(text, "<", random);
    if (second < first + one.size()) return;
    const string other = element(text, second);
    text.replace(second, other.size(), one);
    text.replace(first, one.size(), other);
  } else {
    // Copies one quoted text over another one: names, types and numbers appear in wrong places.
    const std::size_t from = text.find('"', next(text, "=", random)) + 1;
    const std::size_t to = text.find('"', next(text, "=", random)) + 1;
    const string word = text.substr(from, text.find('"', from) - from);
    if (to != 0) text.replace(to, std::min(text.find('"', to), text.size()) - to, word);
  }
}

/// Returns true if a text is accepted. Fails unless the chain then has finite and valid numbers.
bool is_taken(const string& text) {
  try {
    const UrdfChain read = parse_chain(text, "mutant", "", "tip");
    const Chain chain(read.joints, {}, read.flange);
    for (const Joint& joint : read.joints) {
      EXPECT_TRUE(joint.origin.position.allFinite() && joint.origin.rotation.allFinite());
      EXPECT_NEAR(joint.axis.norm(), 1.0, 1e-12);
      EXPECT_LE(joint.limits.lower, joint.limits.upper);
      EXPECT_GT(joint.limits.velocity, 0.0);
    }
    EXPECT_TRUE(read.flange.position.allFinite() && read.flange.rotation.allFinite());
    EXPECT_EQ(read.links.size(), read.joints.size() + 1);
    return true;
  } catch (const Error& error) {
    EXPECT_TRUE(string(error.what()).starts_with("mutant: ")) << error.what();
    return false;
  }
}

void judge(const string& name, std::uint64_t seed) {
  std::ifstream stream(string(KEEPOUT_ROBOTS) + "/" + name + ".urdf");
  const string original{std::istreambuf_iterator<char>(stream), {}};
  Random random(seed);
  const int mutants = test::trials(20'000);
  int taken = 0;
  for (int i = 0; i < mutants; ++i) {
    string text = original;
    for (std::size_t edits = 1 + random.below(3); edits > 0; --edits) mutate(text, random);
    SCOPED_TRACE(name + ", mutant " + std::to_string(i));
    taken += is_taken(text);
    ASSERT_FALSE(testing::Test::HasFailure()) << text;
  }
  std::printf("%s: %d of %d mutants are chains\n", name.c_str(), taken, mutants);
  EXPECT_TRUE(is_taken(original));
  EXPECT_GT(taken, mutants / 20) << "mutants that come far";
  EXPECT_LT(taken, mutants - mutants / 5) << "mutants that do not";
}

TEST(UrdfMutants, AreChainsOrRefused) {
  judge("psm", 31);
  judge("seven_joint_arm", 32);
}

}  // namespace
}  // namespace keepout
