// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/judges/robot_judge.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

namespace keepout::oracle {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr int parts_of_a_cycle = 8;
constexpr int refinements = 12;              // around the worst pose
constexpr double angular_tolerance = 1e-12;  // [chord]

/// Returns true if all joints may move to `to`, up to rounding. A joint outside its limits may stay
/// or return.
bool are_allowed(const Chain& chain, std::span<const double> from, std::span<const double> to,
                 double period) {
  for (std::size_t k = 0; k < from.size(); ++k) {
    const JointLimits& limits = chain.joint(static_cast<int>(k) + 1).limits;
    const double rounding = 1e-14 * (std::abs(from[k]) + std::abs(to[k]));
    const double longest = std::min(limits.increment, limits.velocity * period);
    const bool is_allowed = to[k] >= std::min(limits.lower, from[k]) - rounding &&
                            to[k] <= std::max(limits.upper, from[k]) + rounding &&
                            std::abs(to[k] - from[k]) <= longest + rounding;
    if (!is_allowed) return false;
  }
  return true;
}

/// Returns the certified clearance of a pair or a guide with target clearance `target`, at
/// `distance`, that was promised `floor` last. Source: docs/joint-space-step.md, "Certified
/// clearance".
double certified(double distance, double floor, double target, double band, double tolerance) {
  if (distance >= target - 2.75 * tolerance) return target;
  const double room = distance > 0.0 ? std::min(band, 0.5 * distance) : band;
  return std::clamp(distance - room, std::min(floor, target), target);
}

/// Returns the clearance fraction that a step promises to a body and a mesh.
double promised_fraction(const InstrumentStep& step, std::size_t body, std::size_t mesh) {
  if (!step.ok()) return step.clearance_fraction;
  for (const DegradedClearance& pair : step.degraded) {
    const bool is_it = pair.body == static_cast<int>(body) && pair.mesh == static_cast<int>(mesh);
    if (is_it) return pair.fraction;
  }
  return 1.0;
}

std::vector<std::shared_ptr<const TriangleTree>> trees_of(const JudgedScene& scene) {
  std::vector<std::shared_ptr<const TriangleTree>> trees;
  for (const JudgedScene::Mesh& mesh : scene.meshes) trees.push_back(mesh.tree);
  return trees;
}

}  // namespace

RobotJudge::RobotJudge(JudgedScene scene, const Chain& limits, std::span<const double> positions,
                       const InstrumentOptions& options, double tolerance)
    : bodies_(scene.robot.bodies.size()),
      base_(scene.base),
      guides_(std::move(scene.guides)),
      check_(trees_of(scene), scene.robot, scene.base),
      limits_(&limits),
      positions_(positions.begin(), positions.end()),
      between_(positions_),
      tolerance_(tolerance),
      has_band_(scene.has_band),
      least_(bodies_) {
  for (JudgedScene::Mesh& mesh : scene.meshes) {
    meshes_.push_back({InstrumentOracle(std::move(mesh.tree), scene.robot, base_), mesh.margin});
    motions_.push_back({mesh.pose});
  }
  kept_.resize(meshes_.size() * bodies_ + guides_.size());
  distances_.resize(kept_.size());
  levels_.resize(meshes_.size() * bodies_);
  due_.resize(meshes_.size() * bodies_);
  follow(options);
}

double RobotJudge::margin(std::size_t mesh) const noexcept {
  return meshes_[mesh].margin > 0.0 ? meshes_[mesh].margin : options_.margin;
}

double RobotJudge::tolerance(std::size_t kept) const noexcept {
  const std::size_t pairs = meshes_.size() * bodies_;
  const bool is_angular = kept >= pairs && guides_[kept - pairs].kind == JudgedGuide::Kind::axis;
  return is_angular ? angular_tolerance : tolerance_;
}

void RobotJudge::follow(const InstrumentOptions& options) {
  options_ = options;
  if (!has_band_) options_.band = 0.0;
  measure(positions_, 0.0);
  for (std::size_t i = 0; i < kept_.size(); ++i) kept_[i].distance = distances_[i];
}

void RobotJudge::place(std::size_t mesh, const Pose& pose, const Twist& velocity) {
  meshes_[mesh].velocity = velocity;
  motions_[mesh].pose = pose;
  is_placed_anew_ = true;
}

Segment RobotJudge::axis(std::size_t body) const {
  const JudgedRobot& robot = meshes_.front().oracle.robot();
  return axis_of(robot.bodies[body], monitor::place(robot, base_, positions_));
}

