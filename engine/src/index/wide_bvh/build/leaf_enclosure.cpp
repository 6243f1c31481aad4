// SPDX-License-Identifier: BSD-3-Clause
#include "enclosure.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "index/wide_bvh/build/leaf_enclosure.cpp"
#include <hwy/foreach_target.h>
// This include must follow foreach_target.h, which sets the target to compile for.
#include "../../../lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace keepout::HWY_NAMESPACE {

constexpr std::size_t width = hn::MaxLanes(FloatTag());
constexpr std::size_t leaf_count = NodeBlock::lanes;

/// One vector for each leaf. put_together() later reduces the lanes of a vector to one number.
struct alignas(64) Rows {
  float row[leaf_count][width];
};

struct VectorRows {
  Rows x, y, z;
};

HWY_INLINE void store(FloatTag d, const Vector& v, std::size_t leaf, VectorRows& to) {
  hn::Store(v.x, d, to.x.row[leaf]);
  hn::Store(v.y, d, to.y.row[leaf]);
  hn::Store(v.z, d, to.z.row[leaf]);
}

/// Reduces the lanes of each of `Count` rows to one number. Each round combines two rows into one,
/// so the results end up side by side. This takes a quarter of the work of reducing one row after
/// the other.
template <std::size_t Count, class Operation>
HWY_INLINE V put_together(FloatTag d, const float (*rows)[width],
                          [[maybe_unused]] const Operation& operation) {
#if HWY_TARGET != HWY_SCALAR  // the scalar target has one lane and cannot halve it
  if constexpr (Count > 1) {
    const V front = put_together<Count / 2>(d, rows, operation);
    const V back = put_together<Count / 2>(d, rows + Count / 2, operation);
    return operation(hn::ConcatEven(d, back, front), hn::ConcatOdd(d, back, front));
  }
#endif
  return hn::Load(d, *rows);
}

constexpr auto sum = [](V a, V b) HWY_ATTR { return hn::Add(a, b); };
constexpr auto least_of = [](V a, V b) HWY_ATTR { return hn::Min(a, b); };
constexpr auto most_of = [](V a, V b) HWY_ATTR { return hn::Max(a, b); };

/// Returns a number for each leaf, from leaf `first` on.
template <class Operation>
HWY_INLINE V of_leaves(FloatTag d, const Rows& rows, std::size_t first,
                       const Operation& operation) {
  return put_together<width>(d, rows.row + first, operation);
}

template <class Operation>
HWY_INLINE Vector of_leaves(FloatTag d, const VectorRows& rows, std::size_t first,
                            const Operation& operation) {
  return {of_leaves(d, rows.x, first, operation), of_leaves(d, rows.y, first, operation),
          of_leaves(d, rows.z, first, operation)};
}

/// Calls visit(points) for all vertices of the leaf, in the lanes of registers.
template <class Visit>
HWY_INLINE void for_each_vertex(FloatTag d, const LeafBlock& leaf, const LeafPoints& points,
                                const Visit& visit) {
  if (points.is_known) {
    for (std::size_t lane = 0; lane < LeafVertices::most; lane += width) {
      visit(load(d, points.position, lane));
    }
    return;
  }
  for (const auto& corner : leaf.corner) {
    for (std::size_t lane = 0; lane < LeafBlock::lanes; lane += width) {
      visit(load(d, corner, lane));
    }
  }
}

/// Computes the sum of the triangles' normals, each twice as long as the area and on the side given
/// by the winding. Also computes the leaf's box.
HWY_INLINE void look_at(FloatTag d, const LeafBlock& leaf, const LeafPoints& points,
                        std::size_t row, VectorRows& normals, VectorRows& lows, VectorRows& highs) {
  const hn::RebindToUnsigned<FloatTag> unsigned_lanes;
  const V zero = hn::Zero(d);
  Vector normal{zero, zero, zero};
  Vector low = load(d, leaf.corner[0], 0);
  Vector high = low;
  for_each_vertex(d, leaf, points, [&](const Vector& at) HWY_ATTR {
    low = min(low, at);
    high = max(high, at);
  });
  for (std::size_t lane = 0; lane < LeafBlock::lanes; lane += width) {
    const Vector a = load(d, leaf.corner[0], lane);
    const Vector b = load(d, leaf.corner[1], lane);
    const Vector c = load(d, leaf.corner[2], lane);
    const Vector ab = b - a;
    const Vector ac = c - a;
    // The bit `odd` is at the place of a float's sign.
    const V sign = hn::BitCast(d, hn::And(hn::Load(unsigned_lanes, leaf.tagged_triangle + lane),
                                          hn::Set(unsigned_lanes, LeafBlock::odd)));
    const auto turned = [&](V p, V q, V r, V s) HWY_ATTR {
      return hn::Xor(hn::Sub(hn::Mul(p, q), hn::Mul(r, s)), sign);
    };
    normal = normal + Vector{turned(ab.y, ac.z, ab.z, ac.y), turned(ab.z, ac.x, ab.x, ac.z),
                             turned(ab.x, ac.y, ab.y, ac.x)};
  }
  store(d, normal, row, normals);
  store(d, low, row, lows);
  store(d, high, row, highs);
}

