// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/mesh/binary_ply.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <ostream>

#include "keepout/error.h"

namespace keepout {
namespace {

static_assert(std::endian::native == std::endian::little, "the file is little-endian");

bool is_of_floats(const Surface& surface) noexcept {
  return std::ranges::all_of(surface.vertices, [](const Vec3& v) {
    // Beyond the range of a float the conversion is undefined.
    return v.cwiseAbs().maxCoeff() <= double{std::numeric_limits<float>::max()} &&
           v.cast<float>().cast<double>() == v;
  });
}

template <class Real>
void print_vertices(std::ostream& out, const Surface& surface) {
  for (const Vec3& v : surface.vertices) {
    const std::array<Real, 3> values{static_cast<Real>(v.x()), static_cast<Real>(v.y()),
                                     static_cast<Real>(v.z())};
    out.write(reinterpret_cast<const char*>(values.data()), sizeof values);
  }
}

}  // namespace

void write_binary_ply(std::ostream& out, const Surface& surface, AnatomicalSpace space) {
  if (surface.vertices.size() > std::size_t{std::numeric_limits<std::int32_t>::max()}) {
    throw Error("more vertices than a PLY file can number; split the mesh");
  }
  const bool has_floats = is_of_floats(surface);
  const char* const real = has_floats ? "float" : "double";
  out << "ply\nformat binary_little_endian 1.0\ncomment written by keepout\n";
  if (space != AnatomicalSpace::unstated) out << "comment SPACE=" << name(space) << '\n';
  out << "element vertex " << surface.vertices.size() << '\n';
  for (const char axis : {'x', 'y', 'z'}) out << "property " << real << ' ' << axis << '\n';
  out << "element face " << surface.triangles.size()
      << "\nproperty list uchar int vertex_indices\nend_header\n";
  if (has_floats) {
    print_vertices<float>(out, surface);
  } else {
    print_vertices<double>(out, surface);
  }
  for (const Corners& c : surface.triangles) {
    constexpr std::size_t size = 1 + sizeof(Corners);
    std::array<char, size> record;
    record[0] = 3;
    std::memcpy(record.data() + 1, c.data(), sizeof c);
    out.write(record.data(), size);
  }
}

}  // namespace keepout
