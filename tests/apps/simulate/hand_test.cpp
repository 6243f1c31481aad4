// SPDX-License-Identifier: BSD-3-Clause
#include "simulate/hand.h"

#include <gtest/gtest.h>

#include "meshes.h"
#include "messages.h"

namespace keepout::app {
namespace {

using Hand = std::vector<std::vector<Vec3>>;

Audit audit_of(Surface surface) { return Audit(mesh_of(std::move(surface))); }

Surface inside_out(Surface surface) {
  for (Corners& corners : surface.triangles) std::swap(corners[0], corners[1]);
  return surface;
}

Surface joined(Surface one, const Surface& other) {
  const auto first = static_cast<VertexId>(one.vertices.size());
  one.vertices.insert(one.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (Corners corners : other.triangles) {
    for (VertexId& vertex : corners) vertex += first;
    one.triangles.push_back(corners);
  }
  return one;
}

constexpr HandSettings short_hand{.strokes = 12, .cycles = 200};

TEST(Hand, StrokesGoFromFreeSpaceThroughTheSurfaceAndBack) {
  Audit audit = audit_of(make_cube(10.0));
  const Hand hand = make_hand(audit, short_hand);
  ASSERT_EQ(hand.size(), 12u);
  for (const std::vector<Vec3>& stroke : hand) {
    ASSERT_EQ(stroke.size(), 200u);
    EXPECT_GT(audit.clearance(stroke.front()), 5.0);
    EXPECT_GT(audit.clearance(stroke.back()), 4.0);
    EXPECT_LT(audit.clearance(stroke[60]), 0.0);
  }
}

TEST(Hand, TheSameSeedMovesAlike) {
  Audit audit = audit_of(make_cube(10.0));
  HandSettings other_seed = short_hand;
  other_seed.seed = 2;
  const Hand hand = make_hand(audit, short_hand);
  EXPECT_EQ(hand, make_hand(audit, short_hand));
  EXPECT_NE(hand, make_hand(audit, other_seed));
}

TEST(Hand, AFlatSheetIsPushedThroughFromItsFreeSide) {
  Audit audit = audit_of(make_flat_plate(5.0, 1));
  for (const std::vector<Vec3>& stroke : make_hand(audit, short_hand)) {
    EXPECT_GT(stroke.front().z(), 5.0);
    EXPECT_LT(stroke[60].z(), 0.0);
  }
}

TEST(Hand, ASingleTriangleIsEnough) {
  Audit audit = audit_of({{{0, 0, 0}, {100, 0, 0}, {0, 100, 0}}, {{0, 1, 2}}});
  for (const std::vector<Vec3>& stroke : make_hand(audit, short_hand)) {
    EXPECT_GT(stroke.front().z(), 5.0);
    EXPECT_LT(stroke[60].z(), 0.0);
    for (const Vec3& goal : stroke) ASSERT_TRUE(goal.allFinite());
  }
}

TEST(Hand, AMeshThatKeepsTheToolInsideIsPushedFromInside) {
  Audit audit = audit_of(make_concave_sphere(5.0));  // of radius 50, the inside is free
  for (const std::vector<Vec3>& stroke : make_hand(audit, short_hand)) {
    EXPECT_LT(stroke.front().norm(), 46.0);
    EXPECT_GT(stroke[60].norm(), 49.5);
  }
}

TEST(Hand, PlacesThatFaceOutwardsArePreferred) {
  // A shell: half of its area is the wall of a cavity that has room enough.
  Surface cavity = make_concave_sphere(5.0);
  for (Vec3& vertex : cavity.vertices) vertex *= 0.8;
  Audit audit = audit_of(joined(make_sphere(5.0), cavity));
  for (const std::vector<Vec3>& stroke : make_hand(audit, short_hand)) {
    EXPECT_GT(stroke.front().norm(), 50.0);
  }
}

TEST(Hand, WithoutRoomAnywhereTheErrorNamesTheRemedy) {
  Audit audit = audit_of(inside_out(make_thin_plates(10.0)));  // free are the plates: 1 mm
  const std::string message = error_of([&] { make_hand(audit, short_hand); });
  for (const char* word : {"no free place", "room for 8 mm", "flip", "keepout inspect"}) {
    EXPECT_CONTAINS(message, word);
  }
}

}  // namespace
}  // namespace keepout::app
