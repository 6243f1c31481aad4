// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause

#include "keepout/mesh/binary_stl.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "../file_replacement.h"
#include "../huge_pages.h"
#include "keepout/error.h"
#include "stl_records.h"
#include "weld_blocks.h"

namespace keepout {
namespace {

constexpr std::size_t records_at_once = 20'000;  // one megabyte

/// Appends the triangle of one record; false if a coordinate is not finite.
bool append(const char* record, Surface& surface) {
  const StlCorners c = stl_corners(record);
  const auto first = static_cast<VertexId>(surface.vertices.size());
  surface.vertices.emplace_back(c[0], c[1], c[2]);
  surface.vertices.emplace_back(c[3], c[4], c[5]);
  surface.vertices.emplace_back(c[6], c[7], c[8]);
  surface.triangles.push_back({first, first + 1, first + 2});
  return is_finite(c);
}

void write_records(FileReplacement& file, std::span<const Vec3> vertices,
                   std::span<const Corners> triangles) {
  for (const Corners& corners : triangles) {
    Triangle t;
    for (int i = 0; i < 3; ++i) t[i] = vertices[corners[i]];
    const Vec3 normal = unit_normal(t);
    std::array<float, 12> values;
    std::size_t n = 0;
    for (const Vec3& v : {normal, t[0], t[1], t[2]}) {
      for (int axis = 0; axis < 3; ++axis) values[n++] = static_cast<float>(v[axis]);
    }
    std::array<char, stl_record_size> record{};
    std::memcpy(record.data(), values.data(), sizeof values);
    file.write(record.data(), record.size());
  }
}

void write(const std::filesystem::path& path, std::span<const Vec3> vertices,
           std::span<const Corners> triangles) {
  const auto fail = [&](const std::string& what) { throw Error(path.string() + ": " + what); };
  if (triangles.size() > std::numeric_limits<std::uint32_t>::max()) {
    fail("more triangles than a binary STL file can hold; split the mesh");
  }
  for (const Vec3& v : vertices) {
    if (!(v.cwiseAbs().maxCoeff() <= double{std::numeric_limits<float>::max()})) {
      fail("a coordinate does not fit single precision, so STL cannot hold it");
    }
  }
  std::array<char, stl_header_size> header{};
  constexpr char text[] = "binary STL written by keepout";  // must not begin with "solid"
  std::memcpy(header.data(), text, sizeof text - 1);
  const auto count = static_cast<std::uint32_t>(triangles.size());
  FileReplacement file(path);
  file.write(header.data(), header.size());
  file.write(&count, sizeof count);
  write_records(file, vertices, triangles);
  if (const std::error_code error = file.commit()) {
    fail("cannot be written (" + error.message() +
         "); check the directory, its permissions and the space on the disk");
  }
}

}  // namespace

bool is_binary_stl(const std::filesystem::path& path) {
  const ReadOnlyFile file(path);
  return file.is_open() && declared_triangles(file).has_value();
}

Surface read_binary_stl(const std::filesystem::path& path) {
  const StlRecords records(path);
  Surface surface;
  surface.vertices.reserve(3 * records.count());
  surface.triangles.reserve(records.count());
  std::vector<char> buffer;
  for (std::size_t done = 0; done < records.count();) {
    const std::size_t now = std::min(records_at_once, records.count() - done);
    records.read(done, now, buffer);
    for (std::size_t i = 0; i < now; ++i, ++done) {
      if (!append(buffer.data() + i * stl_record_size, surface)) records.refuse(done);
    }
  }
  return surface;
}

Surface read_welded_stl(const std::filesystem::path& path, unsigned threads) {
  const StlRecords records(path);
  const auto make_reader = [&] {
    return [&, buffer = std::vector<char>()](std::size_t first, std::span<Corners> triangles,
                                             auto&& number) mutable {
      records.read(first, triangles.size(), buffer);
      for (std::size_t i = 0; i < triangles.size(); ++i) {
        const StlCorners c = stl_corners(buffer.data() + i * stl_record_size);
        if (!is_finite(c)) records.refuse(first + i);
        // -0 becomes 0
        triangles[i] = {number(ExactPoint<float>{c[0] + 0.0F, c[1] + 0.0F, c[2] + 0.0F}),
                        number(ExactPoint<float>{c[3] + 0.0F, c[4] + 0.0F, c[5] + 0.0F}),
                        number(ExactPoint<float>{c[6] + 0.0F, c[7] + 0.0F, c[8] + 0.0F})};
      }
    };
  };
  return weld_blocks<float>(vector_in_huge_pages<Corners>(records.count()),
                            threads == 0 ? processors() : threads, make_reader);
}

void write_binary_stl(const std::filesystem::path& path, const Surface& surface) {
  write(path, surface.vertices, surface.triangles);
}

void write_binary_stl(const std::filesystem::path& path, const Mesh& mesh) {
  write(path, mesh.vertices(), mesh.triangles());
}

}  // namespace keepout
