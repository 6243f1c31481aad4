// SPDX-License-Identifier: BSD-3-Clause
#include "joint_cycle.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "keepout/index/placement.h"
#include "keepout/mesh/doctor.h"

namespace keepout {
namespace {

constexpr int most_rounds = 16;
constexpr int most_recovery_rows = 4;    // of a body
constexpr double alike = 0.9;            // normals with more than this cosine recover alike
constexpr double worthwhile = 1e-6;      // a share of the cost
constexpr double touching_within = 4.0;  // tolerances

double reach_beyond_axis(const Instrument& instrument, std::size_t body) {
  const std::vector<LinkPoint>& points = instrument.bodies()[body].points;
  if (points.size() < 3) return 0.0;
  const Vec3& a = points[0].position;
  const Vec3 along = points[1].position - a;
  const double length2 = along.squaredNorm();
  double most = 0.0;
  for (const LinkPoint& point : points) {
    const double share =
        length2 > 0.0 ? std::clamp(along.dot(point.position - a) / length2, 0.0, 1.0) : 0.0;
    most = std::max(most, (point.position - a - share * along).norm());
  }
  return most * (1.0 + 1e-12);
}

/// The lengths that there are: of the ways from joint to joint, of what is carried, of the mesh.
double size_of(const Instrument& instrument, const Mesh& mesh) {
  double size = instrument.chain().base().position.norm() +
                mesh.bounds().low.cwiseAbs().cwiseMax(mesh.bounds().high.cwiseAbs()).norm();
  for (int k = 1; k <= instrument.chain().size(); ++k) {
    size += instrument.chain().joint(k).origin.position.norm();
  }
  double carried = 0.0;
  for (const LinkPoint& point : instrument.points()) {
    carried = std::max(carried, point.position.norm());
  }
  return size + carried;
}

}  // namespace

CycleMemory::CycleMemory(const Instrument& its, Neighborhood& its_near, Solver& its_solver,
                         const InstrumentCapacity& capacity)
    : instrument(its),
      near(its_near),
      solver(its_solver),
      largest_position(std::max(100.0 * size_of(its, its_near.mesh()), 100.0)),
      tolerance(1e-12 *
                (size_of(its, its_near.mesh()) + std::min(its.chain().reach(), largest_position))),
      is_watertight(keepout::is_watertight(its_near.mesh())),
      motion(its),
      rows(capacity.planes),
      earlier_rows(capacity.planes),
      warm(capacity.planes) {
  const auto n = static_cast<std::size_t>(its.chain().size());
  for (std::size_t b = 0; b < its.bodies().size(); ++b) {
    bodies.push_back({.near = NearSet(near.room(), reach_beyond_axis(its, b))});
  }
  matrix.resize((2 * n + capacity.planes) * n);
  bounds.resize(2 * n + capacity.planes);
  solver.reserve(static_cast<int>(n), static_cast<int>(bounds.size()));
  forget();
}

void CycleMemory::forget() noexcept {
  forget_motion();
  for (BodyMemory& body : bodies) {
    body.near.forget();
    body.guard = 0.0;
  }
}

void CycleMemory::forget_motion() noexcept {
  warm.clear();
  side_of = 0;
  for (BodyMemory& body : bodies) {
    body.floor = std::numeric_limits<double>::infinity();
    body.reach = 0.0;
  }
}

JointCycle::JointCycle(CycleMemory& memory, const InstrumentOptions& options,
                       std::span<const double> q) noexcept
    : memory_(memory), options_(options), q_(q) {
  const Chain& chain = memory.instrument.chain();
  for (int k = 1; k <= chain.size(); ++k) {
    const auto i = static_cast<std::size_t>(k - 1);
    const JointLimits& limits = chain.joint(k).limits;
    const double most = std::min(limits.velocity * options.period, limits.increment);
    // A joint that is beyond a limit may stay, or come back.
    low_[i] = std::min(std::max(limits.lower - q[i], -most), 0.0);
    high_[i] = std::max(std::min(limits.upper - q[i], most), 0.0);
  }
}

void JointCycle::run(const JointTask& task, InstrumentStep& result) noexcept {
  memory_.increment.fill(0.0);
  result.status = open(result);
  Trial best{.cost = task.cost(memory_.increment)};
  if (is_ok(result.status)) {
    // Where not even the first part of a motion can be proven, a shorter one bends less. The rows
    // that were found stay.
    double asked = 1.0;
    start_rows();
    for (; asked > 0.01; asked *= 0.25) {
      const JointTask part = task.scaled(asked);
      if (seek(part, best)) turn(part, best);
      if (best.share > 0.0 || best.cell == PointMotion::cells) break;
      if (is_worn_out() || trouble_ != Status::free) break;
    }
    if (best.cell == 0) {
      result.status = trouble_ != Status::free ? trouble_ : Status::unsolved;
      remember_all_rows();
    } else if (best.share < 1.0 || asked < 1.0) {
      result.status = Status::fallback;
    } else {
      result.status = best.is_held ? Status::limited : Status::free;
    }
    if (is_ok(result.status) && is_recovering_) result.status = Status::recovering;
  }
  result.rounds = rounds_;
  result.rows = best.rows;
  result.triangles = looked_at_;
  if (!is_ok(result.status)) return;
  const double share = best.share;
  result.share = share;
  const auto n = static_cast<std::size_t>(memory_.instrument.chain().size());
  for (std::size_t k = 0; k < n; ++k) memory_.increment[k] = share * best.increment[k] + 0.0;
  clip(memory_.increment);
  result.increment = {memory_.increment.data(), n};
  // The last motion judged need not be the best one.
  if (memory_.motion.increment() != memory_.increment) {
    memory_.motion.move(memory_.increment, options_.certified, memory_.near.budget());
  }
  const Vec3* ended = memory_.motion.at(PointMotion::cells);
  std::copy(ended, ended + memory_.instrument.points().size(), memory_.ended_at.begin());
  memory_.side_of = memory_.near.mesh().id();
}

double JointCycle::prove(const JointVector& increment, InstrumentStep& result) noexcept {
  result.status = open(result);
  if (!is_ok(result.status)) return 0.0;
  memory_.rows.clear();
  Trial trial{.increment = increment};
  judge(trial);
  if (is_recovering_) result.status = Status::recovering;
  if (trouble_ != Status::free) result.status = trouble_;
  if (is_worn_out()) result.status = Status::unsolved;
  return is_ok(result.status) ? static_cast<double>(trial.cell) / PointMotion::cells : 0.0;
}

/// How each body stands, and what it is to keep.
Status JointCycle::open(InstrumentStep& result) noexcept {
  memory_.motion.start(q_, memory_.near.budget());
  for (std::size_t b = 0; b < memory_.bodies.size(); ++b) {
    start_body(b);
    const Status status = open_body(b, result);
    if (!is_ok(status)) return status;
  }
  if (options_.check_sides && memory_.is_watertight && has_moved_on_its_own() && is_inside()) {
    return is_worn_out() ? Status::over_capacity : Status::inside;
  }
  return Status::free;
}

Status JointCycle::open_body(std::size_t b, InstrumentStep& result) noexcept {
  BodyMemory& body = memory_.bodies[b];
  const double radius = memory_.instrument.bodies()[b].radius;
  const double target = options_.margin - options_.band;
  const double tolerance = memory_.tolerance;
  if (!look(b, at(b))) return Status::over_capacity;
  Certificate certificate(memory_.instrument, b, memory_.motion, target, tolerance,
                          memory_.near.budget());
  double nearest = std::numeric_limits<double>::infinity();
  const double known = radius + options_.margin + options_.band;
  // All at once that the cycle is likely to ask for.
  for (NearTriangle& triangle : body.near.nearer_than(at(b), memory_.near.budget())) {
    if (!(triangle.least < known)) break;
    certificate.know(triangle);
    nearest = std::min(nearest, triangle.at_start.distance);
  }
  if (is_worn_out()) return Status::over_capacity;
  const double distance = nearest - radius;
  if (nearest <= known && !(result.distance && *result.distance <= distance)) {
    result.distance = distance;
    result.nearest = static_cast<int>(b);
  }
  if (nearest <= touching_within * tolerance) return Status::touching;
  const double held = std::min(body.floor, target);
  const double room = std::min(options_.band, 0.5 * nearest);
  if (distance < held - 3.0 * tolerance) {  // moved by somebody else, or the surface was
    kept_[b] = distance - room;
  } else {
    kept_[b] = std::min(std::max(held, distance - room), target);
  }
  is_recovering_ = is_recovering_ || kept_[b] < target;
  body.floor = kept_[b];
  return Status::free;
}

/// Whether a body is where no step has led it, so that its side is unknown.
bool JointCycle::has_moved_on_its_own() const noexcept {
  if (memory_.side_of != memory_.near.mesh().id()) return true;
  for (std::size_t b = 0; b < memory_.bodies.size(); ++b) {
    // So far around its core all is free.
    const double free = 0.5 * (memory_.instrument.bodies()[b].radius + kept_[b]);
    for (const std::uint8_t p : memory_.instrument.points_of(b)) {
      if (!((memory_.motion.at_start()[p] - memory_.ended_at[p]).norm() <= free)) return true;
    }
  }
  return false;
}

/// No core meets the surface, so each is on one side of it, and one point tells which.
bool JointCycle::is_inside() noexcept {
  for (std::size_t b = 0; b < memory_.bodies.size(); ++b) {
    const std::uint8_t last = memory_.instrument.points_of(b).back();
    const auto placement = place(memory_.near, memory_.motion.at_start()[last]);
    if (!placement || !placement->is_free) return true;
  }
  return false;
}

void JointCycle::start_body(std::size_t b) noexcept {
  Core core;
  memory_.bodies[b].near.start_cycle(core_of(b, core));
}

/// The places of a body's points as the cycle begins.
std::span<const Vec3> JointCycle::core_of(std::size_t b, Core& core) const noexcept {
  const std::span<const std::uint8_t> points = memory_.instrument.points_of(b);
  for (std::size_t i = 0; i < points.size(); ++i) core[i] = memory_.motion.at_start()[points[i]];
  return {core.data(), points.size()};
}

/// How far a body's points are from where triangles were looked for.
double JointCycle::moved(std::size_t b) const noexcept {
  const std::span<const Vec3> then = memory_.bodies[b].near.core();
  const std::span<const std::uint8_t> points = memory_.instrument.points_of(b);
  double most = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    most = std::max(most, (memory_.motion.at_start()[points[i]] - then[i]).norm());
  }
  return most;
}

