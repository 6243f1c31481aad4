// SPDX-License-Identifier: BSD-3-Clause
//
// Points and directions in the lanes of wide registers, sixteen or as many as the processor has.
// Included once for each SIMD target: see foreach_target.h of Highway.
#if defined(KEEPOUT_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KEEPOUT_LANES_INL_H
#undef KEEPOUT_LANES_INL_H
#else
#define KEEPOUT_LANES_INL_H
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace keepout::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Highway's descriptor of a vector of floats; V and M are its vectors and masks.
using FloatTag = hn::CappedTag<float, 16>;
using V = hn::Vec<FloatTag>;
using M = hn::Mask<FloatTag>;

struct Vector {
  V x, y, z;
};

/// A triangle in each lane.
struct TriangleLanes {
  Vector a, b, c;
};

HWY_INLINE Vector operator-(const Vector& a, const Vector& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}

HWY_INLINE Vector operator*(V s, const Vector& a) {
  return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)};
}

HWY_INLINE Vector operator+(const Vector& a, const Vector& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}

HWY_INLINE V dot(const Vector& a, const Vector& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

/// Returns the sum of the coordinates' magnitudes: an upper bound of the length.
HWY_INLINE V norm1(const Vector& a) {
  return hn::Add(hn::Add(hn::Abs(a.x), hn::Abs(a.y)), hn::Abs(a.z));
}

HWY_INLINE Vector min(const Vector& a, const Vector& b) {
  return {hn::Min(a.x, b.x), hn::Min(a.y, b.y), hn::Min(a.z, b.z)};
}

HWY_INLINE Vector max(const Vector& a, const Vector& b) {
  return {hn::Max(a.x, b.x), hn::Max(a.y, b.y), hn::Max(a.z, b.z)};
}

HWY_INLINE Vector select(M mask, const Vector& yes, const Vector& no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y),
          hn::IfThenElse(mask, yes.z, no.z)};
}

/// Returns the same vector in every lane.
HWY_INLINE Vector all(FloatTag d, const float* v) {
  return {hn::Set(d, v[0]), hn::Set(d, v[1]), hn::Set(d, v[2])};
}

/// Loads vectors of a block, stored coordinate by coordinate, from `lane` on.
template <std::size_t Lanes>
HWY_INLINE Vector load(FloatTag d, const float (&from)[3][Lanes], std::size_t lane) {
  return {hn::Load(d, from[0] + lane), hn::Load(d, from[1] + lane), hn::Load(d, from[2] + lane)};
}

template <std::size_t Lanes>
HWY_INLINE void store(FloatTag d, const Vector& v, std::size_t lane, float (&to)[3][Lanes]) {
  hn::Store(v.x, d, to[0] + lane);
  hn::Store(v.y, d, to[1] + lane);
  hn::Store(v.z, d, to[2] + lane);
}

/// Returns the bits of a mask, each at the place of its lane in the block.
HWY_INLINE std::uint32_t bits(FloatTag d, M mask, std::size_t lane) {
  alignas(8) std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  return (bytes[0] | std::uint32_t{bytes[1]} << 8) << lane;
}

}  // namespace keepout::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
