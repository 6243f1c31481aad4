// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/mesh/binary_stl.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "../file_replacement.h"
#include "../huge_pages.h"
#include "../read_only_file.h"
#include "keepout/error.h"
#include "mesh_file.h"
#include "weld_blocks.h"

namespace keepout {
namespace {

static_assert(std::endian::native == std::endian::little, "STL files are little-endian");

constexpr std::size_t preamble_size = stl_header_size + sizeof(std::uint32_t);

// A record is a normal, three corners and two bytes of attributes, without padding.
constexpr std::size_t record_size = 50;

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

/// The triangles that the header of a binary STL file declares, if its length agrees.
std::optional<std::uint32_t> declared_triangles(const ReadOnlyFile& file) {
  std::uint32_t count;
  if (!file.read(stl_header_size, &count, sizeof count)) return std::nullopt;
  if (file.size() != preamble_size + record_size * std::uint64_t{count}) return std::nullopt;
  return count;
}

/// The records of a binary STL file.
class StlRecords {
 public:
  explicit StlRecords(const std::filesystem::path& path) : path_(path), file_(path) {
    if (!file_.is_open()) fail("cannot be opened; check the name and the permissions");
    const std::optional<std::uint32_t> count = declared_triangles(file_);
    if (!count) {
      fail("not a binary STL file, or cut short: its length does not agree with its header");
    }
    if (*count == 0) fail("has no triangles; check the export");
    // Three vertices for each triangle must be countable.
    if (*count > no_triangle / 3) fail("has too many triangles to read; split or decimate it");
    count_ = *count;
  }

  std::size_t count() const noexcept { return count_; }

  /// Reads `count` records from `first` on, and calls visit(i, corners) for each.
  template <class Visit>
  void read(std::size_t first, std::size_t count, std::vector<char>& buffer,
            const Visit& visit) const {
    buffer.resize(count * record_size);
    if (!file_.read(preamble_size + record_size * std::uint64_t{first}, buffer.data(),
                    buffer.size())) {
      fail("cannot be read to its end; check the disk");
    }
    for (std::size_t i = 0; i < count; ++i) {
      const StlCorners corners = corners_of(buffer.data() + i * record_size);
      if (!is_finite(corners)) {
        fail("triangle " + std::to_string(first + i) +
             " has a coordinate that is not finite; repair the mesh and export it again");
      }
      visit(i, corners);
    }
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(path_.string() + ": " + what);
  }

  std::filesystem::path path_;
  ReadOnlyFile file_;
  std::size_t count_ = 0;
};

void write(const std::filesystem::path& path, std::span<const Vec3> vertices,
           std::span<const Corners> triangles) {
  BinaryStlWriter writer(path, triangles.size());
  for (const Corners& c : triangles) writer.write({vertices[c[0]], vertices[c[1]], vertices[c[2]]});
  writer.commit();
}

}  // namespace

bool is_binary_stl(const std::filesystem::path& path) {
  const ReadOnlyFile file(path);
  return file.is_open() && declared_triangles(file).has_value();
}

Surface read_binary_stl(const std::filesystem::path& path) {
  constexpr std::size_t at_once = 20'000;  // one megabyte
  const StlRecords records(path);
  Surface surface;
  surface.vertices.reserve(3 * records.count());
  surface.triangles.reserve(records.count());
  std::vector<char> buffer;
  for (std::size_t done = 0; done < records.count(); done += at_once) {
    const std::size_t now = std::min(at_once, records.count() - done);
    records.read(done, now, buffer, [&](std::size_t, const StlCorners& c) {
      const auto first = static_cast<VertexId>(surface.vertices.size());
      for (std::size_t i = 0; i < 9; i += 3) {
        surface.vertices.emplace_back(c[i], c[i + 1], c[i + 2]);
      }
      surface.triangles.push_back({first, first + 1, first + 2});
    });
  }
  return surface;
}

Surface read_welded_stl(const std::filesystem::path& path, unsigned threads) {
  const StlRecords records(path);
  const auto make_reader = [&] {
    return [&, buffer = std::vector<char>()](std::size_t first, std::span<Corners> triangles,
                                             auto&& number) mutable {
      records.read(first, triangles.size(), buffer, [&](std::size_t t, const StlCorners& c) {
        // -0 becomes 0
        triangles[t] = {number(ExactPoint<float>{c[0] + 0.0F, c[1] + 0.0F, c[2] + 0.0F}),
                        number(ExactPoint<float>{c[3] + 0.0F, c[4] + 0.0F, c[5] + 0.0F}),
                        number(ExactPoint<float>{c[6] + 0.0F, c[7] + 0.0F, c[8] + 0.0F})};
      });
    };
  };
  return weld_blocks<float>(vector_in_huge_pages<Corners>(records.count()), thread_count(threads),
                            make_reader);
}

void write_binary_stl(const std::filesystem::path& path, const Surface& surface) {
  write(path, surface.vertices, surface.triangles);
}

void write_binary_stl(const std::filesystem::path& path, const Mesh& mesh) {
  write(path, mesh.vertices(), mesh.triangles());
}

class BinaryStlWriter::File {
 public:
  explicit File(const std::filesystem::path& path) : name(path.string()), bytes(path) {}

  [[noreturn]] void fail(const std::string& what) const { throw Error(name + ": " + what); }

  std::string name;
  FileReplacement bytes;
};

BinaryStlWriter::BinaryStlWriter(const std::filesystem::path& path, std::uint64_t triangles)
    : file_(std::make_unique<File>(path)) {
  if (triangles > std::numeric_limits<std::uint32_t>::max()) {
    file_->fail("more triangles than a binary STL file can hold; split the mesh");
  }
  std::array<char, stl_header_size> header{};
  constexpr char text[] = "binary STL written by keepout";  // must not begin with "solid"
  std::memcpy(header.data(), text, sizeof text - 1);
  const auto count = static_cast<std::uint32_t>(triangles);
  file_->bytes.write(header.data(), header.size());
  file_->bytes.write(&count, sizeof count);
}

BinaryStlWriter::~BinaryStlWriter() = default;

void BinaryStlWriter::write(const Triangle& corners) {
  std::array<float, 12> values;
  std::size_t n = 0;
  for (const Vec3& v : {unit_normal(corners), corners[0], corners[1], corners[2]}) {
    if (!(v.cwiseAbs().maxCoeff() <= double{std::numeric_limits<float>::max()})) {
      file_->fail("a coordinate does not fit single precision, so STL cannot hold it");
    }
    for (const double x : v) values[n++] = static_cast<float>(x);
  }
  std::array<char, record_size> record{};
  std::memcpy(record.data(), values.data(), sizeof values);
  file_->bytes.write(record.data(), record.size());
}

void BinaryStlWriter::commit() {
  if (const std::error_code error = file_->bytes.commit()) {
    file_->fail("cannot be written (" + error.message() +
                "); check the directory, its permissions and the space on the disk");
  }
}

}  // namespace keepout