/// Makes sure that all triangles nearer than that to a body's core are known.
bool JointCycle::look(std::size_t b, double needed) noexcept {
  BodyMemory& body = memory_.bodies[b];
  if (body.near.radius() >= 0.0 && body.near.radius() - moved(b) >= needed) return true;
  Core core;
  // Farther where there is little, so that it is looked for seldom; less far where there is much.
  constexpr std::size_t few = 8;
  constexpr std::size_t many = 64;
  const double least = std::max(options_.margin, body.reach);
  body.guard = std::clamp(body.guard, least, std::max(16.0 * options_.margin, 3.0 * body.reach));
  for (const double share : {1.0, 0.125, 0.0}) {
    if (body.near.look(memory_.near, core_of(b, core), needed + share * body.guard)) {
      if (share < 1.0 || body.near.size() > many) body.guard *= 0.5;
      if (body.near.size() < few) body.guard *= 2.0;
      return true;
    }
    if (is_worn_out()) break;
  }
  body.near.forget();
  return false;
}

/// The rows that a cycle begins with: those of the last one, and in recovery those of what is too
/// close.
void JointCycle::start_rows() noexcept {
  memory_.rows.clear();
  ContactRows rows(memory_.instrument, memory_.motion, options_.margin, options_.recovery,
                   memory_.tolerance);
  for (const WarmRow& warm : memory_.warm) {
    const NearTriangle* triangle = find(warm.body, warm.triangle);
    if (triangle == nullptr) continue;
    if (const auto row = rows.witness(warm.body, *triangle, 0)) memory_.rows.push(*row);
  }
  for (std::size_t b = 0; b < memory_.bodies.size(); ++b) {
    if (!(kept_[b] < options_.margin - options_.band)) continue;
    int count = 0;
    BodyMemory& body = memory_.bodies[b];
    const double radius = memory_.instrument.bodies()[b].radius;
    const auto nearby = body.near.nearer_than(radius + options_.margin, memory_.near.budget());
    while (count < most_recovery_rows) {
      // The nearest one that none of the rows leads away from.
      const NearTriangle* nearest = nullptr;
      for (const NearTriangle& triangle : nearby) {
        if (!triangle.is_known || triangle.at_start.distance >= radius + options_.margin) continue;
        if (nearest != nullptr && triangle.at_start.distance >= nearest->at_start.distance)
          continue;
        const bool is_led =
            std::any_of(memory_.rows.begin(), memory_.rows.end(), [&](const ContactRow& row) {
              return row.body == b && (row.triangle == triangle.id ||
                                       row.normal.dot(triangle.at_start.normal) > alike);
            });
        if (!is_led) nearest = &triangle;
      }
      if (nearest == nullptr) break;
      const auto row = rows.witness(b, *nearest, 0);
      if (!row) break;
      memory_.rows.push(*row);
      ++count;
    }
  }
}

