// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/status.h"

#include <gtest/gtest.h>

#include <regex>
#include <set>
#include <utility>

#include "messages.h"

namespace keepout {
namespace {

constexpr std::pair<Subject, const char*> subjects[] = {
    {Subject::tip, "tip"}, {Subject::instrument, "instrument"}, {Subject::polytope, "polytope"}};

/// Returns what a subject has that a reason may name: options, members of results and capacities.
std::set<std::string> names_of(Subject subject) {
  switch (subject) {
    case Subject::tip:
      return {"radius", "tool_radius",         "margin",         "damping", "recovery", "deepest",
              "limits", "Capacity::triangles", "Capacity::looks"};
    case Subject::instrument:
      return {"margin",
              "band",
              "damping",
              "limits",
              "level",
              "InstrumentCapacity::triangles",
              "InstrumentCapacity::looks"};
    case Subject::polytope:
      break;
  }
  return {"Capacity::triangles", "Capacity::looks"};
}

/// Returns all matches of a pattern's first group.
std::set<std::string> matches(const std::string& text, const char* pattern) {
  const std::regex regex(pattern);
  std::set<std::string> all;
  for (std::sregex_iterator it(text.begin(), text.end(), regex), end; it != end; ++it) {
    all.insert((*it)[1]);
  }
  return all;
}

TEST(Status, HasANameAndAReasonForEachSubject) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < status_count; ++i) {
    const auto status = static_cast<Status>(i);
    names.insert(std::string(name(status)));
    for (const auto& [subject, called] : subjects) {
      EXPECT_GT(reason(status, subject).size(), 20u) << name(status) << " of a " << called;
    }
  }
  EXPECT_EQ(names.size(), status_count);
  EXPECT_FALSE(names.contains("unknown"));
  EXPECT_EQ(name(static_cast<Status>(status_count)), "unknown");
  EXPECT_EQ(reason(static_cast<Status>(status_count), Subject::tip), "unknown status");
}

TEST(Status, ReasonsNameOnlyWhatTheirSubjectHas) {
  for (std::size_t i = 0; i < status_count; ++i) {
    const auto status = static_cast<Status>(i);
    for (const auto& [subject, called] : subjects) {
      SCOPED_TRACE(std::string(name(status)) + " of a " + called);
      const std::string text(reason(status, subject));
      const std::set<std::string> allowed = names_of(subject);
      for (const std::string& option : matches(text, "`([a-z_]+)`")) {
        EXPECT_TRUE(allowed.contains(option)) << option;
      }
      for (const std::string& option : matches(text, "([A-Za-z]*Capacity::[a-z_]+)")) {
        EXPECT_TRUE(allowed.contains(option)) << option;
      }
      if (subject == Subject::instrument) {
        for (const char* of_a_tip : {"tip ", "Jacobian", "motion sphere", "tool_radius"}) {
          EXPECT_LACKS(text, of_a_tip) << of_a_tip;
        }
      } else {
        for (const char* of_an_instrument : {"body", "bodies", "place()", "joint position"}) {
          EXPECT_LACKS(text, of_an_instrument) << of_an_instrument;
        }
      }
    }
  }
}

TEST(Limits, AreASet) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < limit_count; ++i) {
    const auto limit = static_cast<Limit>(i);
    names.insert(std::string(name(limit)));
    Limits limits;
    EXPECT_TRUE(limits.empty());
    limits.add(limit);
    limits.add(limit);
    EXPECT_EQ(limits.bits(), 1u << i);
    for (std::size_t k = 0; k < limit_count; ++k) {
      EXPECT_EQ(limits.has(static_cast<Limit>(k)), k == i);
    }
  }
  EXPECT_EQ(names.size(), limit_count);
  EXPECT_EQ(name(static_cast<Limit>(limit_count)), "unknown");
}

}  // namespace
}  // namespace keepout
