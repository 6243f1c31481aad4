// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/version.h"

#include <gtest/gtest.h>

#include <string>

namespace keepout {
namespace {

TEST(Version, OfTheHeadersIsThatOfTheLibrary) { EXPECT_EQ(library_version(), KEEPOUT_VERSION); }

TEST(Version, IsMadeOfItsThreeNumbers) {
  EXPECT_EQ(std::to_string(KEEPOUT_VERSION_MAJOR) + "." + std::to_string(KEEPOUT_VERSION_MINOR) +
                "." + std::to_string(KEEPOUT_VERSION_PATCH),
            KEEPOUT_VERSION);
}

}  // namespace
}  // namespace keepout