/// From a body's core, what it may be held by: the margin, and as much as it moved at last, unless
/// that was a leap. [length]
double JointCycle::at(std::size_t b) const noexcept {
  const double reach = std::min(memory_.bodies[b].reach, 4.0 * options_.margin);
  return memory_.instrument.bodies()[b].radius + options_.margin + std::max(options_.band, reach);
}

/// One of the triangles that a body is at, its gap known.
NearTriangle* JointCycle::find(std::size_t b, TriangleId id) noexcept {
  BodyMemory& body = memory_.bodies[b];
  if (!look(b, at(b))) return nullptr;
  for (NearTriangle& triangle : body.near.nearer_than(at(b), memory_.near.budget())) {
    if (triangle.id != id) continue;
    Certificate(memory_.instrument, b, memory_.motion, kept_[b], memory_.tolerance,
                memory_.near.budget())
        .know(triangle);
    return &triangle;
  }
  return nullptr;
}

/// Where nothing was found the next cycle begins with all that was learned.
void JointCycle::remember_all_rows() noexcept {
  memory_.warm.clear();
  for (const ContactRow& row : memory_.rows) {
    const bool is_there =
        std::any_of(memory_.warm.begin(), memory_.warm.end(), [&](const WarmRow& warm) {
          return warm.body == row.body && warm.triangle == row.triangle;
        });
    if (!is_there) memory_.warm.push({row.body, row.triangle});
  }
}

