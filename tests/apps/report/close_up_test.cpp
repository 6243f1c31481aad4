// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "report/figures.h"
#include "report/views.h"
#include "report_scene.h"

namespace keepout::app {
namespace {

TEST(Views, TheTellingMomentIsTheDeepestOfARuleNotOfTheFreeHand) {
  const Mesh mesh(tetrahedron());
  Simulation simulation = tetrahedron_simulation(mesh);
  EXPECT_EQ(telling_moment(simulation).run, 2U);
  EXPECT_EQ(telling_moment(simulation).cycle, 40U);
  simulation.runs.pop_back();
  EXPECT_EQ(telling_moment(simulation).run, 0U);
}

constexpr ImageSize close = {200, 150};

TEST(CloseUps, ShowTheWholeStrokeAndEveryMarkedMoment) {
  const Mesh mesh(flat_ground());
  const Simulation simulation = slides(mesh, 0.0);
  const std::vector<CloseUp> views = close_ups(simulation, telling_moment(simulation), close);
  ASSERT_EQ(views.size(), 3U);
  for (const app::Run& run : simulation.runs) {
    for (const Cycle& c : run.strokes[0].cycles) {
      const PicturePoint p = project(views[0].camera, close, c.tip);
      EXPECT_TRUE(p.x > 5.0 && p.x < 195.0 && p.y > 5.0 && p.y < 135.0) << p.x << ", " << p.y;
    }
  }
  EXPECT_EQ(views[2].worst, 200U);
}

TEST(CloseUps, OfAnOpenSurfaceWithoutAMarginShowMillimetres) {
  const Mesh mesh(flat_ground());
  Simulation simulation = slides(mesh, 0.0, SurfaceKind::open);
  for (app::Run& run : simulation.runs) {
    for (Cycle& c : run.strokes[0].cycles) c.clearance = std::abs(c.clearance);
  }
  simulation.runs[1].crossings = {{0, 100}};
  const Moment moment = telling_moment(simulation);
  EXPECT_EQ(moment.run, 1U);
  EXPECT_EQ(moment.cycle, 100U);
  const std::vector<CloseUp> views = close_ups(simulation, moment, close);
  EXPECT_GT(views[1].camera.view_height, 5.0);
  EXPECT_TRUE(shows(views[1].camera, close, simulation.runs[1].strokes[0].cycles[100].tip));
}

TEST(CloseUps, OfASmallDepthShowItLargeAndMarkWhatIsInSight) {
  const Mesh mesh(flat_ground());
  const Simulation simulation = slides(mesh, 0.1);
  const Moment moment = telling_moment(simulation);
  const std::vector<CloseUp> views = close_ups(simulation, moment, close);
  const double height = views[1].camera.view_height;
  EXPECT_LE(height, 14.0 * 0.1 + 1e-9);
  const auto marked = [&](std::size_t run) {
    return simulation.runs[run].strokes[0].cycles[views[run].worst];
  };
  EXPECT_TRUE(shows(views[1].camera, close, marked(1).tip));
  EXPECT_TRUE(shows(views[2].camera, close, marked(2).tip));
  EXPECT_EQ(marked(2).clearance, 0.5);
  EXPECT_EQ(marked(0).clearance, -4.0);  // out of sight, and told for all that
  EXPECT_NE(close_up_picture(simulation, moment, views[0], 0).find("↓ 4.00\u00a0mm deep"),
            std::string::npos);
}

}  // namespace
}  // namespace keepout::app
