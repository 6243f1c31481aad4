// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/oracle/best_step.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <queue>
#include <vector>

namespace keepout::oracle {
namespace {

// In this file, lengths are in units of |desired| and positions are relative to the tip. So the
// desired motion is a unit vector, and a motion is the segment from the origin to its end.

constexpr double proven_gap = 1e-4;        // between the cost and its bound: the search stops there
constexpr std::size_t most_cells = 20000;  // of the branch and bound
constexpr std::size_t first_cells = 64;
constexpr std::size_t first_descents = 4;
constexpr double parallel =
    1e-9;  // planes with a smaller sine between their normals do not intersect

struct ClosestPoint {
  Vec3 offset;  // from the given point
  double distance;
};

/// Returns the point of a triangle that is nearest to a point: the foot of the perpendicular if
/// that is within the triangle, otherwise a point on a side. The triangle may be a segment or a
/// point.
ClosestPoint closest_point(const Triangle& t, const Vec3& point) {
  Vec3 best = t[0] - point;
  for (int i = 0; i < 3; ++i) {
    const Vec3 side = t[(i + 1) % 3] - t[i];
    const double length2 = side.squaredNorm();
    const double share =
        length2 > 0.0 ? std::clamp((point - t[i]).dot(side) / length2, 0.0, 1.0) : 0.0;
    const Vec3 offset = t[i] + share * side - point;
    if (offset.squaredNorm() < best.squaredNorm()) best = offset;
  }
  const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]).stableNormalized();
  const auto is_within = [&](int i) {
    return normal.cross(t[(i + 1) % 3] - t[i]).dot(point - t[i]) >= 0.0;
  };
  if (normal.squaredNorm() > 0.5 && is_within(0) && is_within(1) && is_within(2)) {
    const Vec3 offset = (t[0] - point).dot(normal) * normal;
    if (offset.squaredNorm() < best.squaredNorm()) best = offset;
  }
  return {best, best.norm()};
}

/// A triangle that limits motions. It excludes the motions in a convex set, its shadow.
struct Obstacle {
  Triangle triangle;
  double margin;
  Vec3 center;   // of a sphere around the triangle
  double reach;  // that sphere's radius plus the margin
  Vec3 normal;   // from the triangle to the tip
  double room;   // distance from the tip minus the margin
};

struct Contact {
  double length;             // of the motion to the contact
  const Obstacle* obstacle;  // null: the motion is free
};

/// {z : normal . z >= offset}.
struct Plane {
  Vec3 normal;
  double offset;
};

double distance_to_segment(const Vec3& point, const Vec3& end) {
  const double length2 = end.squaredNorm();
  if (length2 == 0.0) return point.norm();
  return (point - std::clamp(point.dot(end) / length2, 0.0, 1.0) * end).norm();
}

/// Returns the shortest vector from the segment [a, b] to the segment [0, end]. Either may be a
/// point.
Vec3 between_segments(const Vec3& a, const Vec3& b, const Vec3& end) {
  const Vec3 along = b - a;
  const double aa = along.squaredNorm(), ee = end.squaredNorm(), ae = along.dot(end);
  const auto on_end = [&](double r) {
    return ee > 0.0 ? std::clamp((a + r * along).dot(end) / ee, 0.0, 1.0) : 0.0;
  };
  const double determinant = aa * ee - ae * ae;
  double r = 0.0;
  if (determinant > 0.0) {
    r = std::clamp((ae * a.dot(end) - ee * a.dot(along)) / determinant, 0.0, 1.0);
  }
  const double s = on_end(r);
  if (aa > 0.0) r = std::clamp((s * end - a).dot(along) / aa, 0.0, 1.0);
  return on_end(r) * end - (a + r * along);
}

/// Returns the shortest vector from a triangle to the segment [0, end], which does not cross it.
/// The vector ends at an end of the segment, or starts on a side of the triangle.
Vec3 way_to_segment(const Triangle& t, const Vec3& end) {
  Vec3 best = -closest_point(t, Vec3::Zero()).offset;
  const auto consider = [&](const Vec3& way) {
    if (way.squaredNorm() < best.squaredNorm()) best = way;
  };
  consider(-closest_point(t, end).offset);
  for (int i = 0; i < 3; ++i) consider(between_segments(t[i], t[(i + 1) % 3], end));
  return best;
}

/// Returns true if the segment [0, end] passes through the interior of the triangle. Near its sides
/// rounding decides, but there the distance from them is small.
bool crosses(const Triangle& t, const Vec3& end) {
  const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]);
  if (normal.dot(t[0]) * normal.dot(t[0] - end) > 0.0) return false;
  const double a = end.dot(t[0].cross(t[1]));
  const double b = end.dot(t[1].cross(t[2]));
  const double c = end.dot(t[2].cross(t[0]));
  return (a >= 0.0 && b >= 0.0 && c >= 0.0) || (a <= 0.0 && b <= 0.0 && c <= 0.0);
}