/// Solves and judges until a motion is certified; else `best` is the best part of those tried, if
/// any is better than standing still, or than what is best already.
bool JointCycle::seek(const JointTask& task, Trial& best) noexcept {
  for (int round = 0; round < most_rounds; ++round) {
    Trial trial;
    const SolveStatus solved = solve(task, trial);
    if (solved != SolveStatus::optimal) {
      if (solved == SolveStatus::ill_posed) trouble_ = Status::ill_posed;
      if (solved == SolveStatus::infeasible) trouble_ = Status::infeasible;
      return false;
    }
    ++rounds_;
    judge(trial);
    // All that is proven; but what costs more than standing still, and than coming back to the
    // margin within the band, only as far as it pays.
    trial.share = static_cast<double>(trial.cell) / PointMotion::cells;
    trial.cost = task.cost_of_share(trial.increment, trial.share);
    const double still = std::sqrt(task.cost_of_share(trial.increment, 0.0));
    const double affordable = still + 2.0 * options_.band;
    if (!is_recovering_ && trial.cost > affordable * affordable) {
      trial.share = task.best_share(trial.increment, trial.share);
      trial.cost = task.cost_of_share(trial.increment, trial.share);
    }
    if (trial.cell == PointMotion::cells && trial.share == 1.0) {
      best = trial;
      return true;
    }
    if (trial.cell > 0 && (best.cell == 0 || trial.cost < best.cost)) best = trial;
    if (trial.cell == PointMotion::cells) return false;
    if (is_worn_out() || trouble_ != Status::free) return false;
    if (!answer_failures()) return false;
  }
  return false;
}

