// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "certificate.h"
#include "contact_row.h"
#include "keepout/buffer.h"
#include "keepout/geometry/pose.h"
#include "keepout/geometry/twist.h"
#include "keepout/index/query.h"
#include "keepout/robot/instrument_options.h"
#include "keepout/robot/instrument_step.h"
#include "keepout/step/guide.h"
#include "keepout/step/solver.h"
#include "near_set.h"
#include "point_motion.h"
#include "relative_motion.h"

namespace keepout {

/// One of the meshes, where it is, and what is remembered of it.
struct MeshMemory {
  std::unique_ptr<Neighborhood> near;
  double own_margin;  // 0: that of the options [length]
  bool is_watertight;
  RelativeMotion motion;                                    // the instrument's, as the mesh sees it
  Pose pose = {};                                           // as the next cycle begins
  Twist velocity = {};                                      // [length/s], [rad/s]
  bool is_misplaced = false;                                // it was told to be nowhere
  std::array<Vec3, Instrument::most_points> ended_at = {};  // where the last step led, as it saw it
  std::uint64_t side_of = 0;  // the mesh that it was found on the free side of; 0: unknown

  double margin(const InstrumentOptions& options) const noexcept {
    return own_margin > 0.0 ? own_margin : options.margin;
  }
};

/// What is remembered of a body beside a mesh from cycle to cycle.
struct PairMemory {
  std::size_t body;
  std::size_t mesh;
  NearSet near;
  double reach = 0.0;            // of its last motion [length]
  double guard = 0.0;            // how much farther than needed triangles are looked for [length]
  double floor = 0.0;            // what was certified last [length]
  bool is_side_unknown = false;  // it was dropped, so that the body may have crossed the surface
  // Of this cycle.
  double kept = 0.0;        // what is to be certified, where meshes are not too fast
  double aim = 0.0;         // the margin that rows aim at [length]
  double level = 1.0;       // the fraction of `kept` that is to be certified
  bool is_dropped = false;  // nothing is certified of it: no motion was found that would be
  bool is_settled = false;  // no joint moves the body, and its proof is done
  Certificate::Failure failure = {};  // what the last trial could not be proven for
};

/// The same of a guide.
struct GuideMemory {
  Guide guide;
  double floor = 0.0;  // how far within its region it was certified last; below 0: out of it
};

/// Bodies and meshes, at the most.
constexpr std::size_t most_pairs = Instrument::most_bodies * InstrumentCapacity::most_meshes;

/// Beyond that no number is one of a task, a speed or a duration.
constexpr double largest_number = 1e9;

/// A row that held a motion back: the next cycle begins with it.
struct WarmRow {
  std::size_t owner;  // see ContactRow
  TriangleId triangle;
};

/// What is certified in a cycle of something that should keep `target`, and is at `distance`, when
/// `floor` was certified last and `room` is to be left to a motion: the target, where it is kept;
/// else never less than last time, unless it was moved by somebody else, or what it lies beside
/// was.
inline double certified_distance(double distance, double floor, double target, double room,
                                 double tolerance) noexcept {
  if (distance >= target - 2.75 * tolerance) return target;
  const double held = std::min(floor, target);
  const double missing = held - distance;
  if (missing > 4.0 * tolerance) return distance - room;
  return std::min(std::max(held, distance - room), target);
}

/// The memory of the cycles of one instrument. Made once.
struct CycleMemory {
  /// Of no mesh yet.
  CycleMemory(const Instrument& instrument, Solver& solver, const InstrumentCapacity& capacity);

  const Instrument& instrument;
  Solver& solver;
  Budget budget;            // of a cycle, for all meshes
  double largest_position;  // of a prismatic joint or a mesh: farther off is refused [length]
  double tolerance;         // distances are told apart down to this [length]
  PointMotion motion;
  std::vector<MeshMemory> meshes;
  std::vector<PairMemory> pairs;  // all bodies with the first mesh, with the second, and so on
  std::vector<GuideMemory> guides;
  std::vector<GuideState> guide_states;            // of the last cycle
  Buffer<DegradedClearance> degraded{most_pairs};  // of the last cycle
  Buffer<ContactRow> rows;
  Buffer<ContactRow> earlier_rows;  // put aside while better ones are tried
  Buffer<WarmRow> warm;
  Buffer<WarmRow> earlier_warm;
  std::vector<double> matrix;  // of the problem's rows
  std::vector<double> bounds;
  JointVector increment;  // the answer

  /// Joint k (1..n) is to be at most so far from 0, so that no digit of a way is lost that matters:
  /// sixteen turns, or a hundred times the lengths at hand. [rad or length]
  double farthest(int k) const noexcept {
    return instrument.chain().joint(k).kind == JointKind::prismatic ? largest_position : 100.0;
  }
  /// Returns the same for a guide. A direction is rounded by some 1e-15, and joint positions by
  /// some 1e-14 rad, whatever the lengths. [length or rad]
  double tolerance_of(const Guide& guide) const noexcept {
    return guide.is_angular() ? 1e-12 : tolerance;
  }
  /// Makes what depends on the meshes, which may be others by now; forgets all. Allocates.
  void prepare();
  /// Makes what depends on where they are. How far meshes may be placed and joints may go does not
  /// depend on it, so that repeated placing cannot raise it.
  void measure() noexcept;
  /// Returns true if tolerance is too large for the least margin, the band, or a guide's band.
  bool is_lost_in_rounding(const InstrumentOptions& options) const noexcept;
  /// Throws Error unless all options are in range and rounding leaves something of the margins.
  void require_usable(const InstrumentOptions& options) const;
  /// Whether any mesh moves.
  bool is_moving() const noexcept {
    return std::any_of(meshes.begin(), meshes.end(), [](const MeshMemory& mesh) {
      return !mesh.velocity.linear.isZero(0.0) || !mesh.velocity.angular.isZero(0.0);
    });
  }
  /// Forgets all, and allocates nothing.
  void forget() noexcept;
  /// What was certified last, of pairs and guides.
  using Floors = std::array<double, most_pairs + Guide::most>;
  Floors floors() const noexcept;
  /// Takes it to be that.
  void set_floors(const Floors& floors) noexcept;
  /// Forgets it.
  void forget_floors() noexcept;
  /// Forgets where the last step led and what held it back, but not what is near.
  void forget_motion() noexcept;
};

}  // namespace keepout
