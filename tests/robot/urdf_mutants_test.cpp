// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>

#include "keepout/error.h"
#include "keepout/fixtures/random.h"
#include "keepout/urdf/read_chain.h"
#include "trials.h"

namespace keepout {
namespace {

using std::string;

/// A stretch of at most so many bytes.
std::pair<std::size_t, std::size_t> stretch(const string& text, std::size_t longest,
                                            Random& random) {
  const std::size_t at = random.below(text.size());
  return {at, std::min(text.size() - at, 1 + random.below(longest))};
}

/// The first of these characters from a random place on, or the last place.
std::size_t next(const string& text, const char* characters, Random& random) {
  const std::size_t at = text.find_first_of(characters, random.below(text.size()));
  return at == string::npos ? text.size() - 1 : at;
}

/// From one '<' to the '>' behind it.
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
    // Two elements change places.
    const std::size_t first = next(text, "<", random);
    const string one = element(text, first);
    const std::size_t second = next(text, "<", random);
    if (second < first + one.size()) return;
    const string other = element(text, second);
    text.replace(second, other.size(), one);
    text.replace(first, one.size(), other);
  } else {
    // What is in quotes becomes what is elsewhere in quotes: names, types and numbers get around.
    const std::size_t from = text.find('"', next(text, "=", random)) + 1;
    const std::size_t to = text.find('"', next(text, "=", random)) + 1;
    const string word = text.substr(from, text.find('"', from) - from);
    if (to != 0) text.replace(to, std::min(text.find('"', to), text.size()) - to, word);
  }
}

/// Whether a text is taken, in which case it has to be a chain of numbers.
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
