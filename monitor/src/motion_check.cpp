// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/monitor/motion_check.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

namespace keepout::monitor {
namespace {

// The number of triangles to fetch at once, in multiples of those that are in reach. More would
// take long, fewer would soon be too few.
constexpr std::size_t few = 2;
constexpr std::size_t many = 4;
constexpr std::size_t usual = 32;  // in reach, at least
constexpr double least_slack = 1.0 / 64.0;
constexpr double largest_slack = 16.0;

// Work units.
constexpr std::uint64_t of_a_pose = 20;
constexpr std::uint64_t of_a_gap = 2;

/// Returns a bound of the rounding error of a height or distance between a core and a point.
/// [length]
double rounding_of(const Hull& core, const Vec3& point) noexcept {
  return 0x1p-46 * ((core.center() - point).lpNorm<1>() + core.radius());
}

/// Returns the largest displacement of all points of a core, which is that of a corner. [length]
double moved(std::span<const Vec3> from, std::span<const Vec3> to) noexcept {
  double most = 0.0;
  for (std::size_t i = 0; i < from.size(); ++i) most = std::max(most, (to[i] - from[i]).norm());
  return most;
}

/// Returns the distance of a core and a triangle along a direction; NaN if it is 0. [length]
double least_height(const Hull& core, const Triangle& triangle, const Vec3& direction) noexcept {
  double least = std::numeric_limits<double>::infinity();
  for (const Vec3& point : core.points()) {
    least = std::min(least, direction.dot(point - triangle[0]));
  }
  const double top = std::max(
      {0.0, direction.dot(triangle[1] - triangle[0]), direction.dot(triangle[2] - triangle[0])});
  return (least - top) / direction.norm();
}

bool is_finite(const InstrumentMotion& motion) noexcept {
  const auto finite = [](double value) { return std::isfinite(value); };
  return std::ranges::all_of(motion.from, finite) && std::ranges::all_of(motion.to, finite) &&
         std::ranges::all_of(motion.meshes, [](const MeshMotion& mesh) {
           return mesh.pose.position.allFinite() && mesh.pose.rotation.allFinite() &&
                  mesh.way.linear.allFinite() && mesh.way.angular.allFinite();
         });
}

}  // namespace

Pose MeshMotion::at(double s) const noexcept {
  Pose moved = pose;
  moved.position += s * way.linear;
  const double turn = s * way.angular.norm();
  if (turn > 0.0) {
    moved.rotation =
        (Eigen::AngleAxisd(turn, way.angular.normalized()) * Eigen::Quaterniond(pose.rotation))
            .normalized()
            .toRotationMatrix();
  }
  return moved;
}

MotionCheck::MotionCheck(std::span<const std::shared_ptr<const TriangleTree>> trees,
                         const JudgedRobot& robot, const Pose& base, std::uint64_t most_triangles)
    : trees_(trees.begin(), trees.end()),
      robot_(robot),
      base_(base),
      surroundings_(trees.size() * robot.bodies.size()),
      slots_(2 + of_a_level * levels),
      positions_(robot.table.size()),
      most_triangles_(most_triangles) {
  PoseAt slot;
  for (const JudgedBody& body : robot_.bodies) {
    first_point_.push_back(slot.points.size());
    for (const JudgedPoint& point : body.points) slot.points.push_back(point.position);
  }
  first_point_.push_back(slot.points.size());
  slot.links.resize(robot_.table.size() + 1);
  slot.joints.resize(robot_.table.size() + 2);
  slot.joints[1].slides = true;
  for (std::size_t k = 0; k < robot_.table.size(); ++k) {
    slot.joints[k + 2].slides = robot_.table[k].slides;
  }
  for (std::size_t i = 0; i < surroundings_.size(); ++i) {
    const std::size_t body = i % robot_.bodies.size();
    const auto first = slot.points.begin() + static_cast<std::ptrdiff_t>(first_point_[body]);
    const auto last = slot.points.begin() + static_cast<std::ptrdiff_t>(first_point_[body + 1]);
    surroundings_[i].points.assign(first, last);
    slot.cores.emplace_back(surroundings_[i].points);
  }
  for (PoseAt& each : slots_) each = slot;
  bends_.resize(slot.points.size());
  end_.reserve(positions_.size());
  if (most_triangles == unlimited) return;
  const auto most = static_cast<std::size_t>(most_triangles);
  found_.reserve(most);
  for (Surroundings& around : surroundings_) around.neighbors.reserve(most);
}

bool MotionCheck::spend(std::uint64_t units) noexcept {
  const bool has_them = units <= work_;
  work_ -= has_them ? units : work_;
  return has_them;
}

const Hull& MotionCheck::core(std::size_t slot, const Pair& pair) const noexcept {
  return slots_[slot].cores[pair.number];
}

/// Places the links of a slot and the points of the bodies in the world.
void MotionCheck::place_links(PoseAt& slot, double s) {
  ++poses_;
  for (std::size_t k = 0; k < positions_.size(); ++k) {
    const double from = motion_.from[k];
    positions_[k] = s == 1.0 ? motion_.to[k] : from + s * (motion_.to[k] - from);
  }
  place(robot_, base_, positions_, slot.links);
  for (std::size_t b = 0; b < robot_.bodies.size(); ++b) {
    for (std::size_t i = 0; i < robot_.bodies[b].points.size(); ++i) {
      const JudgedPoint& point = robot_.bodies[b].points[i];
      slot.points[first_point_[b] + i] =
          slot.links[static_cast<std::size_t>(point.link)].at(point.position);
    }
  }
}

/// Places the cores of a slot in the frames of the meshes.
void MotionCheck::place_cores(PoseAt& slot, double s) {
  slot.s = s;
  for (std::size_t m = 0; m < trees_.size(); ++m) {
    const Pose pose = motion_.meshes[m].at(s);
    const Mat3 back = pose.rotation.transpose();
    for (std::size_t b = 0; b < robot_.bodies.size(); ++b) {
      std::array<Vec3, Hull::most_points> points;
      const std::size_t count = robot_.bodies[b].points.size();
      for (std::size_t i = 0; i < count; ++i) {
        points[i] = back * (slot.points[first_point_[b] + i] - pose.position);
      }
      slot.cores[m * robot_.bodies.size() + b].move_to({points.data(), count});
    }
  }
}

/// Returns the slot of the instrument at the middle of a part. No part inside uses this slot.
std::size_t MotionCheck::middle_of(const Part& part, int level) {
  const double s = 0.5 * (part.from + part.to);
  const auto number = static_cast<std::size_t>(std::ldexp(s, level));
  const std::size_t slot = 2 + static_cast<std::size_t>(of_a_level * level) + number % of_a_level;
  if (slots_[slot].s != s && spend(of_a_pose)) {
    place_links(slots_[slot], s);
    place_cores(slots_[slot], s);
  }
  return slot;
}

/// Writes the axes of the robot's joints at both ends, in the world.
void MotionCheck::place_joints() {
  for (const std::size_t end : {at_start, at_end}) {
    for (std::size_t k = 0; k < robot_.table.size(); ++k) {
      slots_[end].joints[k + 2] =
          joint_line(robot_.table[k], slots_[end].links[k + 1], motion_.to[k] - motion_.from[k]);
    }
  }
}

/// Writes the motion of a mesh as two joints before those of the robot: the mesh turns, and the
/// robot slides over it.
void MotionCheck::place_mesh(const MeshMotion& mesh) {
  const double turn = mesh.way.angular.norm();
  for (const std::size_t end : {at_start, at_end}) {
    std::vector<JointLine>& joints = slots_[end].joints;
    joints[0].change = turn;
    joints[0].origin = mesh.pose.position;
    if (end == at_end) joints[0].origin += mesh.way.linear;
    if (turn > 0.0) joints[0].axis = mesh.way.angular / turn;
    joints[1].change = mesh.way.linear.norm();
  }
}

/// Writes the bounds M of the points of a body, and returns the largest P.
double MotionCheck::bound_motion(std::size_t b) {
  double speed = 0.0;
  for (std::size_t i = first_point_[b]; i < first_point_[b + 1]; ++i) {
    const auto link = static_cast<std::size_t>(robot_.bodies[b].points[i - first_point_[b]].link);
    const Travel of_point = travel(std::span(slots_[at_start].joints).first(2 + link),
                                   std::span(slots_[at_end].joints).first(2 + link),
                                   slots_[at_start].points[i], slots_[at_end].points[i]);
    speed = std::max(speed, of_point.speed);
    bends_[i] = of_point.bend;
  }
  return speed;
}

/// Fetches all triangles within `reach` of a core, and perhaps some more, unless they are there.
/// Returns false if the work ended.
bool MotionCheck::surround(Surroundings& around, const Hull& core, double reach) {
  around.shift = moved(around.points, core.points());
  if (reach + around.shift < around.known) return true;
  around.shift = 0.0;
  around.points.assign(core.points().begin(), core.points().end());
  around.neighbors.clear();
  const bool is_segment = core.points().size() < 3;
  const Segment middle = is_segment ? Segment{core.points().front(), core.points().back()}
                                    : Segment{core.center(), core.center()};
  const auto mesh = static_cast<std::size_t>(&around - surroundings_.data()) / robot_.bodies.size();
  const TriangleTree& tree = *trees_[mesh];
  const auto find = [&](double slack) {
    around.known = reach + slack;
    found_.clear();
    return tree.collect_within(around.known + (is_segment ? 0.0 : core.radius()), middle, found_,
                               {most_triangles_, &work_});
  };
  const bool is_found = find(around.slack) || find(0.0);
  if (!is_found || !spend(2 * found_.size())) {
    around.known = -1.0;
    return false;
  }
  for (const TriangleId t : found_) {
    const Triangle triangle = tree.mesh().triangle(t);
    const Bounds bounds = bounds_of(triangle);
    const Vec3 center = 0.5 * bounds.low + 0.5 * bounds.high;
    const double radius = std::max({(triangle[0] - center).norm(), (triangle[1] - center).norm(),
                                    (triangle[2] - center).norm()}) +
                          2.0 * rounding_of(core, center);
    const double low = core.least_distance(center) - radius;
    if (low <= around.known) around.neighbors.push_back({triangle, center, radius, low});
  }
  std::sort(around.neighbors.begin(), around.neighbors.end(),
            [](const Neighbor& one, const Neighbor& other) { return one.low < other.low; });
  const std::size_t count = around.neighbors.size();
  const auto in_reach = std::upper_bound(
      around.neighbors.begin(), around.neighbors.end(), reach,
      [](double distance, const Neighbor& neighbor) { return distance < neighbor.low; });
  const auto needed =
      std::max<std::size_t>(usual, static_cast<std::size_t>(in_reach - around.neighbors.begin()));
  if (count > many * needed) around.slack = std::max(least_slack, 0.5 * around.slack);
  if (count < few * needed) around.slack = std::min(largest_slack, 2.0 * around.slack);
  return true;
}

/// Returns true if a direction proves the due distance in a part of the motion.
bool MotionCheck::separates(const Pair& pair, const Triangle& triangle, const Part& part,
                            const Vec3& direction) {
  const double squared = direction.squaredNorm();
  if (!(squared > 1e-200 && squared < 1e200)) return false;
  const Vec3 unit = direction / std::sqrt(squared);
  const double top =
      std::max({0.0, unit.dot(triangle[1] - triangle[0]), unit.dot(triangle[2] - triangle[0])}) +
      pair.due + pair.rounding;
  const std::span<const Vec3> first = core(part.first, pair).points();
  const std::span<const Vec3> last = core(part.last, pair).points();
  const double squared_width = (part.to - part.from) * (part.to - part.from);
  for (std::size_t i = 0; i < first.size(); ++i) {
    const double least =
        least_between(unit.dot(first[i] - triangle[0]), unit.dot(last[i] - triangle[0]),
                      pair.bends[i] * squared_width);
    if (!(least >= top)) return false;
  }
  surroundings_[pair.number].direction = unit;
  return true;
}

Clearance MotionCheck::check_triangle(const Pair& pair, const Triangle& triangle, const Part& part,
                                      const Gap& first, const Gap& last, int level) {
  const double least = first.distance.low + last.distance.low - pair.speed * (part.to - part.from);
  if (least >= 2.0 * (pair.due + pair.rounding)) return Clearance::kept;
  const Vec3 mean = first.direction.normalized() + last.direction.normalized();
  for (const Vec3& direction : {last.direction, first.direction, mean}) {
    if (separates(pair, triangle, part, direction)) return Clearance::kept;
  }
  if (level == levels) return Clearance::undecided;
  const std::size_t slot = middle_of(part, level);
  if (!spend(of_a_gap)) return Clearance::undecided;
  const double middle = slots_[slot].s;
  const Gap gap = core(slot, pair).gap(triangle);
  if (gap.distance.high < pair.due) {
    lost_at_ = middle;
    return Clearance::lost;
  }
  if (separates(pair, triangle, part, gap.direction)) return Clearance::kept;
  const Clearance before =
      check_triangle(pair, triangle, {part.from, middle, part.first, slot}, first, gap, level + 1);
  if (before != Clearance::kept) return before;
  return check_triangle(pair, triangle, {middle, part.to, slot, part.last}, gap, last, level + 1);
}

Clearance MotionCheck::check_pair(std::size_t number, double due) {
  if (due == -std::numeric_limits<double>::infinity()) return Clearance::kept;
  const std::size_t b = number % robot_.bodies.size();
  const double speed = bound_motion(b);
  Pair pair{number, due + robot_.bodies[b].radius, speed, 0.0,
            std::span(bends_).subspan(first_point_[b], first_point_[b + 1] - first_point_[b])};
  if (pair.due <= 0.0) return Clearance::kept;
  if (!std::isfinite(pair.due)) return Clearance::undecided;
  const Part whole{0.0, 1.0, at_start, at_end};
  // The middle is nearer to all of a long motion, so that fewer triangles are in reach.
  const bool is_long = speed > 0.5 * pair.due;
  const std::size_t center = is_long ? middle_of(whole, 0) : at_end;
  if (work_ == 0) return Clearance::undecided;
  const double reach = pair.due + (is_long ? 0.5 : 1.0) * speed;
  Surroundings& around = surroundings_[number];
  if (!surround(around, core(center, pair), reach)) return Clearance::undecided;
  const auto low_at = [&](std::size_t slot, const Neighbor& neighbor) {
    return core(slot, pair).least_distance(neighbor.center) - neighbor.radius;
  };
  for (const Neighbor& neighbor : around.neighbors) {
    if (neighbor.low - around.shift > reach) break;
    if (!spend(1)) return Clearance::undecided;
    if (low_at(center, neighbor) > reach) continue;
    if (low_at(at_start, neighbor) + low_at(at_end, neighbor) - speed >= 2.0 * pair.due) continue;
    const Triangle& triangle = neighbor.triangle;
    pair.rounding = rounding_of(core(at_end, pair), neighbor.center) + 0x1p-46 * speed;
    if (separates(pair, triangle, whole, around.direction) ||
        separates(pair, triangle, whole, core(center, pair).way_from(neighbor.center))) {
      continue;
    }
    if (!spend(2 * of_a_gap)) return Clearance::undecided;
    const Gap first = core(at_start, pair).gap(triangle);
    const Gap last = core(at_end, pair).gap(triangle);
    const bool is_lost = last.distance.high < pair.due;
    if (is_lost || first.distance.high < pair.due) {
      lost_at_ = is_lost ? 1.0 : 0.0;
      return Clearance::lost;
    }
    const Clearance clearance = check_triangle(pair, triangle, whole, first, last, 0);
    if (clearance != Clearance::kept) return clearance;
  }
  return Clearance::kept;
}

std::optional<Bracket> MotionCheck::core_distance(End end, std::size_t pair, double reach) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const Hull& core = slots_[end == End::start ? at_start : at_end].cores[pair];
  Surroundings& around = surroundings_[pair];
  if (!surround(around, core, reach)) return std::nullopt;
  Bracket nearest{infinity, infinity, infinity};
  Vec3 direction = around.direction;
  const auto measure = [&](const Neighbor& neighbor) {
    const double enough = std::min(reach, nearest.high) + rounding_of(core, neighbor.center);
    if (core.least_distance(neighbor.center) - neighbor.radius > enough ||
        least_height(core, neighbor.triangle, direction) > enough ||
        least_height(core, neighbor.triangle, core.way_from(neighbor.center)) > enough) {
      return;
    }
    const Gap gap = core.gap(neighbor.triangle);
    const bool is_nearer = gap.distance.estimate < nearest.estimate;
    nearest = {std::min(nearest.low, gap.distance.low),
               std::min(nearest.estimate, gap.distance.estimate),
               std::min(nearest.high, gap.distance.high)};
    if (!is_nearer) return;
    around.nearest = static_cast<std::size_t>(&neighbor - around.neighbors.data());
    direction = gap.direction;
  };
  if (around.nearest < around.neighbors.size()) measure(around.neighbors[around.nearest]);
  for (const Neighbor& neighbor : around.neighbors) {
    if (neighbor.low - around.shift > std::min(reach, nearest.high)) break;
    if (!spend(of_a_gap)) return std::nullopt;
    measure(neighbor);
  }
  if (nearest.low > reach) return Bracket{infinity, infinity, infinity};
  return nearest;
}

