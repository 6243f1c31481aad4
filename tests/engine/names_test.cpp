// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <regex>
#include <set>
#include <utility>

#include "keepout/option_table.h"
#include "keepout/registry.h"
#include "keepout/status.h"
#include "keepout/step/options.h"
#include "keepout/version.h"
#include "messages.h"

namespace keepout {
namespace {

constexpr std::pair<Subject, const char*> subjects[] = {
    {Subject::tip, "tip"}, {Subject::instrument, "instrument"}, {Subject::polytope, "polytope"}};

/// Returns the options, members of results and capacities that a reason for a subject may name.
std::set<std::string> names_of(Subject subject) {
  switch (subject) {
    case Subject::tip:
      return {"radius",
              "tool_radius",
              "margin",
              "damping",
              "recovery",
              "deepest",
              "limits",
              "Capacity::triangles",
              "Capacity::work_units"};
    case Subject::instrument:
      return {"margin",
              "band",
              "damping",
              "limits",
              "clearance_fraction",
              "InstrumentCapacity::triangles",
              "InstrumentCapacity::work_units"};
    case Subject::polytope:
      break;
  }
  return {"Capacity::triangles", "Capacity::work_units"};
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

TEST(Version, OfTheHeadersIsThatOfTheLibrary) { EXPECT_EQ(library_version(), KEEPOUT_VERSION); }

TEST(Version, IsMadeOfItsThreeNumbers) {
  EXPECT_EQ(std::to_string(KEEPOUT_VERSION_MAJOR) + "." + std::to_string(KEEPOUT_VERSION_MINOR) +
                "." + std::to_string(KEEPOUT_VERSION_PATCH),
            KEEPOUT_VERSION);
}

constexpr std::array<std::string_view, 6> rules_and_indices = {
    "certified", "all_faces", "paper", "wide_bvh", "bullet", "bullet_quantized"};

TEST(NearestName, IsOneLetterAwayFromTheOneThatWasMeant) {
  for (const std::string_view mistyped : {"papr", "papper", "paber", "papre", "Paper", "paper"}) {
    EXPECT_EQ(nearest_name(mistyped, rules_and_indices), "paper") << mistyped;
  }
}

TEST(NearestName, IsTheOneWithTheFewestEdits) {
  constexpr std::array<std::string_view, 3> words = {"stone", "stove", "store"};
  EXPECT_EQ(nearest_name("stovee", words), "stove");
  EXPECT_EQ(nearest_name("stoe", words), "stone") << "of equals the first";
  EXPECT_EQ(nearest_name("sotre", words), "store") << "a swap is one edit, not two";
}

TEST(NearestName, IsTheOneThatWasMeant) {
  EXPECT_EQ(nearest_name("certifed", rules_and_indices), "certified");
  EXPECT_EQ(nearest_name("all-faces", rules_and_indices), "all_faces");
  EXPECT_EQ(nearest_name("widebvh", rules_and_indices), "wide_bvh");
  EXPECT_EQ(nearest_name("Bulet", rules_and_indices), "bullet");
  EXPECT_EQ(nearest_name("quantized", rules_and_indices), "bullet_quantized") << "a piece of it";
}

TEST(NearestName, IsNothingWhereNoNameIsClose) {
  EXPECT_EQ(nearest_name("nonsense", rules_and_indices), std::nullopt);
  EXPECT_EQ(nearest_name("", rules_and_indices), std::nullopt);
  EXPECT_EQ(nearest_name("a", rules_and_indices), std::nullopt) << "which is in most names";
  EXPECT_EQ(nearest_name("paper", {}), std::nullopt);
}

TEST(Registry, AsksWhetherTheNearestNameWasMeant) {
  struct Part {
    std::string_view name;
  };
  constexpr std::array<Part, 2> parts = {Part{"certified"}, Part{"paper"}};
  constexpr std::array<PeerPart, 1> absent = {PeerPart{"embree", "Embree"}};
  const auto refusal = [&](std::string_view name) {
    return error_of([&] { Registry<Part>("rule", parts, absent).named(name); });
  };
  EXPECT_EQ(refusal("paper"), "no error");
  EXPECT_EQ(refusal("certifed"),
            "there is no rule 'certifed'; did you mean 'certified'? known: certified, paper");
  EXPECT_EQ(refusal("embre"),
            "there is no rule 'embre'; did you mean 'embree'? known: certified, paper");
  EXPECT_EQ(refusal("nonsense"), "there is no rule 'nonsense'; known: certified, paper");
  EXPECT_EQ(
      refusal("embree"),
      "rule 'embree' is not here: it needs Embree; if the module is elsewhere, name its folder "
      "in the environment variable KEEPOUT_MODULES; there are: certified, paper");
}

std::string refusal(const StepOptions& options) {
  return error_of([&] { require_in_range(step_options, options); });
}

TEST(OptionTable, EachDefaultIsInRangeAndReadsBackAsText) {
  const StepOptions usual;
  const Capacity capacity;
  EXPECT_EQ(refusal(usual), "no error");
  EXPECT_NO_THROW(require_in_range(capacity_options, capacity));
  for (const auto& option : step_options) {
    EXPECT_EQ(option.parsed(text_of(option.get(usual))), option.get(usual)) << option.name;
  }
}

TEST(OptionTable, AValueOutOfRangeIsRefusedByNameAndRange) {
  EXPECT_EQ(refusal({.radius = 0.0}), "radius: expected a number from 1e-15 to 1e15, got 0");
  EXPECT_EQ(refusal({.margin = -0.5}),
            "margin: expected 0 or a number from 1e-15 to 1e15, got -0.5");
  EXPECT_EQ(refusal({.refinements = 1001}),
            "refinements: expected a whole number from 0 to 1000, got 1001");
  EXPECT_EQ(refusal({.query = static_cast<Query>(7)}),
            "query: expected 'motion' or 'sphere', got 'no value'");
}

TEST(OptionTable, AnOptionIsSetByNameInItsOwnKindOnly) {
  StepOptions options;
  option_named(step_options, "query").set(options, std::string("sphere"));
  option_named(step_options, "margin").set(options, std::int64_t{3});
  option_named(step_options, "nodes").set(options, std::int64_t{16});
  EXPECT_EQ(options.query, Query::sphere);
  EXPECT_EQ(options.margin, 3.0);
  EXPECT_EQ(options.nodes, 16);
  const auto& nodes = option_named(step_options, "nodes");
  EXPECT_THROW(nodes.set(options, 1.5), Error);
  EXPECT_THROW(nodes.set(options, true), Error);
  EXPECT_THROW(nodes.parsed("16x"), Error);
  EXPECT_THROW(option_named(step_options, "query").set(options, std::string("far")), Error);
  EXPECT_EQ(options.nodes, 16);
}

}  // namespace
}  // namespace keepout
