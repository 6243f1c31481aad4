// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/option_table.h"

#include <gtest/gtest.h>

#include <string>

#include "keepout/error.h"
#include "keepout/step/options.h"

namespace keepout {
namespace {

std::string refusal(const StepOptions& options) {
  try {
    require_in_range(step_options, options);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(OptionTable, EachDefaultIsInRangeAndReadsBackAsText) {
  const StepOptions usual;
  const Capacity capacity;
  EXPECT_EQ(refusal(usual), "");
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
