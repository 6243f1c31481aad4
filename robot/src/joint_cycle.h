// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "certificate.h"
#include "contact_row.h"
#include "joint_task.h"
#include "keepout/buffer.h"
#include "keepout/index/query.h"
#include "keepout/robot/instrument_constraint.h"
#include "keepout/step/solver.h"
#include "near_set.h"
#include "point_motion.h"

namespace keepout {

/// What is remembered of a body from cycle to cycle.
struct BodyMemory {
  NearSet near;
  double reach = 0.0;  // of its last motion [length]
  double guard = 0.0;  // how much farther than needed triangles are looked for [length]
  double floor = 0.0;  // what was certified last [length]
};

/// A row that held a motion back: the next cycle begins with it.
struct WarmRow {
  std::size_t body;
  TriangleId triangle;
};

/// The memory of the cycles of one instrument. Made once.
struct CycleMemory {
  CycleMemory(const Instrument& instrument, Neighborhood& near, Solver& solver,
              const InstrumentCapacity& capacity);

  const Instrument& instrument;
  Neighborhood& near;
  Solver& solver;
  double largest_position;  // of a joint: what is farther off is refused [rad or length]
  double tolerance;         // distances are told apart down to this [length]
  bool is_watertight;
  PointMotion motion;
  std::vector<BodyMemory> bodies;
  Buffer<ContactRow> rows;
  Buffer<ContactRow> earlier_rows;  // put aside while better ones are tried
  Buffer<WarmRow> warm;
  std::vector<double> matrix;  // of the problem's rows
  std::vector<double> bounds;
  std::array<Vec3, Instrument::most_points> ended_at;  // where the last step led
  std::uint64_t side_of = 0;  // the mesh that it was on the free side of; 0: unknown
  JointVector increment;      // the answer

  /// Forgets all, and allocates nothing.
  void forget() noexcept;
  /// Forgets where the last step led and what it kept, but not what is near.
  void forget_motion() noexcept;
};

/// One cycle of an instrument: solve, judge, add rows, until the motion is certified; then the
/// increment is it, or the part of one that was. Allocates nothing, throws nothing.
class JointCycle {
 public:
  JointCycle(CycleMemory& memory, const InstrumentOptions& options,
             std::span<const double> q) noexcept;

  /// Preconditions: q and the task are finite; the index is current.
  void run(const JointTask& task, InstrumentStep& result) noexcept;

  /// The share of a motion that is certified; status and distance go to the result. Limits of
  /// joints are not looked at. The same preconditions.
  double prove(const JointVector& increment, InstrumentStep& result) noexcept;

 private:
  /// A motion, and the part of it that is certified.
  struct Trial {
    JointVector increment{};
    int cell = 0;          // proven is the motion up to here
    double share = 0.0;    // of the motion, up to there, that is made: whatever costs least
    double cost = 0.0;     // of that
    bool is_held = false;  // by a row or a joint's limit
    std::size_t rows = 0;  // that hold it
  };

  Status open(InstrumentStep& result) noexcept;
  Status open_body(std::size_t body, InstrumentStep& result) noexcept;
  bool is_inside() noexcept;
  bool has_moved_on_its_own() const noexcept;
  using Core = std::array<Vec3, Instrument::most_points_of_a_body>;
  void start_body(std::size_t body) noexcept;
  std::span<const Vec3> core_of(std::size_t body, Core& core) const noexcept;
  bool look(std::size_t body, double needed) noexcept;
  double moved(std::size_t body) const noexcept;

  void start_rows() noexcept;
  NearTriangle* find(std::size_t body, TriangleId id) noexcept;
  double at(std::size_t body) const noexcept;
  void remember_all_rows() noexcept;
  bool seek(const JointTask& task, Trial& best) noexcept;
  void turn(const JointTask& task, Trial& best) noexcept;
  SolveStatus solve(const JointTask& task, Trial& trial) noexcept;
  SolveStatus pose(const JointTask& task, double softness, Solution& solution) noexcept;
  void judge(Trial& trial) noexcept;
  bool answer_failures() noexcept;
  void clip(JointVector& increment) const noexcept;
  bool is_worn_out() const noexcept;

  CycleMemory& memory_;
  const InstrumentOptions& options_;
  std::span<const double> q_;
  JointVector low_;  // the least increments that limits allow, and the largest
  JointVector high_;
  std::array<double, Instrument::most_bodies> kept_;  // of each body in this cycle [length]
  std::array<Certificate::Failure, Instrument::most_bodies> failures_;
  Status trouble_ = Status::free;  // why nothing can be judged
  bool is_recovering_ = false;
  int rounds_ = 0;
  std::size_t looked_at_ = 0;
};

}  // namespace keepout