/// The projection of `target` on the intersection of half-spaces; empty if rounding makes the
/// intersection empty. Incremental: if the projection on the earlier planes violates a plane, that
/// plane is active, and the problem loses one dimension (Seidel, "Small-dimensional linear
/// programming", 1991).
class Projection {
 public:
  explicit Projection(const Vec3& target) : target_(target) {}

  std::optional<Vec3> operator()(std::span<const Plane> planes) const {
    Vec3 z = target_;
    for (std::size_t i = 0; i < planes.size(); ++i) {
      if (allows(planes[i], z)) continue;
      const std::optional<Vec3> on = on_plane(planes[i], planes.first(i));
      if (!on) return std::nullopt;
      z = *on;
    }
    return z;
  }

 private:
  static bool allows(const Plane& p, const Vec3& z) { return p.normal.dot(z) >= p.offset - 1e-14; }

  std::optional<Vec3> on_plane(const Plane& p, std::span<const Plane> planes) const {
    const Vec3 foot = target_ + (p.offset - p.normal.dot(target_)) * p.normal;
    Vec3 z = foot;
    for (std::size_t i = 0; i < planes.size(); ++i) {
      if (allows(planes[i], z)) continue;
      // The normal of the other plane within this plane, and the distance along it.
      const Vec3 within = planes[i].normal - planes[i].normal.dot(p.normal) * p.normal;
      const double sine = within.norm();
      if (sine < parallel) continue;
      const Vec3 across = within / sine;
      const Vec3 on_line = foot + (planes[i].offset - planes[i].normal.dot(foot)) / sine * across;
      const std::optional<Vec3> on = on_line_of(on_line, p.normal.cross(across), planes.first(i));
      if (!on) return std::nullopt;
      z = *on;
    }
    return z;
  }

  /// `foot`: the target's projection on the line.
  static std::optional<Vec3> on_line_of(const Vec3& foot, const Vec3& along,
                                        std::span<const Plane> planes) {
    double low = -std::numeric_limits<double>::infinity(), high = -low;
    for (const Plane& p : planes) {
      const double slope = p.normal.dot(along);
      const double at = p.offset - p.normal.dot(foot);
      if (slope > parallel) low = std::max(low, at / slope);
      if (slope < -parallel) high = std::min(high, at / slope);
    }
    if (low > high + 1e-9) return std::nullopt;
    return foot + std::clamp(0.0, std::min(low, high), high) * along;
  }

  Vec3 target_;
};

/// A cone of directions: those between three directions. `bound` bounds the costs of their motions.
struct Cell {
  std::array<Vec3, 3> corner;  // unit
  double bound;

  bool operator<(const Cell& other) const {
    return bound > other.bound;
  }  // the least bound is on top
};

std::array<Cell, 2> halves(const Cell& cell) {
  int longest = 0;
  double cosine = 1.0;
  for (int i = 0; i < 3; ++i) {
    const double c = cell.corner[i].dot(cell.corner[(i + 1) % 3]);
    if (c < cosine) longest = i;
    cosine = std::min(cosine, c);
  }
  const int other = (longest + 1) % 3;
  const Vec3 middle = (cell.corner[longest] + cell.corner[other]).normalized();
  std::array<Cell, 2> out{cell, cell};
  out[0].corner[longest] = out[1].corner[other] = middle;
  return out;
}

/// Returns the distance from a point to the tetrahedron of the origin and three points.
double distance_to_tetrahedron(const Triangle& t, const Vec3& point) {
  const double volume = t[0].dot(t[1].cross(t[2]));
  bool inside = volume != 0.0;
  double sum = 0.0;
  for (int i = 0; i < 3 && inside; ++i) {
    const double share = point.dot(t[(i + 1) % 3].cross(t[(i + 2) % 3])) / volume;
    inside = share >= 0.0;
    sum += share;
  }
  if (inside && sum <= 1.0) return 0.0;
  double distance = closest_point(t, point).distance;
  for (int i = 0; i < 3; ++i) {
    const Triangle side{Vec3::Zero(), t[i], t[(i + 1) % 3]};
    distance = std::min(distance, closest_point(side, point).distance);
  }
  return distance;
}

class Search {
 public:
  Search(std::vector<Obstacle> obstacles, const Vec3& target)
      : obstacles_(std::move(obstacles)), target_(target), project_(target) {
    double size = 1.0;
    for (const Obstacle& o : obstacles_) size = std::max(size, o.center.norm() + o.reach);
    rounding_ = 1e-13 * size;
  }

