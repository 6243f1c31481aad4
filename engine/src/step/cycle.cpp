// SPDX-License-Identifier: BSD-3-Clause
#include "cycle.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "input.h"

namespace keepout {
namespace {

using Verdict = Judgement::Verdict;

// A sound rule needs a handful of rounds, in the tip of a cone some hundred; the limit bounds an
// unsound one.
constexpr int most_rounds = 256;

constexpr int most_halvings = 8;

/// Makes a solver's projection of the aim as exact as the planes are: what it left undone is made
/// up for, and the motion ends in the ball over the aim, where triangles were looked for.
Vec3 sharpened(const Vec3& motion, const Vec3& aim, std::span<const HalfSpace> planes) noexcept {
  // Solvers differ in their last digits; alternating projections on the planes that are violated
  // settle them. Each is at most a last digit for an exact solver.
  constexpr int most_corrections = 32;
  Vec3 z = motion;
  const double digits2 = 1e-30 * aim.squaredNorm();
  for (int i = 0; i < most_corrections; ++i) {
    const HalfSpace* worst = nullptr;
    double violation = 0.0;
    for (const HalfSpace& plane : planes) {
      const double missing = plane.offset - plane.normal.dot(z);
      if (!(missing > violation)) continue;
      violation = missing;
      worst = &plane;
    }
    if (worst == nullptr || !(violation * violation > digits2)) break;
    z += violation * worst->normal;
  }
  const double along = aim.dot(z);
  const double length2 = z.squaredNorm();
  if (along < length2) z *= std::max(along, 0.0) / length2;
  return z;
}

/// Of a solve, in looks: each iteration goes over all rows, and the first over the Jacobian's
/// square.
std::size_t work_of(const StepProblem& problem, const Solution& solution) noexcept {
  constexpr std::size_t numbers_in_a_look = 48;  // as of sixteen planes
  const auto numbers = static_cast<std::size_t>(problem.rows.rows() * problem.rows.cols());
  const auto variables = static_cast<std::size_t>(problem.rows.cols());
  const auto iterations = static_cast<std::size_t>(std::max(solution.iterations, 0));
  return variables * variables * variables / 512 +
         (1 + iterations) * (4 + numbers / numbers_in_a_look);
}

/// The plane that bounds motions in one direction, just short of the longest.
HalfSpace bound_of(const Vec3& motion, double longest) noexcept {
  return {-motion / motion.norm(), -longest * (1.0 - 1e-9), no_triangle};
}

/// Whether any part of a motion that satisfies the caller's rows satisfies them too: none asks for
/// motion.
bool allow_parts(const std::optional<ExtraRows>& rows) noexcept {
  return !rows || std::all_of(rows->bounds(), rows->bounds() + rows->count(),
                              [](double bound) { return bound <= 0.0; });
}

}  // namespace

Cycle::Cycle(Activation& rule, Solver& solver, Workspace& work, Budget& budget,
             const StepOptions& options, const Motion& motion, StageTimes* times) noexcept
    : rule_(rule),
      solver_(solver),
      work_(work),
      budget_(budget),
      options_(options),
      motion_(motion),
      around_(surroundings_of(motion, options, rule.reach())),
      times_(times) {
  // Guides that lead back may ask for more than the projection of the aim can give.
  const bool leads_back = !work.guides.empty() && work.guides.leads_back();
  if (leads_back) around_.reach = around_.searched = Reach::sphere;
  // With joints, rows or damping the answer is no projection.
  around_.is_projected = !motion.jacobian && !motion.rows && options.damping == 0.0 &&
                         solver.reads_planes() && !leads_back;
  if (times_ != nullptr) last_ = std::chrono::steady_clock::now();
}

void Cycle::run(Step& result) noexcept {
  work_.planes.clear();
  if (!work_.has_room_for(motion_)) {
    result.status = Status::over_capacity;
    return;
  }
  // Halving the aim helps only where the region shrinks with it.
  Opening opening = around_.reach == Reach::thales ? open_as_far_as_fits() : open();
  result.distance = opening.distance;
  const bool recovering = opening.status == Status::recovering;
  if (recovering) {
    // The way out is the aim now, and the rule begins once more with what is around that. The
    // motion that leads out is no projection of the aim, but need not be much longer than it.
    around_.aim = opening.aim;
    around_.reach = around_.searched = Reach::sphere;
    around_.longest = std::min(around_.longest, 2.0 * around_.aim.norm());
    opening = open_as_far_as_fits();
  }
  Trial settled{opening.status, Vec3::Zero()};
  if (is_ok(opening.status)) {
    settled = settle();
    ended(&StageTimes::solve);
    result.planes = work_.posed();
  }
  result.status = settled.status;
  result.triangles = rule_.triangles();
  if (!is_ok(settled.status)) return;
  // Number by number, as the increment: no zero has a sign.
  for (int axis = 0; axis < 3; ++axis) result.motion[axis] = settled.motion[axis] + 0.0;
  result.increment = work_.increment();
  report(result);
  if (halvings_ > 0) result.status = Status::fallback;
  if (recovering) result.status = Status::recovering;
}

/// Reports what limits the answer.
void Cycle::report(Step& result) noexcept {
  result.planes = work_.posed_for_answer();
  result.active = work_.active();
  result.relaxation = work_.relaxation();
  result.limits = work_.limits();
  if (halvings_ > 0) {
    result.limits.add(Limit::truncated);
    result.limits.add(halved_for_ == Status::over_capacity ? Limit::capacity : Limit::budget);
  }
  if (result.active.empty()) return;
  const std::size_t of_mesh = work_.planes.size();
  for (const std::uint32_t row : result.active) {
    if (row < of_mesh) {
      const bool is_bound = work_.planes[row].source == no_triangle;
      result.limits.add(is_bound ? Limit::radius : Limit::mesh);
    } else if (row < result.planes.size()) {
      result.limits.add(Limit::guide);
      work_.guides.note_active(row - of_mesh);
    } else {
      result.limits.add(Limit::rows);
    }
  }
}

/// Has the rule look at the triangles that matter for the aim, and begin with them.
Opening Cycle::open() noexcept {
  work_.planes.clear();
  const bool fits = rule_.look_around(around_);
  ended(&StageTimes::query);
  if (!fits) return {budget_.status_at_end()};
  const Opening opening = rule_.start(around_, work_.planes);
  ended(&StageTimes::activation);
  return opening;
}

/// Where there are more triangles than room, or than the budget allows: a shorter way has fewer.
Opening Cycle::open_as_far_as_fits() noexcept {
  const auto attempt = [&] { return budget_.halved([&] { return open(); }); };
  Opening opening = attempt();
  const auto is_too_much = [&] {
    return opening.status == Status::over_capacity || opening.status == Status::out_of_budget;
  };
  while (is_too_much() && halvings_ < most_halvings) {
    halved_for_ = opening.status;
    around_.searched = around_.reach;
    around_.aim *= 0.5;
    if (around_.reach == Reach::sphere) around_.longest *= 0.5;
    ++halvings_;
    opening = attempt();
  }
  return opening;
}

/// Finds a motion that the rule accepts, and improves upon it.
Cycle::Trial Cycle::settle() noexcept {
  Trial best = find();
  if (best.status != Status::limited) return best;
  best = refine(best);
  if (options_.nodes == 0) return best;
  const Trial other = branch(best);
  return other.motion == best.motion ? best : refine(other);
}

/// Solves, and as long as the rule objects to the trial motion, solves again with its plane. What
/// that leaves of the budget is for a part of the last trial.
Cycle::Trial Cycle::find() noexcept {
  limits_ = {};
  Trial last{Status::unsolved, Vec3::Zero()};
  double free_share = 0.0;  // of the last trial
  const std::optional<Trial> found = budget_.halved([&] { return try_in_turn(last, free_share); });
  return found ? *found : fall_back(last, free_share);
}

/// Nothing if it comes to no end; then `last` is the last trial that was judged, and `free_share`
/// how much of it nothing speaks against.
std::optional<Cycle::Trial> Cycle::try_in_turn(Trial& last, double& free_share) noexcept {
  for (int round = 0; round < most_rounds; ++round) {
    const Trial trial = solve();
    // Part of the last trial may be made all the same. With joints its increment is gone.
    const bool has_part = free_share > 0.0 && !motion_.jacobian;
    if (!is_ok(trial.status)) {
      if (!has_part) return trial;
      note(trial.status);
      work_.solution = {};
      break;
    }
    // Beyond the sphere nothing was looked at.
    if (trial.motion.norm() > around_.longest) {
      work_.planes.push(bound_of(trial.motion, around_.longest));
      free_share = 0.0;
      continue;
    }
    // No half-space was left that excludes it.
    if (!work_.guides.allow(trial.motion)) {
      last = trial;
      free_share = 1.0;
      break;
    }
    const Judgement judgement = rule_.judge(around_, trial.motion, work_.planes);
    if (judgement.verdict == Verdict::accepted) {
      work_.keep_answer(motion_, trial.motion, 1.0, relaxation_, {});
      return Trial{work_.solution.active.empty() ? trial.status : Status::limited, trial.motion};
    }
    if (budget_.is_spent()) note(budget_.status_at_end());
    if (budget_.is_spent() && has_part) {  // nothing is known of this one
      work_.solution = {};
      break;
    }
    last = trial;
    free_share = judgement.free_share;
    if (judgement.verdict == Verdict::blocked) break;
  }
  return std::nullopt;
}

/// The part of the last trial up to the first contact, within the guides' regions, provided that it
/// stands the same test.
Cycle::Trial Cycle::fall_back(const Trial& trial, double free_share) noexcept {
  const double allowed = work_.guides.allowed_fraction(trial.motion);
  const double share = std::min(free_share * (1.0 - 1e-9), allowed);
  const Vec3 part = share * trial.motion;
  if (!(share > 0.0) || !allow_parts(motion_.rows) ||
      rule_.judge(around_, part, work_.planes).verdict != Verdict::accepted) {
    if (limits_.has(Limit::capacity)) return {Status::over_capacity, Vec3::Zero()};
    return {limits_.has(Limit::budget) ? Status::out_of_budget : Status::unsolved, Vec3::Zero()};
  }
  limits_.add(Limit::truncated);
  if (free_share < 1.0) limits_.add(Limit::mesh);
  if (allowed < 1.0) limits_.add(Limit::guide);
  work_.guides.note_left_by(trial.motion);
  work_.keep_answer(motion_, part, share, relaxation_, limits_);
  return {Status::fallback, part};
}

/// Notes that the search was cut short.
void Cycle::note(Status ended) noexcept {
  if (ended == Status::out_of_budget) limits_.add(Limit::budget);
  if (ended == Status::over_capacity) limits_.add(Limit::capacity);
}

/// The nearest motion that planes and guides allow; the rule has not judged it yet. free, or what
/// went wrong. If no half-space of a guide is left to add, the motion may leave its region.
Cycle::Trial Cycle::solve() noexcept {
  // The projection of the aim on no plane: it needs no solver.
  const bool is_bare = work_.planes.empty() && !work_.planes.overflowed();
  if (is_bare && around_.is_projected && work_.guides.empty()) {
    work_.solution = {};
    return {Status::free, around_.aim};
  }
  Trial trial = solve_once();
  while (is_ok(trial.status) && !work_.guides.allow(trial.motion)) {
    budget_.spend(1);
    if (!work_.guides.exclude(trial.motion)) break;
    trial = solve_once();
  }
  return trial;
}

Cycle::Trial Cycle::solve_once() noexcept {
  if (work_.planes.overflowed()) return {Status::over_capacity, Vec3::Zero()};
  std::optional<Vec3> answer;
  Status solved = attempt(answer);
  // Planes may contradict each other, or nearly, so that the solver finds a point out of the world,
  // or comes to no end.
  const auto contradict = [&] {
    return solved == Status::infeasible || solved == Status::ill_posed ||
           solved == Status::unsolved;
  };
  while (contradict() && relax()) solved = attempt(answer);
  if (is_ok(solved) && !answer->allFinite()) solved = Status::unsolved;
  if (!is_ok(solved)) return {solved, Vec3::Zero()};
  if (around_.reach == Reach::sphere) return {Status::free, *answer};
  return {Status::free, sharpened(*answer, around_.aim, work_.posed())};
}

/// Relaxes what leads back: guides first. Returns true if any plane changed.
bool Cycle::relax() noexcept {
  if (work_.guides.relax()) {
    relaxation_ = std::max(relaxation_, Relaxation::guides);
    return true;
  }
  if (!rule_.relax(work_.planes)) return false;
  relaxation_ = Relaxation::recovery;
  return true;
}

Status Cycle::attempt(std::optional<Vec3>& answer) noexcept {
  if (budget_.is_spent()) return budget_.status_at_end();
  const StepProblem problem = work_.pose(motion_, around_.aim, options_.damping);
  work_.solution = {};
  const SolveStatus solved = solver_.solve(problem, work_.solution);
  budget_.spend(work_of(problem, work_.solution));
  if (solved != SolveStatus::optimal) return status_of(solved);
  if (work_.solution.u.size() != static_cast<std::size_t>(problem.jacobian.cols())) {
    return Status::unsolved;
  }
  answer = tip_motion(problem, work_.solution, 1e-10 * options_.radius);
  return answer ? Status::free : Status::ill_posed;
}

/// Turns the planes of an accepted motion to where they allow a better one, as long as there is
/// one and options.refinements lasts. All planes go on allowing the motion there is, those of
/// triangles that are met on the way as well, so nothing is lost.
Cycle::Trial Cycle::refine(Trial best) noexcept {
  const Vec3 kept = around_.kept;
  for (int refinement = 0; refinement < options_.refinements; ++refinement) {
    work_.set_aside();
    around_.kept = best.motion;
    if (rule_.turn(around_, work_.earlier_planes.view(), work_.planes)) {
      const Trial next = find();
      const bool accepted = next.status == Status::limited || next.status == Status::free;
      if (accepted && is_worthwhile(next.motion, best.motion)) {
        best = next;
        continue;
      }
    }
    work_.take_back();
    break;
  }
  around_.kept = kept;
  return best;
}

/// Looks for a better motion than the best one known, by branch and bound. Around each triangle
/// there are several ways, each beyond a plane of its own; a node is a choice of one way for each
/// triangle met so far, and no motion within its planes is better than the nearest one. The most
/// promising node is asked first: once the rule accepts its motion, none is better among the ways
/// considered.
///
/// Bounded by options.nodes. What it returns has stood the same test as any other motion, so the
/// bound costs quality and never safety.
Cycle::Trial Cycle::branch(const Trial& best) noexcept {
  work_.set_aside();
  work_.branches.clear();
  open_branch(best);
  for (int node = 0; node < options_.nodes && !budget_.is_spent(); ++node) {
    const Branch* nearest = work_.branches.pop_nearest();
    if (nearest == nullptr) break;
    work_.planes.assign(nearest->planes());
    const Verdict verdict = rule_.judge(around_, nearest->motion, work_.planes).verdict;
    if (verdict == Verdict::accepted) {
      // Solved once more: the solver has gone on since.
      const Trial trial = solve();
      if (!is_ok(trial.status) || trial.motion != nearest->motion) break;
      work_.keep_answer(motion_, trial.motion, 1.0, relaxation_, {});
      return {Status::limited, trial.motion};
    }
    if (verdict == Verdict::blocked) continue;
    // The plane of the contact is one way around the triangle; the rule may know others.
    const TriangleId in_the_way = work_.planes[work_.planes.size() - 1].source;
    open_branch(best);
    work_.ways.clear();
    rule_.ways_around(in_the_way, work_.ways);
    for (const HalfSpace& way : work_.ways) {
      work_.planes.assign(nearest->planes());
      work_.planes.push(way);
      open_branch(best);
    }
  }
  work_.take_back();
  return best;
}

/// Opens a node for the planes at hand, unless it cannot lead to a better motion.
void Cycle::open_branch(const Trial& best) noexcept {
  const Trial trial = solve();
  if (!is_ok(trial.status) || trial.motion.norm() > around_.longest) return;
  if (!work_.guides.allow(trial.motion)) return;
  if (!is_worthwhile(trial.motion, best.motion)) return;
  work_.branches.push((around_.aim - trial.motion).norm(), trial.motion, work_.planes.view());
}

/// Whether a motion is nearer to the aim by more than a millionth of it.
bool Cycle::is_worthwhile(const Vec3& motion, const Vec3& best) const noexcept {
  const Vec3& aim = around_.aim;
  return (aim - motion).norm() < (aim - best).norm() - 1e-6 * aim.norm();
}

void Cycle::ended(std::int64_t StageTimes::*stage) noexcept {
  if (times_ == nullptr) return;
  const auto now = std::chrono::steady_clock::now();
  times_->*stage += std::chrono::duration_cast<std::chrono::nanoseconds>(now - last_).count();
  last_ = now;
}

std::optional<Vec3> tip_motion(const StepProblem& problem, const Solution& solution,
                               double rounding) noexcept {
  // Of the sum below, relative to the way: each of its products and sums rounds by half of that.
  const double digits = std::numeric_limits<double>::epsilon() *
                        (1.0 + 0.5 * static_cast<double>(problem.jacobian.cols()));
  if (moves_a_point(problem)) {
    const double* u = solution.u.data();
    const double way = std::abs(u[0]) + std::abs(u[1]) + std::abs(u[2]);
    if (!(digits * way <= rounding)) return std::nullopt;
    return std::optional<Vec3>(std::in_place, Eigen::Map<const Vec3>(u));
  }
  Vec3 motion = Vec3::Zero();
  double way = 0.0;  // of the tip, were all joints to move it alike
  for (Eigen::Index c = 0; c < problem.jacobian.cols(); ++c) {
    const double u = solution.u[static_cast<std::size_t>(c)];
    motion += problem.jacobian.col(c) * u;
    way += problem.jacobian.col(c).norm() * std::abs(u);
  }
  if (!(digits * way <= rounding)) return std::nullopt;
  return motion;
}

}  // namespace keepout