bool RobotJudge::is_recovered() const noexcept {
  for (std::size_t p = 0; p < meshes_.size() * bodies_; ++p) {
    const double target = margin(p / bodies_) - options_.band;
    if (kept_[p].distance < target - 3.0 * tolerance_) return false;
  }
  return true;
}

/// Measures all distances at a fraction of the motion to `next`.
void RobotJudge::measure(std::span<const double> next, double share) {
  for (std::size_t k = 0; k < positions_.size(); ++k) {
    between_[k] = share == 1.0 ? next[k] : positions_[k] + share * (next[k] - positions_[k]);
  }
  for (std::size_t m = 0; m < meshes_.size(); ++m) {
    const Pose pose = motions_[m].at(share);
    const Mat3 back = pose.rotation.transpose();
    meshes_[m].oracle.move_to(between_,
                              {back * (base_.position - pose.position), back * base_.rotation});
    for (std::size_t b = 0; b < bodies_; ++b) {
      distances_[m * bodies_ + b] = meshes_[m].oracle.clearance(b, margin(m));
    }
  }
  measure_guides(between_);
}

/// Measures the depths of all guides at these positions.
void RobotJudge::measure_guides(std::span<const double> positions) {
  if (guides_.empty()) return;
  const auto links = monitor::place(meshes_[0].oracle.robot(), base_, positions);
  for (std::size_t g = 0; g < guides_.size(); ++g) {
    distances_[meshes_.size() * bodies_ + g] = -excess(guides_[g], links);
  }
}

/// Measures, notes the least distances, and returns the smallest difference of a distance and the
/// due one.
double RobotJudge::measure_and_note(std::span<const double> next, double share) {
  measure(next, share);
  double room = infinity;
  for (std::size_t i = 0; i < kept_.size(); ++i) {
    kept_[i].least = std::min(kept_[i].least, distances_[i]);
    room = std::min(room, distances_[i] - kept_[i].due);
  }
  return room;
}

/// Finds the distances that are certified and promised in this cycle.
void RobotJudge::open() {
  if (is_placed_anew_) follow(options_);
  is_placed_anew_ = false;
  const std::size_t pairs = meshes_.size() * bodies_;
  for (std::size_t m = 0; m < meshes_.size(); ++m) {
    const Twist& velocity = meshes_[m].velocity;
    motions_[m].way = {options_.period * velocity.linear, options_.period * velocity.angular};
  }
  for (std::size_t i = 0; i < kept_.size(); ++i) {
    Kept& kept = kept_[i];
    const bool is_pair = i < pairs;
    const double band = is_pair || !has_band_ ? options_.band : guides_[i - pairs].band;
    const double target = is_pair ? margin(i / bodies_) - options_.band : -guides_[i - pairs].band;
    const double floor = certified(kept.distance, kept.floor, target, band, tolerance(i));
    const double level = is_pair ? levels_[i] : 1.0;
    kept.due = level > 0.0 ? floor - (1.0 - level) * std::max(floor, 0.0) : -infinity;
    kept.floor = kept.due;
    kept.least = kept.distance;
  }
}

RobotVerdict RobotJudge::judge(std::span<const double> next) {
  std::ranges::fill(levels_, 1.0);
  return judge_promised(next);
}

RobotVerdict RobotJudge::judge(std::span<const double> next, const InstrumentStep& step,
                               std::optional<std::size_t> must_keep) {
  for (std::size_t p = 0; p < levels_.size(); ++p) {
    levels_[p] = must_keep == p % bodies_ ? 1.0 : promised_fraction(step, p % bodies_, p / bodies_);
  }
  return judge_promised(next);
}

/// Proves that all distances are the due ones less three tolerances on the whole motion.
MotionFinding RobotJudge::prove(std::span<const double> next) {
  const InstrumentMotion motion{positions_, next, motions_};
  const std::size_t pairs = due_.size();
  for (std::size_t i = 0; i < pairs; ++i) due_[i] = kept_[i].due - 3.0 * tolerance_;
  MotionFinding finding = check_.check(motion, due_);
  for (std::size_t i = pairs; i < kept_.size() && finding.clearance != Clearance::lost; ++i) {
    const double most = 3.0 * tolerance(i) - kept_[i].due;
    MotionFinding of_guide =
        check_guide(guides_[i - pairs], meshes_[0].oracle.robot(), base_, motion, most);
    of_guide.pair = i;
    if (of_guide.clearance != Clearance::kept) finding = of_guide;
  }
  return finding;
}