/// Turns the rows that hold a certified motion back to where its end is, while that makes a better
/// one.
void JointCycle::turn(const JointTask& task, Trial& best) noexcept {
  for (int refinement = 0; refinement < options_.refinements; ++refinement) {
    if (memory_.warm.empty() || is_worn_out()) return;
    memory_.earlier_rows.assign(memory_.rows.view());
    ContactRows rows(memory_.instrument, memory_.motion, options_.margin, options_.recovery,
                     memory_.tolerance);
    bool changed = false;
    for (ContactRow& row : memory_.rows) {
      const bool is_active =
          std::any_of(memory_.warm.begin(), memory_.warm.end(), [&](const WarmRow& warm) {
            return warm.body == row.body && warm.triangle == row.triangle;
          });
      NearTriangle* triangle = is_active ? find(row.body, row.triangle) : nullptr;
      if (triangle == nullptr) continue;
      auto turned = rows.witness(row.body, *triangle, PointMotion::cells);
      if (!turned) continue;
      turned->correction = row.correction;
      changed = changed || (turned->normal - row.normal).squaredNorm() > 1e-12;
      row = *turned;
    }
    if (!changed) return;
    Trial trial;
    bool is_better = solve(task, trial) == SolveStatus::optimal;
    if (is_better) {
      trial.share = 1.0;
      trial.cost = task.cost(trial.increment);
      is_better = trial.cost < best.cost * (1.0 - worthwhile);
    }
    if (is_better) {
      ++rounds_;
      judge(trial);
      is_better = trial.cell == PointMotion::cells;
    }
    if (!is_better) {
      memory_.rows.assign(memory_.earlier_rows.view());
      return;
    }
    best = trial;
  }
}

SolveStatus JointCycle::solve(const JointTask& task, Trial& trial) noexcept {
  Solution solution;
  // What leads away gives way where it contradicts itself: at 0 standing still is allowed.
  SolveStatus solved = SolveStatus::infeasible;
  for (const double softness : {1.0, 0.5, 0.25, 0.0}) {
    solved = pose(task, softness, solution);
    if (solved != SolveStatus::infeasible) break;
  }
  if (solved != SolveStatus::optimal) return solved;
  const auto n = static_cast<std::size_t>(task.joints);
  trial.increment.fill(0.0);
  for (std::size_t k = 0; k < n; ++k) {
    if (!std::isfinite(solution.u[k])) return SolveStatus::iteration_limit;
    trial.increment[k] = task.unit[k] * solution.u[k];
  }
  clip(trial.increment);
  trial.is_held = !solution.active.empty();
  memory_.warm.clear();
  for (const std::uint32_t row : solution.active) {
    if (row < memory_.rows.size()) {
      memory_.warm.push({memory_.rows[row].body, memory_.rows[row].triangle});
    }
  }
  trial.rows = memory_.warm.size();
  return solved;
}

SolveStatus JointCycle::pose(const JointTask& task, double softness, Solution& solution) noexcept {
  const auto n = static_cast<std::size_t>(task.joints);
  double* number = memory_.matrix.data();
  std::size_t count = 0;
  for (const ContactRow& row : memory_.rows) {
    for (std::size_t k = 0; k < n; ++k) *number++ = task.unit[k] * row.gradient[k];
    const double bound = (row.bound > 0.0 ? softness * row.bound : row.bound) + row.correction;
    memory_.bounds[count++] = softness > 0.0 ? bound : std::min(bound, 0.0);
  }
  for (std::size_t k = 0; k < n; ++k) {
    for (const double sign : {1.0, -1.0}) {
      const double bound = sign > 0.0 ? low_[k] : -high_[k];
      if (!std::isfinite(bound)) continue;
      std::fill_n(number, n, 0.0);
      number[k] = sign;
      number += n;
      memory_.bounds[count++] = bound / task.unit[k];
    }
  }
  const StepProblem problem{{task.jacobian.data(), task.rows, task.joints},
                            {task.desired.data(), task.rows},
                            {memory_.matrix.data(), static_cast<Eigen::Index>(count), task.joints},
                            {memory_.bounds.data(), static_cast<Eigen::Index>(count)},
                            task.damping};
  solution = {};
  const SolveStatus solved = memory_.solver.solve(problem, solution);
  memory_.near.budget().spend(4 + static_cast<std::size_t>(std::max(solution.iterations, 0)) *
                                      (2 + count / 4));
  return solved;
}

