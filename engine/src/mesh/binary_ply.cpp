// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/mesh/binary_ply.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include "../huge_pages.h"
#include "../parallel.h"
#include "../read_only_file.h"
#include "keepout/error.h"
#include "ply_bytes.h"
#include "polygon.h"

namespace keepout {
namespace {

/// The bytes of a file, one value after the other.
class Cursor {
 public:
  Cursor(const ReadOnlyFile& file, std::uint64_t position) : file_(file), position_(position) {}

  std::uint64_t position() const noexcept { return position_; }
  std::uint64_t left() const noexcept { return file_.size() - position_; }

  /// The next bytes, up to eight; null if there are not so many.
  const char* take(std::size_t size) {
    if (size > left()) return nullptr;
    if (position_ < begin_ || position_ + size > begin_ + buffer_.size()) {
      begin_ = position_;
      buffer_.resize(std::min<std::uint64_t>(at_once, left()));
      if (!file_.read(begin_, buffer_.data(), buffer_.size())) return nullptr;
    }
    const char* bytes = buffer_.data() + (position_ - begin_);
    position_ += size;
    return bytes;
  }

  /// Passes over bytes; false if there are not so many.
  bool skip(std::uint64_t count, std::size_t size) noexcept {
    if (count > left() / size) return false;
    position_ += count * size;
    return true;
  }

 private:
  static constexpr std::size_t at_once = std::size_t{1} << 20;

  const ReadOnlyFile& file_;
  std::uint64_t position_;
  std::uint64_t begin_ = 0;  // of the buffer, in the file
  std::vector<char> buffer_;
};

/// How many bytes an instance takes; nothing if it has lists.
std::optional<std::size_t> fixed_size(std::span<const PlyProperty> properties) {
  std::size_t size = 0;
  for (const PlyProperty& p : properties) {
    if (p.is_list()) return std::nullopt;
    size += p.type->size;
  }
  return size;
}

class Reader {
 public:
  Reader(const std::filesystem::path& path, const PlyHeader& header)
      : name_(path.string()),
        header_(header),
        layout_(find_ply_layout(header, name_)),
        bytes_(header.encoding),
        file_(path),
        cursor_(file_, header.size) {}

  PlySurface read() {
    if (!file_.is_open()) fail("cannot be opened; check the name and the permissions");
    if (file_.size() < header_.size) fail("was changed while it was read; read it again");
    if (layout_.vertex->count >= no_triangle) fail_too_many();
    for (const PlyElement& element : header_.elements) {
      if (element.properties.empty()) continue;
      if (&element == layout_.vertex) {
        read_vertices();
      } else if (&element == layout_.face && element.count > 0) {
        if (!read_triangles()) read_polygons();
      } else {
        skip(element);
      }
    }
    cut_polygons();
    if (surface_.triangles.empty()) {
      fail("has no faces, only points or lines; a surface must be made of them first");
    }
    if (cursor_.left() > 0) {
      warnings_.push_back("there is more in the file than its header declares: left out");
    }
    if (dropped_ > 0) {
      warnings_.push_back("left out " + std::to_string(dropped_) +
                          " faces with fewer than three corners");
    }
    return {std::move(surface_), std::move(warnings_)};
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw Error(name_ + ": " + what); }
  [[noreturn]] void fail_cut_short(const PlyElement& element) const {
    fail("the file ends before its last " + element.name +
         ", so it was cut short; copy or export it again");
  }
  [[noreturn]] void fail_too_many() const {
    fail("has too many triangles to read; split or decimate it");
  }

  const char* take(const PlyScalar& type, const PlyElement& of) {
    const char* bytes = cursor_.take(type.size);
    if (bytes == nullptr) fail_cut_short(of);
    return bytes;
  }

  /// A length or an index.
  std::uint64_t take_whole(const PlyScalar& type, const PlyElement& of) {
    const std::int64_t value = bytes_.whole(take(type, of), type);
    if (value < 0) fail("a negative length or index at a " + of.name + "; the file is damaged");
    return static_cast<std::uint64_t>(value);
  }

  // The values of other properties are no concern of ours, however odd; only their room is.

  void skip(const PlyProperty& property, const PlyElement& of) {
    const std::uint64_t count = property.is_list() ? take_whole(*property.count_type, of) : 1;
    if (!cursor_.skip(count, property.type->size)) fail_cut_short(of);
  }

  void skip(const PlyElement& element) {
    if (const auto size = fixed_size(element.properties)) {
      if (!cursor_.skip(element.count, *size)) fail_cut_short(element);
      return;
    }
    for (std::uint64_t i = 0; i < element.count; ++i) {
      for (const PlyProperty& property : element.properties) skip(property, element);
    }
  }

  void set_vertex(std::uint64_t v, const Vec3& vertex) {
    if (!vertex.allFinite()) {
      fail("vertex " + std::to_string(v) +
           " has a coordinate that is not finite; repair the mesh and export it again");
    }
    surface_.vertices[v] = vertex;
  }

  void read_vertices() {
    const PlyElement& element = *layout_.vertex;
    const std::optional<std::size_t> size = fixed_size(element.properties);
    // The least that they take must be there before memory is asked for.
    if (element.count > cursor_.left() / size.value_or(3)) fail_cut_short(element);
    surface_.vertices = vector_in_huge_pages<Vec3>(element.count);
    if (size) {
      read_vertices_of(*size);
      cursor_.skip(element.count, *size);
      return;
    }
    for (std::uint64_t v = 0; v < element.count; ++v) {
      Vec3 vertex;
      for (const PlyProperty& property : element.properties) {
        const auto axis =
            std::find(layout_.coordinates.begin(), layout_.coordinates.end(), &property);
        if (axis == layout_.coordinates.end()) {
          skip(property, element);
        } else {
          vertex[axis - layout_.coordinates.begin()] =
              bytes_.real(take(*property.type, element), *property.type);
        }
      }
      set_vertex(v, vertex);
    }
  }