/// Measures at poses of the motion, most of them around the worst one, to find how near a body
/// comes or how far a guide is left. `at`: the fraction of the motion at which it was found.
void RobotJudge::sample(std::span<const double> next, double at) {
  double worst = measure_and_note(next, at);
  const auto try_at = [&](double share) {
    const double room = measure_and_note(next, share);
    if (room < worst) at = share;
    worst = std::min(worst, room);
  };
  for (int i = 0; i < parts_of_a_cycle; ++i) try_at((i + 0.5) / parts_of_a_cycle);
  double step = 0.5 / parts_of_a_cycle;
  for (int i = 0; i < refinements; ++i, step *= 0.5) {
    const double middle = at;
    try_at(std::max(middle - step, 0.0));
    try_at(std::min(middle + step, 1.0));
  }
}

/// Moves the instrument and the meshes to the end of the motion.
void RobotJudge::advance(std::span<const double> next) {
  bool is_measured = check_.poses() > 0;  // the motion is finite
  for (std::size_t i = 0; i < due_.size() && is_measured; ++i) {
    const double radius = meshes_[0].oracle.robot().bodies[i % bodies_].radius;
    const double reach = radius + margin(i / bodies_);
    const std::optional<Bracket> distance = check_.core_distance(MotionCheck::End::end, i, reach);
    is_measured = distance && (distance->low == infinity || distance->narrow());
    if (is_measured) {
      distances_[i] = distance->estimate <= reach ? distance->estimate - radius : infinity;
    }
  }
  if (is_measured) {
    measure_guides(next);
  } else {
    measure(next, 1.0);  // in exact arithmetic where it must be
  }
  for (std::size_t i = 0; i < kept_.size(); ++i) {
    kept_[i].distance = distances_[i];  // at the start of the next cycle
    kept_[i].least = std::min(kept_[i].least, distances_[i]);
  }
  std::ranges::copy(next, positions_.begin());
  for (MeshMotion& mesh : motions_) mesh.pose = mesh.at(1.0);
}

RobotVerdict RobotJudge::judge_promised(std::span<const double> next) {
  RobotVerdict verdict{.limits_broken = !are_allowed(*limits_, positions_, next, options_.period)};
  open();
  const bool is_still = std::ranges::equal(next, positions_) &&
                        std::ranges::all_of(motions_, [](const MeshMotion& mesh) {
                          return mesh.way.linear.isZero(0.0) && mesh.way.angular.isZero(0.0);
                        });
  MotionFinding finding;
  if (!is_still) {
    finding = prove(next);
    if (finding.clearance != Clearance::kept) sample(next, finding.at);
    advance(next);
  }
  std::ranges::fill(least_, infinity);
  for (std::size_t i = 0; i < kept_.size(); ++i) {
    const double room = kept_[i].least - kept_[i].due;
    if (i < meshes_.size() * bodies_) {
      least_[i % bodies_] = std::min(least_[i % bodies_], kept_[i].least);
      verdict.least = std::min(verdict.least, kept_[i].least);
      verdict.beyond = std::min(verdict.beyond, room);
    } else {
      verdict.guide_room = std::min(verdict.guide_room, room / tolerance(i));
    }
  }
  const bool is_lost = finding.clearance == Clearance::lost;
  const bool is_of_pair = finding.pair < due_.size();
  verdict.is_below = (is_lost && is_of_pair) || !(verdict.beyond >= -3.0 * tolerance_);
  verdict.is_guide_left = (is_lost && !is_of_pair) || !(verdict.guide_room >= -3.0);
  verdict.is_undecided =
      finding.clearance == Clearance::undecided && !verdict.is_below && !verdict.is_guide_left;
  return verdict;
}

bool RobotJudge::would_allow(std::span<const double> next) {
  constexpr int poses = 9;
  const std::size_t pairs = meshes_.size() * bodies_;
  if (!are_allowed(*limits_, positions_, next, options_.period)) return false;
  for (int i = poses - 1; i > 0; --i) {  // the end is most likely to be too close
    measure(next, static_cast<double>(i) / (poses - 1));
    for (std::size_t k = 0; k < kept_.size(); ++k) {
      const double wanted =
          k < pairs ? margin(k / bodies_) - 0.1 * options_.band : -0.1 * guides_[k - pairs].band;
      if (distances_[k] < std::min(wanted, kept_[k].distance)) return false;
    }
  }
  return true;
}

}  // namespace keepout::oracle
