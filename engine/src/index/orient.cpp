// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/index/orient.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "../mesh/half_edges.h"
#include "keepout/index/budget.h"
#include "keepout/index/pd_tree.h"
#include "keepout/index/query.h"

namespace keepout {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Sets of triangles that are connected by edges, and their relative winding. A union-find with
/// path halving that also stores if a triangle is wound against its parent.
class WoundSets {
 public:
  explicit WoundSets(std::size_t size) : up_(size), is_one_sided_(size, 0) {
    for (TriangleId t = 0; t < size; ++t) up_[t] = {t, false};
  }

  /// The first triangle, which represents the set, and whether a triangle is wound against it.
  struct Place {
    TriangleId first;
    bool is_opposite;
  };

  Place find(TriangleId t) noexcept {
    bool is_opposite = false;
    while (up_[t].first != t) {
      const Place above = up_[up_[t].first];
      up_[t] = {above.first, up_[t].is_opposite != above.is_opposite};
      is_opposite = is_opposite != up_[t].is_opposite;
      t = up_[t].first;
    }
    return {t, is_opposite};
  }

  void join(TriangleId a, TriangleId b, bool is_opposite) noexcept {
    const Place one = find(a);
    const Place other = find(b);
    const bool differs = (one.is_opposite != other.is_opposite) != is_opposite;
    if (one.first == other.first) {
      if (differs) is_one_sided_[one.first] = 1;
      return;
    }
    const auto [low, high] = std::minmax(one.first, other.first);
    up_[high] = {low, differs};
    is_one_sided_[low] |= is_one_sided_[high];
  }

  bool is_one_sided(TriangleId first) const noexcept { return is_one_sided_[first] != 0; }

 private:
  std::vector<Place> up_;
  std::vector<unsigned char> is_one_sided_;
};

/// A part of a surface: see Orientation.
struct Part {
  std::vector<TriangleId> triangles = {};
  std::size_t opposite = 0;  // triangles that are wound against the first one
  bool is_one_sided = false;
  bool is_open = false;
  bool is_non_manifold = false;
  double volume = 0.0;       // signed, by the winding of most triangles [length^3]
  double uncertainty = 0.0;  // of the volume [length^3]
  Box bounds{Vec3::Constant(infinity), Vec3::Constant(-infinity)};
  bool is_turned = false;  // all of it

  bool is_closed() const noexcept { return !is_one_sided && !is_open && !is_non_manifold; }
  bool has_volume() const noexcept { return is_closed() && std::abs(volume) > uncertainty; }
};

/// A surface in parts.
struct Parts {
  std::vector<Part> parts = {};
  std::vector<std::size_t> part_of = {};  // of each triangle
  std::vector<bool> is_disagreeing = {};  // of each triangle: true if wound against most of its
                                          // part
};

Parts parts_of(const Mesh& mesh) {
  WoundSets sets(mesh.triangle_count());
  for_each_edge(mesh, [&](VertexId, std::span<const HalfEdge> sides) {
    if (sides.size() != 2) return;
    sets.join(sides[0].triangle, sides[1].triangle, sides[0].upwards == sides[1].upwards);
  });
  Parts all{{},
            std::vector<std::size_t>(mesh.triangle_count()),
            std::vector<bool>(mesh.triangle_count(), false)};
  for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
    const auto [first, is_opposite] = sets.find(t);
    if (first == t) {
      all.part_of[t] = all.parts.size();
      all.parts.emplace_back().is_one_sided = sets.is_one_sided(t);
    }
    all.part_of[t] = all.part_of[first];
    Part& part = all.parts[all.part_of[t]];
    part.triangles.push_back(t);
    if (is_opposite) ++part.opposite;
    all.is_disagreeing[t] = is_opposite;
  }
  for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
    const Part& part = all.parts[all.part_of[t]];
    const bool most_are_opposite = 2 * part.opposite > part.triangles.size();
    all.is_disagreeing[t] = !part.is_one_sided && all.is_disagreeing[t] != most_are_opposite;
  }
  return all;
}

/// Finds the parts that end at edges. A part does not end at an edge of several triangles if its
/// own triangles cancel there, as those of two solids that touch along the edge do.
void find_ends(const Mesh& mesh, Parts& all) {
  for_each_edge(mesh, [&](VertexId, std::span<const HalfEdge> sides) {
    if (sides.size() == 2) return;
    if (sides.size() == 1) {
      all.parts[all.part_of[sides[0].triangle]].is_open = true;
      return;
    }
    std::vector<std::pair<std::size_t, int>> directions;
    for (const HalfEdge& side : sides) {
      const bool is_up = side.upwards != all.is_disagreeing[side.triangle];
      directions.emplace_back(all.part_of[side.triangle], is_up ? 1 : -1);
    }
    std::sort(directions.begin(), directions.end());
    for (auto own = directions.begin(); own != directions.end();) {
      int sum = 0;
      const std::size_t part = own->first;
      for (; own != directions.end() && own->first == part; ++own) sum += own->second;
      if (sum != 0) all.parts[part].is_non_manifold = true;
    }
  });
}