  BestStep run() {
    if (safe(target_)) return {target_, 0.0, 0.0};
    improve(Vec3::Zero());
    start();
    std::size_t cells = 0;
    while (!open_.empty() && open_.top().bound < cost_ - proven_gap && cells < most_cells) {
      const Cell cell = open_.top();
      open_.pop();
      for (Cell& half : halves(cell)) {
        const Vec3 end = examine(half);
        ++cells;
        if (half.bound >= cost_ - proven_gap) continue;
        open_.push(half);
        if (cost(end) < cost_ - 1e-6) improve(end);
      }
    }
    // Cells that were dropped or are still open cost no less.
    const double proven = cost_ - proven_gap;
    const double bound = open_.empty() ? proven : std::min(proven, open_.top().bound);
    return {best_, cost_, std::max(0.0, bound)};
  }

 private:
  double cost(const Vec3& z) const { return (z - target_).norm(); }

  /// Makes a first, even partition. Descents begin in its most promising cells.
  void start() {
    const Vec3 side = target_.unitOrthogonal();
    const Vec3 other = target_.cross(side);
    std::vector<Cell> cells{{{target_, side, other}, 0.0},
                            {{target_, other, -side}, 0.0},
                            {{target_, -side, -other}, 0.0},
                            {{target_, -other, side}, 0.0}};
    while (cells.size() < first_cells) {
      std::vector<Cell> finer;
      for (const Cell& cell : cells) {
        for (const Cell& half : halves(cell)) finer.push_back(half);
      }
      cells = std::move(finer);
    }
    std::vector<Vec3> ends;
    for (Cell& cell : cells) {
      ends.push_back(examine(cell));
      open_.push(cell);
    }
    std::sort(ends.begin(), ends.end(),
              [&](const Vec3& a, const Vec3& b) { return cost(a) < cost(b); });
    for (std::size_t i = 0; i < first_descents; ++i) improve(ends[i]);
  }

  /// Raises the bound of a cell to the highest value that it can prove, and returns the best motion
  /// in the direction of its center.
  Vec3 examine(Cell& cell) const {
    const auto& [a, b, c] = cell.corner;
    const Vec3 u = (a + b + c).normalized();
    const double spread = std::max({(a - u).norm(), (b - u).norm(), (c - u).norm()});
    // No motion is longer than `longest`, so each ends before a plane through the corners'
    // directions.
    const double longest = free_length(u, spread, 1.0).length;
    const double far = longest / (b - a).cross(c - a).normalized().dot(a);
    raise(cell, {far * a, far * b, far * c});
    const Contact first = free_length(u, 0.0, std::min(longest, std::max(0.0, u.dot(target_))));
    if (first.obstacle != nullptr) raise_behind(*first.obstacle, cell);
    return first.length * u;
  }

  /// Raises the bound. `reach`: motions in the cell's directions stay in the tetrahedron of these
  /// points and the origin.
  void raise(Cell& cell, const Triangle& reach) const {
    cell.bound = std::max(cell.bound, distance_to_tetrahedron(reach, target_));
  }

  /// Raises the bound if one obstacle blocks the directions of all three corners. It then blocks
  /// the triangle between them, because the set within the margin of a triangle is convex.
  void raise_behind(const Obstacle& o, Cell& cell) const {
    constexpr double never = 8.0;
    Triangle reach;
    for (int i = 0; i < 3; ++i) {
      const double length = contact(o, cell.corner[i], 0.0, never);
      if (length == never) return;
      reach[i] = length * cell.corner[i];
    }
    raise(cell, reach);
  }

  /// Returns the length along u, at most `limit`, at which an obstacle blocks all directions within
  /// `spread` of u. At s u, these are within s * spread.
  Contact free_length(const Vec3& u, double spread, double limit) const {
    Contact first{limit, nullptr};
    for (const Obstacle& o : obstacles_) {
      if (distance_to_segment(o.center, first.length * u) >= o.reach) continue;
      if (o.room + first.length * (o.normal.dot(u) + spread) > 0.0)
        continue;  // in front of the obstacle
      const double length = contact(o, u, spread, first.length);
      if (length < first.length) first = {length, &o};
    }
    return first;
  }

  /// Returns the length along u to the contact with an obstacle, or `limit`. The distance is a
  /// convex function of the length. So Newton's method from the left ends at the contact, or beyond
  /// the minimum if there is no contact.
  double contact(const Obstacle& o, const Vec3& u, double spread, double limit) const {
    double s = 0.0, room = o.room, slope = spread + u.dot(o.normal);
    for (int i = 0; i < 100 && s < limit; ++i) {
      if (slope >= 0.0) return limit;
      if (room <= rounding_) return s;
      s -= room / slope;
      const ClosestPoint near = closest_point(o.triangle, s * u);
      slope = spread - u.dot(near.offset) / near.distance;
      room = near.distance + spread * s - o.margin;
    }
    return std::min(s, limit);
  }

