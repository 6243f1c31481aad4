// SPDX-License-Identifier: BSD-3-Clause
#include "igtl/polydata.h"

#include <cstdint>
#include <string>

#include "keepout/error.h"

namespace keepout::app::igtl {
namespace {

[[noreturn]] void fail(const std::string& why) { throw Error("POLYDATA: " + why); }

/// The numbers at the beginning of the content.
struct Sizes {
  std::uint32_t points;
  std::uint32_t vertices, vertex_bytes;
  std::uint32_t lines, line_bytes;
  std::uint32_t polygons, polygon_bytes;
  std::uint32_t strips, strip_bytes;
  std::uint32_t attributes;
};
constexpr std::size_t sizes_size = 10 * 4;
constexpr std::size_t coordinates_size = 3 * 4;  // of a point
constexpr std::size_t polygon_size = 4 * 4;      // of a triangle

Sizes read_sizes(Reader& reader) {
  if (reader.left() < sizes_size) fail("the body is too short for its header");
  const auto next = [&] { return reader.number<std::uint32_t>(); };
  Sizes sizes;
  for (std::uint32_t* one : {&sizes.points, &sizes.vertices, &sizes.vertex_bytes, &sizes.lines,
                             &sizes.line_bytes, &sizes.polygons, &sizes.polygon_bytes,
                             &sizes.strips, &sizes.strip_bytes, &sizes.attributes}) {
    *one = next();
  }
  const std::uint64_t declared = std::uint64_t{sizes.points} * coordinates_size +
                                 sizes.vertex_bytes + sizes.line_bytes + sizes.polygon_bytes +
                                 sizes.strip_bytes + std::uint64_t{sizes.attributes} * 6;
  if (declared > reader.left() || (sizes.attributes == 0 && declared < reader.left())) {
    fail("the sizes in the body contradict the size of the body; the sender is faulty");
  }
  return sizes;
}

VertexId read_corner(Reader& reader, std::uint32_t points) {
  const auto corner = reader.number<std::uint32_t>();
  if (corner < points) return corner;
  fail("a triangle names point " + std::to_string(corner) + ", but there are only " +
       std::to_string(points) + "; the sender is faulty");
}

void read_polygons(Reader reader, const Sizes& sizes, Surface& surface) {
  if (sizes.polygon_bytes != std::uint64_t{sizes.polygons} * polygon_size) {
    fail("a polygon is not a triangle: triangulate the model and send it again");
  }
  for (std::uint32_t i = 0; i < sizes.polygons; ++i) {
    if (reader.number<std::uint32_t>() != 3) {
      fail("a polygon is not a triangle: triangulate the model and send it again");
    }
    Corners& triangle = surface.triangles.emplace_back();
    for (VertexId& corner : triangle) corner = read_corner(reader, sizes.points);
  }
}

/// Every second triangle of a strip is wound the other way round.
void read_strips(Reader reader, const Sizes& sizes, Surface& surface) {
  for (std::uint32_t i = 0; i < sizes.strips; ++i) {
    const std::uint64_t count = reader.left() < 4 ? 0 : reader.number<std::uint32_t>();
    if (count < 3 || 4 * count > reader.left()) {
      fail("a triangle strip has fewer than three corners, or more than the body");
    }
    Corners last = {0, read_corner(reader, sizes.points), read_corner(reader, sizes.points)};
    for (std::uint64_t corner = 2; corner < count; ++corner) {
      last = {last[1], last[2], read_corner(reader, sizes.points)};
      surface.triangles.push_back(corner % 2 == 0 ? last : Corners{last[1], last[0], last[2]});
    }
  }
  if (reader.left() > 0) fail("the triangle strips are shorter than their declared size");
}

}  // namespace

Surface read_polydata(Bytes content) {
  Reader reader(content);
  const Sizes sizes = read_sizes(reader);
  Surface surface;
  surface.vertices.resize(sizes.points);
  for (Vec3& point : surface.vertices) {
    for (double& x : point) x = reader.real();
  }
  reader.take(sizes.vertex_bytes);
  reader.take(sizes.line_bytes);
  surface.triangles.reserve(sizes.polygon_bytes / polygon_size + sizes.strip_bytes / 4);
  read_polygons(Reader(reader.take(sizes.polygon_bytes)), sizes, surface);
  read_strips(Reader(reader.take(sizes.strip_bytes)), sizes, surface);
  if (surface.triangles.empty()) fail("there is no triangle; send the model of a surface");
  return surface;
}

void write_polydata(ByteList& out, std::string_view device, double stamp,
                    std::span<const Triangle> triangles) {
  Writer writer(out, "POLYDATA", device, stamp);
  const auto count = static_cast<std::uint32_t>(triangles.size());
  for (const std::uint32_t size : {3 * count, 0u, 0u, 0u, 0u, count,
                                   static_cast<std::uint32_t>(polygon_size) * count, 0u, 0u, 0u}) {
    writer.number(size);
  }
  for (const Triangle& triangle : triangles) {
    for (const Vec3& corner : triangle) {
      for (const double x : corner) writer.real(x);
    }
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    for (const std::uint32_t number : {3u, 3 * i, 3 * i + 1, 3 * i + 2}) writer.number(number);
  }
  writer.finish();
}

}  // namespace keepout::app::igtl