void measure(const Mesh& mesh, const Parts& all, Part& part) {
  const Vec3 origin = mesh.vertex(mesh.corners(part.triangles.front())[0]);
  double sum_of_sizes = 0.0;
  for (const TriangleId t : part.triangles) {
    const Triangle corners = mesh.triangle(t);
    const Vec3 cross = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    const double volume = (corners[0] - origin).dot(cross) / 6.0;
    part.volume += all.is_disagreeing[t] ? -volume : volume;
    sum_of_sizes += std::abs(volume);
    for (const Vec3& corner : corners) {
      part.bounds.low = part.bounds.low.cwiseMin(corner);
      part.bounds.high = part.bounds.high.cwiseMax(corner);
    }
  }
  // Coordinates far from the origin lose digits when they are subtracted.
  const double far =
      mesh.bounds().low.cwiseAbs().cwiseMax(mesh.bounds().high.cwiseAbs()).maxCoeff();
  const double size = part.bounds.size().norm();
  part.uncertainty = 1e-13 * (sum_of_sizes + size * size * far);
}

/// The position of a part relative to a solid.
enum class Relation { beside, within, crossing };

/// A closed part as a solid, to decide if another part is within it.
class Solid {
 public:
  Solid(const Mesh& mesh, const Parts& all, const Part& part) {
    Surface surface;
    for (const TriangleId t : part.triangles) {
      Triangle corners = mesh.triangle(t);
      if (all.is_disagreeing[t] != (part.volume < 0.0)) std::swap(corners[1], corners[2]);
      const auto first = static_cast<VertexId>(surface.vertices.size());
      surface.vertices.insert(surface.vertices.end(), corners.begin(), corners.end());
      surface.triangles.push_back({first, first + 1, first + 2});
    }
    const auto own = std::make_shared<const Mesh>(weld(std::move(surface)));
    neighborhood_.emplace(own, std::make_shared<const PdTree>(own), own->triangle_count(), budget_);
  }
  Solid(const Solid&) = delete;
  Solid& operator=(const Solid&) = delete;

  /// Returns the position of a part, by its vertices that are not on the surface of the solid.
  Relation relation_of(const Mesh& mesh, const Part& part) {
    std::vector<VertexId> vertices;
    for (const TriangleId t : part.triangles) {
      vertices.insert(vertices.end(), mesh.corners(t).begin(), mesh.corners(t).end());
    }
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    bool is_any_within = false;
    bool is_any_outside = false;
    for (const VertexId v : vertices) {
      const std::optional<bool> is_within = contains(mesh.vertex(v));
      if (!is_within) continue;
      (*is_within ? is_any_within : is_any_outside) = true;
      if (is_any_within && is_any_outside) return Relation::crossing;
    }
    return is_any_within ? Relation::within : Relation::beside;
  }

 private:
  /// Returns true if a point is in the solid. Returns nothing if the point is within the rounding
  /// of single precision from the surface.
  std::optional<bool> contains(const Vec3& point) {
    const Box& bounds = neighborhood_->mesh().bounds();
    const double far = bounds.low.cwiseAbs().cwiseMax(bounds.high.cwiseAbs()).maxCoeff();
    const double on_surface = 1e-7 * (bounds.size().norm() + far);
    const Vec3 beyond = (bounds.low - point).cwiseMax(point - bounds.high);
    if (beyond.maxCoeff() > on_surface) return false;
    const std::optional<SideOfSurface> side = find_side(*neighborhood_, point);
    if (!side || side->distance <= on_surface) return std::nullopt;
    return !side->is_outside;
  }

  Budget budget_;
  std::optional<Neighborhood> neighborhood_;
};

bool overlap(const Box& one, const Box& other) noexcept {
  return (one.low.array() <= other.high.array()).all() &&
         (other.low.array() <= one.high.array()).all();
}