  /// Where a property is in an instance without lists before it.
  static std::size_t offset_of(const PlyElement& element, const PlyProperty* property) {
    const auto before = static_cast<std::size_t>(property - element.properties.data());
    return fixed_size(std::span(element.properties).first(before)).value_or(0);
  }

  /// All vertices, each of `size` bytes, on all processors.
  void read_vertices_of(std::size_t size) {
    std::array<std::size_t, 3> offsets;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      offsets[axis] = offset_of(*layout_.vertex, layout_.coordinates[axis]);
    }
    const std::uint64_t begin_of_all = cursor_.position();
    share_ranges(surface_.vertices.size(), processors(), [&](std::size_t begin, std::size_t end) {
      std::vector<char> instances((end - begin) * size);
      if (!file_.read(begin_of_all + begin * size, instances.data(), instances.size())) {
        fail("cannot be read to its end; check the disk");
      }
      const char* instance = instances.data();
      for (std::size_t v = begin; v < end; ++v, instance += size) {
        Vec3 vertex;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          vertex[static_cast<Eigen::Index>(axis)] =
              bytes_.real(instance + offsets[axis], *layout_.coordinates[axis]->type);
        }
        set_vertex(v, vertex);
      }
    });
  }

  /// The faces, on all processors, if all are triangles and nothing is wrong with them; else the
  /// cursor stays where it is, and false.
  bool read_triangles() {
    const PlyElement& element = *layout_.face;
    if (element.count > no_triangle / 3) fail_too_many();
    const PlyScalar& count_type = *layout_.corners->count_type;
    const PlyScalar& corner_type = *layout_.corners->type;
    std::size_t size = count_type.size + 3 * corner_type.size;
    for (const PlyProperty& p : element.properties) {
      if (&p == layout_.corners) continue;
      if (p.is_list()) return false;
      size += p.type->size;
    }
    if (element.count > cursor_.left() / size) return false;
    const std::size_t list = offset_of(element, layout_.corners);
    auto triangles = vector_in_huge_pages<Corners>(element.count);
    std::atomic<bool> good = true;
    share_ranges(triangles.size(), processors(), [&](std::size_t begin, std::size_t end) {
      if (!good) return;
      std::vector<char> instances((end - begin) * size);
      bool all_good =
          file_.read(cursor_.position() + begin * size, instances.data(), instances.size());
      const char* place = instances.data() + list;
      for (std::size_t t = begin; t < end; ++t, place += size) {
        all_good &= bytes_.whole(place, count_type) == 3;
        for (std::size_t i = 0; i < 3; ++i) {
          const auto vertex = static_cast<std::uint64_t>(
              bytes_.whole(place + count_type.size + i * corner_type.size, corner_type));
          all_good &= vertex < layout_.vertex->count;
          triangles[t][i] = static_cast<VertexId>(vertex);
        }
      }
      if (!all_good) good = false;
    });
    if (!good) return false;
    surface_.triangles = std::move(triangles);
    cursor_.skip(element.count, size);
    return true;
  }

  /// The faces, whatever they are.
  void read_polygons() {
    const PlyElement& element = *layout_.face;
    for (std::uint64_t f = 0; f < element.count; ++f) {
      for (const PlyProperty& property : element.properties) {
        if (&property == layout_.corners) {
          read_polygon(element);
        } else {
          skip(property, element);
        }
      }
    }
  }

  void read_polygon(const PlyElement& element) {
    const std::uint64_t count = take_whole(*layout_.corners->count_type, element);
    if (count > cursor_.left() / layout_.corners->type->size) fail_cut_short(element);
    const std::size_t first = corners_.size();
    for (std::uint64_t c = 0; c < count; ++c) {
      const std::uint64_t vertex = take_whole(*layout_.corners->type, element);
      if (vertex >= layout_.vertex->count) {
        fail("a face names vertex " + std::to_string(vertex) + ", but there are only " +
             std::to_string(layout_.vertex->count) + "; the file is damaged");
      }
      corners_.push_back(static_cast<VertexId>(vertex));
    }
    if (count < 3) {
      corners_.resize(first);
      ++dropped_;
    } else {
      ends_.push_back(corners_.size());
    }
  }

  /// Only now: the vertices may stand after the faces.
  void cut_polygons() {
    if (corners_.size() - 2 * ends_.size() > no_triangle / 3) fail_too_many();
    std::size_t begin = 0;
    for (const std::size_t end : ends_) {
      const auto polygon = std::span(corners_).subspan(begin, end - begin);
      if (!cut_polygon(polygon, surface_.vertices, surface_.triangles)) {
        fail("a face of " + std::to_string(polygon.size()) +
             " corners that is not convex; export the mesh as triangles");
      }
      begin = end;
    }
  }

  std::string name_;
  const PlyHeader& header_;
  PlyLayout layout_;
  PlyBytes bytes_;
  ReadOnlyFile file_;
  Cursor cursor_;
  Surface surface_;
  std::vector<VertexId> corners_;  // of polygons, one after the other
  std::vector<std::size_t> ends_;  // of each in them
  std::uint64_t dropped_ = 0;
  std::vector<std::string> warnings_;
};

}  // namespace

PlySurface read_binary_ply(const std::filesystem::path& path, const PlyHeader& header) {
  return Reader(path, header).read();
}

}  // namespace keepout
