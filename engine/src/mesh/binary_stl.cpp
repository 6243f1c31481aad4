// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/mesh/binary_stl.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <ostream>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "../huge_pages.h"
#include "keepout/error.h"
#include "keepout/file_replacement.h"
#include "mesh_file.h"
#include "weld_blocks.h"

namespace keepout {
namespace {

static_assert(std::endian::native == std::endian::little, "STL files are little-endian");

using StlCorners = std::array<float, 9>;

StlCorners corners_of(const char* record) noexcept {
  constexpr std::size_t after_the_normal = 12;
  StlCorners corners;
  std::memcpy(corners.data(), record + after_the_normal, sizeof corners);
  return corners;
}

bool is_finite(const StlCorners& corners) noexcept {
  bool finite = true;
  for (const float x : corners) finite &= std::abs(x) <= std::numeric_limits<float>::max();
  return finite;
}

}  // namespace

std::optional<Surface> read_binary_stl(const MeshSource& source, unsigned threads) {
  std::uint32_t count;
  if (!source.try_read(stl_header_size, &count, sizeof count)) return std::nullopt;
  if (source.size() != stl_preamble_size + stl_record_size * std::uint64_t{count}) {
    return std::nullopt;
  }
  if (count == 0) source.fail("has no triangles; check the export");
  // Three vertices for each triangle must have numbers.
  if (count > no_triangle / 3) source.fail("has too many triangles to read; split or decimate it");
  const auto make_reader = [&] {
    return [&source, records = std::vector<char>()](std::size_t first, std::span<Corners> triangles,
                                                    auto&& number) mutable {
      records.resize(triangles.size() * stl_record_size);
      source.read(stl_preamble_size + stl_record_size * std::uint64_t{first}, records.data(),
                  records.size());
      for (std::size_t t = 0; t < triangles.size(); ++t) {
        const StlCorners c = corners_of(records.data() + t * stl_record_size);
        if (!is_finite(c)) {
          source.fail("triangle " + std::to_string(first + t) +
                      " has a coordinate that is not finite; repair the mesh and export it again");
        }
        // -0 becomes 0
        triangles[t] = {number(ExactPoint<float>{c[0] + 0.0F, c[1] + 0.0F, c[2] + 0.0F}),
                        number(ExactPoint<float>{c[3] + 0.0F, c[4] + 0.0F, c[5] + 0.0F}),
                        number(ExactPoint<float>{c[6] + 0.0F, c[7] + 0.0F, c[8] + 0.0F})};
      }
    };
  };
  return weld_blocks<float>(vector_in_huge_pages<Corners>(count), thread_count(threads),
                            make_reader);
}

namespace {

/// Returns the beginning of an error about a file; empty if the file has no name.
std::string prefix_of(const std::filesystem::path& path) {
  return path.empty() ? "" : path.string() + ": ";
}

/// Returns a function that reads triangles of a surface, and throws Error if one has a vertex that
/// does not exist.
auto reader_of(const Surface& surface, std::string prefix) {
  return [&surface, prefix = std::move(prefix)](std::uint64_t t) -> Triangle {
    const Corners& c = surface.triangles[static_cast<std::size_t>(t)];
    for (const VertexId v : c) {
      if (v >= surface.vertices.size()) {
        throw Error(prefix + "triangle " + std::to_string(t) + " names vertex " +
                    std::to_string(v) + ", but there are only " +
                    std::to_string(surface.vertices.size()) + ": add the missing vertices");
      }
    }
    return {surface.vertices[c[0]], surface.vertices[c[1]], surface.vertices[c[2]]};
  };
}

/// Calls write(bytes, size) with one piece of the file after another.
template <class Write>
void print_binary_stl(const Write& write, const std::string& prefix, AnatomicalSpace space,
                      std::uint64_t triangles,
                      const std::function<Triangle(std::uint64_t)>& triangle) {
  if (triangles > std::numeric_limits<std::uint32_t>::max()) {
    throw Error(prefix + "more triangles than a binary STL file can hold; split the mesh");
  }
  std::string header = "binary STL written by keepout";  // must not begin with "solid"
  if (space != AnatomicalSpace::unstated) header += ". SPACE=" + std::string(name(space));
  header.resize(stl_header_size, '\0');
  write(header.data(), header.size());
  const auto count = static_cast<std::uint32_t>(triangles);
  write(&count, sizeof count);
  for (std::uint64_t t = 0; t < triangles; ++t) {
    const Triangle corners = triangle(t);
    std::array<float, 12> values;
    std::size_t n = 0;
    for (const Vec3& v : {unit_normal(corners), corners[0], corners[1], corners[2]}) {
      if (!(v.cwiseAbs().maxCoeff() <= double{std::numeric_limits<float>::max()})) {
        throw Error(prefix + "a coordinate does not fit single precision, so STL cannot hold it");
      }
      for (const double x : v) values[n++] = static_cast<float>(x);
    }
    std::array<char, stl_record_size> record{};
    std::memcpy(record.data(), values.data(), sizeof values);
    write(record.data(), record.size());
  }
}

}  // namespace

void write_binary_stl(const std::filesystem::path& path, const Surface& surface) {
  write_binary_stl(path, surface.triangles.size(), reader_of(surface, prefix_of(path)));
}

void write_binary_stl(const std::filesystem::path& path, std::uint64_t triangles,
                      const std::function<Triangle(std::uint64_t)>& triangle) {
  FileReplacement file(path);
  const auto write = [&](const void* bytes, std::size_t size) { file.write(bytes, size); };
  print_binary_stl(write, prefix_of(path), AnatomicalSpace::unstated, triangles, triangle);
  if (const std::error_code error = file.commit()) {
    throw Error(prefix_of(path) + "cannot be written (" + error.message() +
                "); check the directory, its permissions and the space on the disk");
  }
}

void write_binary_stl(std::ostream& out, const Surface& surface, AnatomicalSpace space) {
  const auto write = [&](const void* bytes, std::size_t size) {
    out.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(size));
  };
  print_binary_stl(write, "", space, surface.triangles.size(), reader_of(surface, ""));
}

}  // namespace keepout
