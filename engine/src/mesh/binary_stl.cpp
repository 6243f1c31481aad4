// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause

#include "keepout/mesh/binary_stl.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <string>

#include "keepout/error.h"

namespace keepout {
namespace {

static_assert(std::endian::native == std::endian::little, "STL files are little-endian");

constexpr std::size_t header_size = 80;
constexpr std::size_t preamble_size = header_size + sizeof(std::uint32_t);

// A record is a normal, three corners and two bytes of attributes, without padding.
constexpr std::size_t record_size = 50;
constexpr std::size_t corners_offset = 12;
constexpr std::size_t records_at_once = 20'000;  // one megabyte

using RecordCorners = std::array<float, 9>;

/// The triangles that the header declares, if the length of the file agrees.
std::optional<std::uint32_t> declared_triangles(std::ifstream& file, std::uintmax_t size) {
  std::array<char, preamble_size> preamble;
  if (!file.read(preamble.data(), preamble.size())) return std::nullopt;
  std::uint32_t count;
  std::memcpy(&count, preamble.data() + header_size, sizeof count);
  if (size != preamble_size + record_size * std::uintmax_t{count}) return std::nullopt;
  return count;
}

/// Appends the triangle of one record; false if a coordinate is not finite.
bool append(const char* record, Surface& surface) {
  RecordCorners c;
  std::memcpy(c.data(), record + corners_offset, sizeof c);
  bool finite = true;
  for (const float x : c) finite &= std::isfinite(x);
  const auto first = static_cast<VertexId>(surface.vertices.size());
  surface.vertices.emplace_back(c[0], c[1], c[2]);
  surface.vertices.emplace_back(c[3], c[4], c[5]);
  surface.vertices.emplace_back(c[6], c[7], c[8]);
  surface.triangles.push_back({first, first + 1, first + 2});
  return finite;
}

/// A name beside the file that no other writer will choose.
std::filesystem::path temporary_beside(const std::filesystem::path& path) {
  std::random_device random;
  std::filesystem::path temporary = path;
  temporary += std::to_string(random());
  temporary += ".part";
  return temporary;
}

void write_records(std::ofstream& file, std::span<const Vec3> vertices,
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
    std::array<char, record_size> record{};
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
  const std::filesystem::path temporary = temporary_beside(path);
  std::ofstream file(temporary, std::ios::binary | std::ios::trunc);
  std::array<char, header_size> header{};
  constexpr char text[] = "binary STL written by keepout";  // must not begin with "solid"
  std::memcpy(header.data(), text, sizeof text - 1);
  const auto count = static_cast<std::uint32_t>(triangles.size());
  file.write(header.data(), header.size());
  file.write(reinterpret_cast<const char*>(&count), sizeof count);
  write_records(file, vertices, triangles);
  file.close();
  std::error_code error;
  if (file) std::filesystem::rename(temporary, path, error);
  if (!file || error) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    fail("cannot be written; check the directory, its permissions and the space on the disk");
  }
}

}  // namespace

bool is_binary_stl(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return false;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) return false;
  std::ifstream file(path, std::ios::binary);
  return declared_triangles(file, size).has_value();
}

Surface read_binary_stl(const std::filesystem::path& path) {
  const auto fail = [&](const std::string& what) { throw Error(path.string() + ": " + what); };
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  std::ifstream file(path, std::ios::binary);
  if (error || !file) fail("cannot be opened; check the name and the permissions");
  const std::optional<std::uint32_t> count = declared_triangles(file, size);
  if (!count) {
    fail("not a binary STL file, or cut short: its length does not agree with its header");
  }
  if (*count == 0) fail("has no triangles; check the export");
  // Three vertices for each triangle must be countable.
  if (*count > no_triangle / 3) fail("has too many triangles to read; split or decimate it");

  Surface surface;
  surface.vertices.reserve(3 * std::size_t{*count});
  surface.triangles.reserve(*count);
  const auto buffer = std::make_unique_for_overwrite<char[]>(records_at_once * record_size);
  for (std::size_t done = 0; done < *count;) {
    const std::size_t records = std::min(records_at_once, *count - done);
    if (!file.read(buffer.get(), static_cast<std::streamsize>(records * record_size))) {
      fail("cannot be read to its end; check the disk");
    }
    for (std::size_t i = 0; i < records; ++i, ++done) {
      if (!append(buffer.get() + i * record_size, surface)) {
        fail("triangle " + std::to_string(done) +
             " has a coordinate that is not finite; repair the mesh and export it again");
      }
    }
  }
  return surface;
}

void write_binary_stl(const std::filesystem::path& path, const Surface& surface) {
  write(path, surface.vertices, surface.triangles);
}

void write_binary_stl(const std::filesystem::path& path, const Mesh& mesh) {
  write(path, mesh.vertices(), mesh.triangles());
}

}  // namespace keepout