/// Finds the added boxes that overlap a given box, with a balanced tree over all boxes.
class BoxTree {
 public:
  explicit BoxTree(std::vector<Box> boxes)
      : boxes_(std::move(boxes)), order_(boxes_.size()), place_of_(boxes_.size()) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    nodes_.resize(boxes_.empty() ? 0 : 2 * std::bit_ceil(boxes_.size()), nothing);
    sort(0, order_.size());
    for (std::size_t i = 0; i < order_.size(); ++i) place_of_[order_[i]] = i;
  }

  void add(std::size_t box) {
    std::size_t begin = 0, end = order_.size();
    for (std::size_t node = 1;;) {
      nodes_[node].low = nodes_[node].low.cwiseMin(boxes_[box].low);
      nodes_[node].high = nodes_[node].high.cwiseMax(boxes_[box].high);
      if (end - begin == 1) return;
      const std::size_t middle = begin + (end - begin) / 2;
      const bool is_below = place_of_[box] < middle;
      (is_below ? end : begin) = middle;
      node = 2 * node + (is_below ? 0 : 1);
    }
  }

  /// Returns the numbers of the added boxes that overlap `box`, in ascending order.
  std::vector<std::size_t> overlapping(const Box& box) const {
    std::vector<std::size_t> found;
    if (!boxes_.empty()) collect(box, 1, 0, order_.size(), found);
    std::sort(found.begin(), found.end());
    return found;
  }

 private:
  inline static const Box nothing{Vec3::Constant(infinity), Vec3::Constant(-infinity)};

  /// Moves the boxes below the middle of a range to its front, along the axis of the largest
  /// spread.
  void sort(std::size_t begin, std::size_t end) {
    if (end - begin < 2) return;
    Box centers = nothing;
    for (std::size_t i = begin; i < end; ++i) {
      centers.low = centers.low.cwiseMin(boxes_[order_[i]].center());
      centers.high = centers.high.cwiseMax(boxes_[order_[i]].center());
    }
    int axis = 0;
    centers.size().maxCoeff(&axis);
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end), [&](std::size_t a, std::size_t b) {
      return boxes_[a].center()[axis] < boxes_[b].center()[axis];
    });
    sort(begin, middle);
    sort(middle, end);
  }

  void collect(const Box& box, std::size_t node, std::size_t begin, std::size_t end,
               std::vector<std::size_t>& found) const {
    if (!overlap(nodes_[node], box)) return;
    if (end - begin == 1) {
      found.push_back(order_[begin]);
      return;
    }
    const std::size_t middle = begin + (end - begin) / 2;
    collect(box, 2 * node, begin, middle, found);
    collect(box, 2 * node + 1, middle, end, found);
  }

  std::vector<Box> boxes_;
  std::vector<std::size_t> order_;     // of the boxes in the tree
  std::vector<std::size_t> place_of_;  // of each box in the order
  std::vector<Box> nodes_;  // around the added boxes; the children of i are 2i and 2i + 1
};

/// Decides which of the parts that have a volume are turned, the largest first, because only a
/// larger part can be around another.
void turn_outward(const Mesh& mesh, Parts& all, Orientation& result) {
  std::vector<Part*> solid_parts;
  for (Part& part : all.parts) {
    if (part.has_volume()) solid_parts.push_back(&part);
  }
  std::stable_sort(solid_parts.begin(), solid_parts.end(), [](const Part* a, const Part* b) {
    return std::abs(a->volume) > std::abs(b->volume);
  });
  std::vector<Box> boxes;
  for (const Part* const part : solid_parts) boxes.push_back(part->bounds);
  BoxTree outermost(std::move(boxes));
  std::vector<std::unique_ptr<Solid>> solids(solid_parts.size());  // made at the first use
  for (std::size_t i = 0; i < solid_parts.size(); ++i) {
    Part& part = *solid_parts[i];
    const Part* around = nullptr;
    bool is_crossing = false;
    for (const std::size_t outer : outermost.overlapping(part.bounds)) {
      if (!solids[outer]) solids[outer] = std::make_unique<Solid>(mesh, all, *solid_parts[outer]);
      const Relation relation = solids[outer]->relation_of(mesh, part);
      if (relation == Relation::crossing) is_crossing = true;
      if (relation != Relation::within) continue;
      around = solid_parts[outer];
      break;
    }
    if (around != nullptr) {
      part.is_turned = around->is_turned;
      ++result.nested_parts;
      continue;
    }
    part.is_turned = part.volume < 0.0;
    if (part.is_turned) ++result.inside_out_parts;
    if (is_crossing) ++result.crossing_parts;
    outermost.add(i);
  }
}

void count_kinds(const Parts& all, Orientation& result) {
  result.parts = all.parts.size();
  for (const Part& part : all.parts) {
    ++(part.is_one_sided      ? result.one_sided_parts
       : part.is_non_manifold ? result.non_manifold_parts
       : part.is_open         ? result.open_parts
       : !part.has_volume()   ? result.flat_parts
                              : result.closed_parts);
  }
}

}  // namespace

Orientation orient(Surface& surface) {
  const Mesh mesh(surface);
  Parts all = parts_of(mesh);
  find_ends(mesh, all);
  for (Part& part : all.parts) measure(mesh, all, part);
  Orientation result;
  turn_outward(mesh, all, result);
  count_kinds(all, result);
  for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
    if (all.is_disagreeing[t]) ++result.disagreeing;
    if (all.is_disagreeing[t] == all.parts[all.part_of[t]].is_turned) continue;
    std::swap(surface.triangles[t][1], surface.triangles[t][2]);
    ++result.turned;
  }
  return result;
}

}  // namespace keepout