MotionFinding MotionCheck::check(const InstrumentMotion& motion, std::span<const double> due,
                                 std::uint64_t work) {
  MotionFinding finding;
  poses_ = 0;
  if (!is_finite(motion)) return {Clearance::undecided};
  motion_ = motion;
  work_ = work;
  for (PoseAt& slot : slots_) slot.s = -1.0;
  if (!spend(2 * of_a_pose)) return {Clearance::undecided};
  if (std::ranges::equal(motion.from, end_)) {
    std::swap(slots_[at_start], slots_[at_end]);
  } else {
    place_links(slots_[at_start], 0.0);
  }
  place_links(slots_[at_end], 1.0);
  end_.assign(motion.to.begin(), motion.to.end());
  place_cores(slots_[at_start], 0.0);
  place_cores(slots_[at_end], 1.0);
  place_joints();
  const std::size_t bodies = robot_.bodies.size();
  for (std::size_t i = 0; i < surroundings_.size(); ++i) {
    if (i % bodies == 0) place_mesh(motion_.meshes[i / bodies]);
    const Clearance clearance = check_pair(i, due[i]);
    if (clearance != Clearance::kept) finding = {clearance, i, lost_at_};
    if (clearance == Clearance::lost) break;
  }
  return finding;
}

}  // namespace keepout::monitor