  bool blocks(const Obstacle& o, const Vec3& end) const {
    return distance_to_segment(o.center, end) < o.reach &&
           (way_to_segment(o.triangle, end).norm() < o.margin - 2.0 * rounding_ ||
            crosses(o.triangle, end));
  }

  bool safe(const Vec3& end) const {
    return std::none_of(obstacles_.begin(), obstacles_.end(),
                        [&](const Obstacle& o) { return blocks(o, end); });
  }

  /// Returns the plane across the shortest vector from an obstacle to a safe motion, at the
  /// obstacle's margin.
  static Plane separating(const Obstacle& o, const Vec3& end) {
    const Vec3 normal = way_to_segment(o.triangle, end).normalized();
    double offset = -std::numeric_limits<double>::infinity();
    for (const Vec3& v : o.triangle) offset = std::max(offset, normal.dot(v) + o.margin);
    return {normal, std::min(offset, std::min(0.0, normal.dot(end)))};
  }

  /// Descends from a safe motion to a local optimum, through safe motions. Each is the best on the
  /// free side of planes that separate the last motion from the obstacles. At a fixed point the
  /// active planes touch both the motion and the obstacle's margin: a first-order optimum.
  void improve(Vec3 z) {
    for (int round = 0; round < 100; ++round) {
      const std::optional<Vec3> next = improved(z);
      if (!next || cost(*next) > cost(z) - 1e-11) break;
      z = *next;
    }
    if (cost(z) >= cost_) return;
    cost_ = cost(z);
    best_ = z;
  }

  std::optional<Vec3> improved(const Vec3& z) {
    planes_.clear();
    has_plane_.assign(obstacles_.size(), false);
    while (true) {
      std::optional<Vec3> next = project_(planes_);
      if (!next) return std::nullopt;
      bool blocked = false;
      for (std::size_t i = 0; i < obstacles_.size(); ++i) {
        if (!blocks(obstacles_[i], *next)) continue;
        if (has_plane_[i]) return std::nullopt;  // a result of rounding
        planes_.push_back(separating(obstacles_[i], z));
        has_plane_[i] = true;
        blocked = true;
      }
      if (!blocked) return next;
    }
  }

  std::vector<Obstacle> obstacles_;
  Vec3 target_;
  double rounding_;
  Projection project_;
  std::priority_queue<Cell> open_;
  Vec3 best_ = Vec3::Zero();
  double cost_ = 1.0;
  std::vector<Plane> planes_;
  std::vector<bool> has_plane_;
};

/// Returns the triangles that can limit the best motion. It is in the ball with the diameter [0,
/// desired], because otherwise a shorter motion in its direction would be better.
std::vector<Obstacle> obstacles(const Mesh& mesh, std::span<const TriangleId> near, const Vec3& tip,
                                const Vec3& target, double unit, double margin) {
  std::vector<Obstacle> out;
  for (const TriangleId id : near) {
    Triangle t = mesh.triangle(id);
    for (Vec3& v : t) v = (v - tip) / unit;
    if (closest_point(t, 0.5 * target).distance > (0.5 + margin) * (1.0 + 1e-9)) continue;
    const Vec3 center = (t[0] + t[1] + t[2]) / 3.0;
    const ClosestPoint tip_to = closest_point(t, Vec3::Zero());
    const double own = std::min(margin, tip_to.distance);
    double radius = 0.0;
    for (const Vec3& v : t) radius = std::max(radius, (v - center).norm());
    out.push_back(
        {t, own, center, radius + own, -tip_to.offset / tip_to.distance, tip_to.distance - own});
  }
  std::sort(out.begin(), out.end(),
            [](const Obstacle& a, const Obstacle& b) { return a.room < b.room; });
  return out;
}

}  // namespace

BestStep best_step(const Mesh& mesh, std::span<const TriangleId> near, const Vec3& tip,
                   const Vec3& desired, double margin) {
  const double unit = desired.norm();
  if (unit == 0.0) return {Vec3::Zero(), 0.0, 0.0};
  const Vec3 target = desired / unit;
  const BestStep best =
      Search(obstacles(mesh, near, tip, target, unit, margin / unit), target).run();
  const Vec3 motion = best.cost == 0.0 ? desired : Vec3(unit * best.motion);
  return {motion, (motion - desired).norm(), unit * best.bound};
}

}  // namespace keepout::oracle
