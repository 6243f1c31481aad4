// SPDX-License-Identifier: BSD-3-Clause
// The examples do what they claim, on a sphere: their tools come down onto its top.
#include <sys/wait.h>

#include <algorithm>
#include <cstdio>
#include <fstream>

#include "keepout/fixtures/shapes.h"
#include "keepout/mesh/binary_stl.h"
#include "temporary_folder.h"

namespace keepout {
namespace {

/// Runs an example with these arguments; returns its output. Fails unless it ends with `status`.
std::string said(const std::string& example, const std::string& arguments, int status) {
  FILE* pipe = ::popen(("'" KEEPOUT_EXAMPLES + example + "' " + arguments + " 2>&1").c_str(), "r");
  EXPECT_NE(pipe, nullptr);
  char line[256] = "";
  std::string text;
  while (std::fgets(line, sizeof line, pipe) != nullptr) text += line;
  EXPECT_EQ(WEXITSTATUS(::pclose(pipe)), status) << example << ": " << text;
  return text;
}

/// Returns the output of an example for the sphere.
std::string output_of(const std::string& example) {
  const TemporaryFolder folder;
  const auto mesh = folder.path() / "sphere.stl";
  write_binary_stl(mesh, make_sphere(3.0));
  return said(example, "'" + mesh.string() + "'", 0);
}

/// The number of cycles in which the tip was limited, and its final position.
struct Ending {
  int held = 0;
  Vec3 tip = Vec3::Zero();
};

Ending ending_of(const std::string& example) {
  Ending ending;
  const std::string text = output_of(example);
  EXPECT_EQ(std::sscanf(text.c_str(), "held back in %d of 2000 cycles, ends at %lf %lf %lf",
                        &ending.held, &ending.tip.x(), &ending.tip.y(), &ending.tip.z()),
            4)
      << text;
  return ending;
}

// The polyhedron lies up to 0.1 inside the sphere.
constexpr double radius = 50.0 - 0.1;

TEST(Example01, EndsOutsideOfTheMeshByTheMargin) {
  const Ending ending = ending_of("01_keep_out");
  EXPECT_GT(ending.held, 100);
  EXPECT_GT(ending.tip.norm(), radius + 0.5);
}

TEST(Example03, AnOwnIndexKeepsTheTipOutAsBruteForceDoes) {
  int held = 0, cycles = 0, different = 0;
  const std::string text = output_of("03_own_index");
  ASSERT_EQ(std::sscanf(text.c_str(), "held back in %d of %d cycles, %d unlike", &held, &cycles,
                        &different),
            3)
      << text;
  EXPECT_GT(held, 100);
  EXPECT_LT(held, cycles);
  EXPECT_EQ(different, 0);
}

TEST(Example04, TheWholeShaftEndsOutsideOfTheMeshByTheMargin) {
  const Ending ending = ending_of("04_convex_tool");
  EXPECT_GT(ending.held, 100);
  for (int i = 0; i <= 100; ++i) {
    const Vec3 on_the_axis = ending.tip + 0.01 * i * Vec3(8.5, 0, 8.5);
    EXPECT_GT(on_the_axis.norm(), radius + 1.5 + 0.2 - 1e-6);
  }
}

TEST(Example05, AnOwnSolverIsOptimalAndMovesAsActiveSetDoes) {
  int held = 0, cycles = 0, failed = -1, problems = 0;
  double apart = 1.0, residual = 1.0;
  const std::string text = output_of("05_own_solver");
  ASSERT_EQ(std::sscanf(text.c_str(),
                        "held back in %d of %d cycles, %d failed; %lf from active_set; "
                        "KKT residual %lf in %d problems",
                        &held, &cycles, &failed, &apart, &residual, &problems),
            6)
      << text;
  EXPECT_GT(held, 100);
  EXPECT_EQ(failed, 0);
  EXPECT_GT(problems, held);
  EXPECT_LT(apart, 1e-11);
  EXPECT_LT(residual, 1e-12);
}

TEST(Example06, AnOwnProgramInTheFreePolytopeKeepsTheMargin) {
  double closest = 0.0, margin = 0.0, change = 1.0;
  Vec3 tip = Vec3::Zero();
  const std::string text = output_of("06_own_qp");
  ASSERT_EQ(std::sscanf(text.c_str(),
                        "closest %lf of %lf, largest change of a move %lf, ends at %lf %lf %lf",
                        &closest, &margin, &change, &tip.x(), &tip.y(), &tip.z()),
            6)
      << text;
  EXPECT_GE(closest, margin - 1e-8);
  EXPECT_LT(closest, margin + 0.1);  // it comes close to the margin
  EXPECT_LT(change, 0.15);
  EXPECT_GT(tip.norm(), radius + margin - 1e-8);
}

TEST(Example08, TheProxyKeepsTheMarginTheForceSaturatesAndTheEnergiesAddUp) {
  const std::string text = output_of("08_crtk_loop");
  int held = 0, stopped = -1;
  double nearest = 0, tool = 0, hand = 0, to_hand = 0, stored = -1, dissipated = 0, from_proxy = 0,
         active = -1;
  ASSERT_EQ(std::sscanf(text.c_str(),
                        "held back in %d of 4000 cycles, stopped in %d, nearest %lf mm of 1.0\n"
                        "largest force on the tool %lf N, on the hand %lf N\n"
                        "energy [mJ]: to the hand %lf, stored %lf, dissipated %lf, from the proxy "
                        "%lf, active %lf",
                        &held, &stopped, &nearest, &tool, &hand, &to_hand, &stored, &dissipated,
                        &from_proxy, &active),
            10)
      << text;
  EXPECT_GT(held, 1000);
  EXPECT_EQ(stopped, 0) << text;
  EXPECT_GT(nearest, 1.0 - 1e-6);
  EXPECT_LT(nearest, 1.0 + 1e-3) << "it was pressed against the margin";
  EXPECT_NEAR(tool, 4.0, 1e-9);
  EXPECT_NEAR(hand, 2.0, 1e-9);
  EXPECT_EQ(stored, 0.0) << "it has come back";
  EXPECT_NEAR(to_hand + stored + dissipated, from_proxy, 1e-9);
  EXPECT_LT(to_hand, 0.0);
  EXPECT_GE(active, 0.0);
}

TEST(Example08, PushesIntoAMeshThatIsHollowBelowItsMiddle) {
  const TemporaryFolder folder;
  const auto mesh = folder.path() / "bowl.stl";
  Surface bowl = make_sphere(3.0);
  std::erase_if(bowl.triangles, [&](const Corners& corners) {
    return std::ranges::any_of(corners, [&](VertexId v) { return bowl.vertices[v].z() > 10.0; });
  });
  write_binary_stl(mesh, bowl);
  int held = 0;
  const std::string text = said("08_crtk_loop", "'" + mesh.string() + "'", 0);
  ASSERT_EQ(std::sscanf(text.c_str(), "held back in %d of", &held), 1) << text;
  EXPECT_GT(held, 100);
}

TEST(Example08, SaysThatAnInsideOutMeshInAnotherUnitNeverLimitedTheTool) {
  const TemporaryFolder folder;
  const auto mesh = folder.path() / "inside_out.off";
  std::ofstream(mesh) << "OFF\n8 12 0\n"
                         "-5e-3 -5e-3 -5e-3\n5e-3 -5e-3 -5e-3\n-5e-3 5e-3 -5e-3\n5e-3 5e-3 -5e-3\n"
                         "-5e-3 -5e-3 5e-3\n5e-3 -5e-3 5e-3\n-5e-3 5e-3 5e-3\n5e-3 5e-3 5e-3\n"
                         "3 1 2 0\n3 3 2 1\n3 6 5 4\n3 6 7 5\n3 4 1 0\n3 4 5 1\n"
                         "3 3 6 2\n3 7 6 3\n3 2 4 0\n3 6 4 2\n3 5 3 1\n3 5 7 3\n";
  const std::string text = said("08_crtk_loop", "'" + mesh.string() + "'", 1);
  EXPECT_CONTAINS(text, "held back in 0 of 4000 cycles");
  EXPECT_CONTAINS(text,
                  "The mesh never limited the tool: see what `keepout inspect` says about it.");
}

TEST(Example02, TheJointsKeepTheTipOut) {
  int held = 0;
  double nearest = 0.0;
  Vec3 tip = Vec3::Zero();
  const std::string text = output_of("02_joints");
  ASSERT_EQ(std::sscanf(text.c_str(),
                        "held back in %d of 2000 cycles, nearest %lf mm, ends at %lf %lf %lf",
                        &held, &nearest, &tip.x(), &tip.y(), &tip.z()),
            5)
      << text;
  EXPECT_GT(held, 100);
  // The arm moves along arcs, and its Jacobian gives their tangents: 0.2 mm on a radius of 60 mm.
  EXPECT_GT(nearest, 0.5 - 0.001);
  EXPECT_LT(nearest, 0.51) << "it does come there";
  EXPECT_GT(tip.norm(), radius + 0.5 - 0.001);
}

TEST(Example09, TheWholeInstrumentKeepsTheMarginAndAPlannerIsToldHowFarItMayGo) {
  const std::string text = output_of("09_whole_instrument");
  double clear = 0, nearest = 0;
  int held = 0, stopped = -1;
  char body[16] = "";
  Vec3 tip = Vec3::Zero();
  ASSERT_EQ(std::sscanf(
                text.c_str(),
                "clear are %lf mm of 20 (limited)\nheld back in %d of 3000 cycles, stopped in %d, "
                "nearest %lf mm of 0.5: the %15s\nends at %lf %lf %lf",
                &clear, &held, &stopped, &nearest, body, &tip.x(), &tip.y(), &tip.z()),
            8)
      << text;
  // The end of the jaws is 9 mm above the top, and the margin holds except for its band.
  EXPECT_GT(clear, 8.4);
  EXPECT_LT(clear, 8.55);
  EXPECT_GT(held, 1000);
  EXPECT_EQ(stopped, 0) << text;
  EXPECT_GT(nearest, 0.45) << "the margin less its band";
  EXPECT_LT(nearest, 0.5) << "it is pressed against the margin";
  EXPECT_STREQ(body, "jaws");
  EXPECT_GT(tip.norm(), radius + 1.0 + 0.45);
}

TEST(Examples, SayWhatIsWrongWhenTheMeshIsMissing) {
  for (const std::string example :
       {"01_keep_out", "03_own_index", "04_convex_tool", "05_own_solver", "06_own_qp",
        "08_crtk_loop", "02_joints", "09_whole_instrument"}) {
    EXPECT_CONTAINS(said(example, "", 2), "usage:");
    EXPECT_CONTAINS(said(example, "/no/such/mesh.stl", 1), "/no/such/mesh.stl");
  }
}

#ifdef KEEPOUT_HAS_OMPL
TEST(Example07, PlansAroundTheSphere) {
  int motions = 0;
  double length = 0.0;
  const std::string text = output_of("07_plan_with_ompl");
  ASSERT_EQ(std::sscanf(text.c_str(), "a path of %d proven motions, %lf long", &motions, &length),
            2)
      << text;
  EXPECT_GE(motions, 2);
  EXPECT_GT(length, 120.0);  // the straight path would be 120
}

TEST(Example10, PlansForAShaftAroundTheSphere) {
  int motions = 0;
  double length = 0.0;
  const std::string text = output_of("10_plan_joints_with_ompl");
  ASSERT_EQ(
      std::sscanf(text.c_str(), "a path of %d proven joint motions, %lf long", &motions, &length),
      2)
      << text;
  EXPECT_GE(motions, 2);
  EXPECT_GT(length, 100.0);
}
#endif

}  // namespace
}  // namespace keepout
