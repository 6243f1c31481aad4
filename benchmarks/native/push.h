// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "keepout/index/query.h"
#include "rules/rule.h"
#include "terrain.h"

namespace keepout::peers {

/// A simulated operator that tries to push a tip through a surface.
class Pusher {
 public:
  virtual ~Pusher() = default;

  /// Returns the desired motion of a tip. [mm]
  virtual Vec3 next(const Vec3& tip) = 0;
};

/// The aim of a PointPusher.
enum class Route {
  push,     // straight in
  slide,    // along the surface, leaning on it
  wedge,    // corners and edges nearby, and beyond
  press,    // a place behind the surface, with a tremor
  through,  // random vertices of the mesh
  rim,      // a place next to a rim nearby: Terrain::Kind
  saddle    // a place next to a saddle nearby
};

/// The names of Route.
inline constexpr std::array<std::string_view, 7> route_names{"push",    "slide", "wedge", "press",
                                                             "through", "rim",   "saddle"};

/// Returns the kind of the vertices that a route leads to.
inline Terrain::Kind kind_of(Route route) {
  return route == Route::rim      ? Terrain::Kind::rim
         : route == Route::saddle ? Terrain::Kind::saddle
                                  : Terrain::Kind::plain;
}

/// An operator that sees the tip and the surface, and moves at most `longest` [mm] in a cycle. It
/// decides again after 1 to 10 mm of commanded motion, and on the routes slide and wedge looks
/// again after 0.5 mm. The same random numbers and tips give the same motions.
class PointPusher : public Pusher {
 public:
  /// `terrain` must outlive the pusher.
  PointPusher(const Terrain& terrain, Route route, double longest, const Random& random);
  PointPusher(const PointPusher&) = delete;  // the neighborhood refers to the budget
  PointPusher& operator=(const PointPusher&) = delete;

  Vec3 next(const Vec3& tip) override;

 private:
  void look(const Vec3& tip);
  Vec3 wish(const Vec3& tip, bool decides);
  VertexId choose_vertex(const Vec3& tip, double distance);

  const Terrain* terrain_;
  Route route_;
  double longest_;
  Random random_;
  Budget budget_;
  Neighborhood near_;
  int period_;
  int attention_;
  int cycle_ = 0;
  Vec3 inwards_ = Vec3::Zero(), heading_ = Vec3::Zero(), goal_ = Vec3::Zero();
};

/// An operator that always commands the same motion.
class SteadyPusher : public Pusher {
 public:
  explicit SteadyPusher(const Vec3& motion) : motion_(motion) {}

  Vec3 next(const Vec3& /*tip*/) override { return motion_; }

 private:
  Vec3 motion_;
};

/// The extent of a push.
struct PushSettings {
  double margin;         // required clearance [mm]
  int cycles;            // the most
  int cycles_inside;     // of a tip that has entered; then the push ends
  int best_steps = 0;    // limited steps to compare with the best safe step
  std::uint64_t random;  // seed of their choice
};

/// The judge's findings on a push. Motions count until the tip enters.
struct Push {
  int steps = 0;
  bool entered = false;
  double depth = 0.0;       // the deepest tip, on a closed mesh [mm]
  double clearance;         // of the executed motion, at most twice the margin [mm]
  int unsafe = 0;           // steps that end closer than the margin, and closer than they began
  double free_asked = 0.0;  // length of desired motions that keep the margin [mm]
  double free_lost = 0.0;   // |motion - desired| of these, each at most |desired| [mm]
  double excess = 0.0;      // sum of (|motion - desired| - cost of the best safe step) / |desired|
  int excess_of = 0;        // number of summands
  double seconds = 0.0;     // in the rule
};

/// Pushes a tip from `start`, and judges each step exactly with code that shares nothing with any
/// rule. Without a rule the tip follows the pusher.
Push push(Judge& judge, Rule* rule, Pusher& pusher, const Vec3& start,
          const PushSettings& settings);

}  // namespace keepout::peers