/// Sets the axis of each leaf's cylinder. Sets the middle of the cylinder to the middle of the
/// leaf's box; set_sizes() moves it later.
HWY_INLINE void set_axes(FloatTag d, const VectorRows& normals, const NodeBlock& boxes,
                         CylinderBlock& cylinders) {
  const V zero = hn::Zero(d);
  const V one = hn::Set(d, 1.0f);
  for (std::size_t first = 0; first < leaf_count; first += width) {
    const Vector normal = of_leaves(d, normals, first, sum);
    const V length2 = dot(normal, normal);
    const M is_sheet =
        hn::And(hn::Gt(length2, hn::Set(d, 1e-30f)), hn::Lt(length2, hn::Set(d, 1e30f)));
    const V length = hn::Sqrt(hn::IfThenElse(is_sheet, length2, one));
    store(d, select(is_sheet, hn::Div(one, length) * normal, {zero, zero, one}), first,
          cylinders.axis);
    const Vector low = load(d, boxes.low, first);
    const Vector high = load(d, boxes.high, first);
    store(d, low + hn::Set(d, 0.5f) * (high - low), first, cylinders.middle);
  }
}

/// Measures a leaf from the middle of its box, along the cylinder's axis and across it.
HWY_INLINE void measure(FloatTag d, const LeafBlock& leaf, const LeafPoints& points,
                        std::size_t row, const CylinderBlock& cylinders, Rows& bottoms, Rows& tops,
                        Rows& radii2) {
  const auto vector_of = [&](const float(&from)[3][leaf_count]) HWY_ATTR -> Vector {
    return {hn::Set(d, from[0][row]), hn::Set(d, from[1][row]), hn::Set(d, from[2][row])};
  };
  const Vector middle = vector_of(cylinders.middle);
  const Vector axis = vector_of(cylinders.axis);
  V bottom = dot(axis, load(d, leaf.corner[0], 0) - middle);
  V top = bottom;
  V radius2 = hn::Zero(d);
  for_each_vertex(d, leaf, points, [&](const Vector& at) HWY_ATTR {
    const Vector way = at - middle;
    const V height = dot(axis, way);
    const Vector across = way - height * axis;
    bottom = hn::Min(bottom, height);
    top = hn::Max(top, height);
    radius2 = hn::Max(radius2, dot(across, across));
  });
  hn::Store(bottom, d, bottoms.row[row]);
  hn::Store(top, d, tops.row[row]);
  hn::Store(radius2, d, radii2.row[row]);
}

/// Moves the middle of each cylinder along its axis, to the middle of the heights of the leaf's
/// triangles. Sets half height and radius.
HWY_INLINE void set_sizes(FloatTag d, const Rows& bottoms, const Rows& tops, const Rows& radii2,
                          const NodeBlock& boxes, CylinderBlock& cylinders) {
  for (std::size_t first = 0; first < leaf_count; first += width) {
    const V bottom = of_leaves(d, bottoms, first, least_of);
    const V top = of_leaves(d, tops, first, most_of);
    const V radius2 = of_leaves(d, radii2, first, most_of);
    const Vector axis = load(d, cylinders.axis, first);
    const Vector box_middle = load(d, cylinders.middle, first);
    const Vector middle = box_middle + hn::Mul(hn::Set(d, 0.5f), hn::Add(bottom, top)) * axis;
    // The rounded middle is not exactly at the computed height, and not exactly on the axis.
    const Vector moved = middle - box_middle;
    const V along = dot(axis, moved);
    const Vector off = moved - along * axis;

    // The greatest distance of a corner from the middle of the box.
    const V far = norm1(load(d, boxes.high, first) - load(d, boxes.low, first));
    // Rounding changes a length by less than this fraction of far + norm1(moved). The errors of a
    // dozen operations, and of the axis's length, add up to less than 24 u. Here u is the unit
    // roundoff of float, and `outward` is more than 32 u.
    constexpr float outward = 2e-6f;
    const V rounding = hn::Mul(hn::Set(d, outward), hn::Add(far, norm1(moved)));
    // Squares of very small or very large numbers are lost.
    const M is_known =
        hn::And(hn::Gt(radius2, hn::Set(d, 1e-30f)), hn::Lt(radius2, hn::Set(d, 1e30f)));
    const V radius = hn::IfThenElse(is_known, hn::Sqrt(radius2), far);
    const V half_height = hn::Max(hn::Sub(top, along), hn::Sub(along, bottom));
    store(d, middle, first, cylinders.middle);
    hn::Store(hn::Add(half_height, rounding), d, cylinders.half_height + first);
    hn::Store(hn::Add(hn::Add(radius, hn::Sqrt(dot(off, off))), rounding), d,
              cylinders.radius + first);
  }
}

void EncloseLeaves(const SixteenLeaves& leaves, NodeBlock& boxes, CylinderBlock& cylinders) {
  const FloatTag d;
  VectorRows normals, lows, highs;
  for (std::size_t leaf = 0; leaf < leaf_count; ++leaf) {
    look_at(d, leaves.leaf[leaf], leaves.points[leaf], leaf, normals, lows, highs);
  }
  // -0 becomes 0, because which of them is the least depends on the order of the vertices.
  const Vector zero{hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  for (std::size_t first = 0; first < leaf_count; first += width) {
    store(d, of_leaves(d, lows, first, least_of) + zero, first, boxes.low);
    store(d, of_leaves(d, highs, first, most_of) + zero, first, boxes.high);
  }
  set_axes(d, normals, boxes, cylinders);
  Rows bottoms, tops, radii2;
  for (std::size_t leaf = 0; leaf < leaf_count; ++leaf) {
    measure(d, leaves.leaf[leaf], leaves.points[leaf], leaf, cylinders, bottoms, tops, radii2);
  }
  set_sizes(d, bottoms, tops, radii2, boxes, cylinders);
}

}  // namespace keepout::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace keepout {

HWY_EXPORT(EncloseLeaves);

void enclose(const SixteenLeaves& leaves, NodeBlock& boxes, CylinderBlock& cylinders) noexcept {
  HWY_DYNAMIC_DISPATCH(EncloseLeaves)(leaves, boxes, cylinders);
}

}  // namespace keepout

#endif