/// How much of a motion is certified, and of each body what speaks against the rest.
void JointCycle::judge(Trial& trial) noexcept {
  Budget& budget = memory_.near.budget();
  memory_.motion.move(trial.increment, options_.certified, budget);
  trial.cell = PointMotion::cells;
  for (std::size_t b = 0; b < memory_.bodies.size(); ++b) {
    failures_[b] = {};
    const double reach = memory_.motion.farthest(b);
    memory_.bodies[b].reach = reach;
    const double needed = memory_.instrument.bodies()[b].radius + kept_[b] + reach;
    if (!look(b, needed)) {
      trial.cell = 0;
      trouble_ = Status::over_capacity;
      return;
    }
    const std::span<NearTriangle> triangles = memory_.bodies[b].near.nearer_than(needed, budget);
    if (triangles.empty()) continue;
    looked_at_ = std::max(looked_at_, triangles.size());
    Certificate certificate(memory_.instrument, b, memory_.motion, kept_[b], memory_.tolerance,
                            budget);
    for (const ContactRow& row : memory_.rows) {
      if (row.body == b) certificate.try_first(row.normal);
    }
    failures_[b] = certificate.judge(triangles, reach);
    trial.cell = std::min(trial.cell, failures_[b].cell);
  }
}

/// Adds rows for what spoke against the last motion, or corrects those there are. Whether anything
/// was changed.
bool JointCycle::answer_failures() noexcept {
  constexpr int most_corrections = 3;
  bool changed = false;
  ContactRows rows(memory_.instrument, memory_.motion, options_.margin, options_.recovery,
                   memory_.tolerance);
  for (std::size_t b = 0; b < memory_.bodies.size(); ++b) {
    const Certificate::Failure& failure = failures_[b];
    if (failure.triangle == nullptr) continue;
    const NearTriangle& triangle = *failure.triangle;
    int witnesses = 0;
    bool has_ends = false;
    for (const ContactRow& row : memory_.rows) {
      if (row.body != b || row.triangle != triangle.id) continue;
      witnesses += row.point.has_value() ? 1 : 0;
      has_ends = has_ends || !row.point.has_value();
    }
    const int cell = std::max(failure.cell, 1);
    const std::size_t before = memory_.rows.size();
    if (witnesses < 2) {
      if (const auto row = rows.witness(b, triangle, cell)) memory_.rows.push(*row);
    } else if (!has_ends) {
      for (const std::uint8_t p : memory_.instrument.points_of(b)) {
        if (memory_.instrument.points()[p].link == 0) continue;
        if (const auto row = rows.end_point(b, p, triangle, cell)) memory_.rows.push(*row);
      }
    } else {
      for (ContactRow& row : memory_.rows) {
        if (row.body != b || row.triangle != triangle.id || row.corrections >= most_corrections) {
          continue;
        }
        // What the straight motion of the point promised, less what the true one kept.
        const double missing = rows.height_at_end(row);
        double promised = row.start_height;
        for (std::size_t k = 0; k < row.gradient.size(); ++k) {
          promised += row.gradient[k] * memory_.motion.increment()[k];
        }
        if (!(promised - missing > 0.0)) continue;
        row.correction += promised - missing;
        ++row.corrections;
        changed = true;
      }
    }
    changed = changed || memory_.rows.size() > before;
  }
  return changed && !memory_.rows.overflowed();
}

/// To the joints' limits: what q + dq rounds to is within them.
void JointCycle::clip(JointVector& increment) const noexcept {
  const Chain& chain = memory_.instrument.chain();
  for (int k = 1; k <= chain.size(); ++k) {
    const auto i = static_cast<std::size_t>(k - 1);
    const JointLimits& limits = chain.joint(k).limits;
    double& step = increment[i];
    step = std::clamp(step, low_[i], high_[i]);
    // Where the sum rounds to beyond a limit it is shortened by the excess, which is known exactly,
    // or by a last digit where that is lost.
    for (int again = 0; again < 4; ++again) {
      const double beyond = std::max(q_[i] + step - limits.upper, limits.lower - (q_[i] + step));
      const bool is_towards =
          step > 0.0 ? q_[i] + step > limits.upper : q_[i] + step < limits.lower;
      if (!(beyond > 0.0) || !is_towards || step == 0.0) break;
      const double shorter = std::min(std::abs(step) - beyond, std::nextafter(std::abs(step), 0.0));
      step = std::copysign(std::max(shorter, 0.0), step);
    }
  }
}

bool JointCycle::is_worn_out() const noexcept { return memory_.near.budget().is_spent(); }

}  // namespace keepout
