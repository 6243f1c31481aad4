// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "../huge_pages.h"
#include "../parallel.h"
#include "binary_number.h"
#include "mesh_file.h"
#include "ply_header.h"
#include "polygons.h"
#include "text_lines.h"

namespace keepout {
namespace {

// The values after the header of a PLY file, one after another, as text and as bytes. Each function
// throws Error for a file that is damaged or truncated.

std::string cut_short(const PlyElement& element) {
  return "the file ends before its last " + in_quotes(element.name) +
         ", so it was cut short; copy or export it again";
}

/// The body as text: each line is an item, and its words are the values.
class PlyText {
 public:
  /// `lines` must be at the end of the header.
  explicit PlyText(TextLines& lines) : lines_(lines) {}

  /// Begins and ends the next item of an element.
  void begin_item(const PlyElement& element, std::uint64_t item) {
    element_ = &element;
    item_ = item;
    used_ = 0;
    if (!lines_.next()) fail(cut_short(element));
  }
  void end_item() const {
    if (used_ != lines_.words().size()) {
      const std::string name = in_quotes(element_->name);
      fail(std::to_string(lines_.words().size()) + " values, but by the header each " + name +
           " has " + std::to_string(used_) +
           ": the header lacks a property, or the file has only " + std::to_string(item_) +
           " of the " + std::to_string(element_->count) + " " + name + " that it declares");
    }
  }

  /// Returns the next value: a coordinate, or a length or an index.
  double take_real(const PlyScalar& type) {
    const bool is_single = !type.whole && type.size == sizeof(float);
    return is_single ? lines_.number<float>(take_word()) : lines_.coordinate(take_word());
  }
  std::uint64_t take_whole(const PlyScalar&) { return lines_.whole_number(take_word()); }

  /// Does nothing, because take_real() has checked each coordinate.
  void check_vertex(const Vec3&, std::uint64_t) const {}

  /// Skips `count` values. They must be numbers of any value.
  void skip(const PlyScalar&, std::uint64_t count) {
    for (std::uint64_t i = 0; i < count; ++i) lines_.number<double>(take_word());
  }

  /// Returns true if the file has more values.
  bool has_more() { return lines_.next(); }
  void warn_of_open_end(std::vector<std::string>& warnings) const {
    lines_.warn_of_open_end(last_number_lost, warnings);
  }

  /// Returns true if the coordinates must be rounded to floats.
  bool is_of_floats() const { return lines_.has_only_floats(); }

  [[noreturn]] void fail(const std::string& what) const { lines_.fail(what); }

 private:
  std::string_view take_word() {
    if (used_ == lines_.words().size()) {
      fail("fewer values than the header declares for a " + in_quotes(element_->name) +
           "; the file is damaged");
    }
    return lines_.words()[used_++];
  }

  TextLines& lines_;
  const PlyElement* element_ = nullptr;
  std::uint64_t item_ = 0;  // of the element
  std::size_t used_ = 0;
};

/// The body as bytes of either order, with the functions of PlyText.
class PlyBytes {
 public:
  /// `source` must outlive this object.
  PlyBytes(const MeshSource& source, const PlyHeader& header)
      : source_(source),
        swapped_((header.encoding == PlyEncoding::big_endian) !=
                 (std::endian::native == std::endian::big)),
        position_(header.size) {}

  void begin_item(const PlyElement& element, std::uint64_t item) {
    element_ = &element;
    item_ = item;
  }
  void end_item() const {}
  double take_real(const PlyScalar& type) { return real(take(type.size), type); }
  std::uint64_t take_whole(const PlyScalar& type) {
    const std::int64_t value = whole(take(type.size), type);
    if (value < 0) fail("a negative length or index; the file is damaged");
    return static_cast<std::uint64_t>(value);
  }
  void skip(const PlyScalar& type, std::uint64_t count) {
    if (count > left() / type.size) fail(cut_short(*element_));
    position_ += count * type.size;
  }
  bool has_more() const { return left() > 0; }
  void warn_of_open_end(std::vector<std::string>&) const {}
  bool is_of_floats() const { return false; }
  /// Throws Error with the present item before `what`.
  [[noreturn]] void fail(const std::string& what) const {
    source_.fail(in_quotes(element_->name) + " " + std::to_string(item_) + ": " + what);
  }

  void check_vertex(const Vec3& vertex, std::uint64_t v) const {
    if (vertex.allFinite()) return;
    source_.fail("vertex " + std::to_string(v) +
                 " has a coordinate that is not finite; repair the mesh and export it again");
  }

  // For items that have all the same size, and are read at once.

  /// Returns `size` bytes, starting `behind` bytes after the next one.
  std::vector<char> copy(std::uint64_t behind, std::size_t size) const {
    std::vector<char> bytes(size);
    source_.read(position_ + behind, bytes.data(), size);
    return bytes;
  }
  std::uint64_t left() const noexcept { return source_.size() - position_; }
  void move_on(std::uint64_t bytes) noexcept { position_ += bytes; }

  double real(const char* bytes, const PlyScalar& type) const noexcept {
    return real_at(bytes, type, swapped_);
  }
  std::int64_t whole(const char* bytes, const PlyScalar& type) const noexcept {
    return whole_at(bytes, type, swapped_);
  }

 private:
  /// Returns the next bytes, up to eight.
  const char* take(std::size_t size) {
    constexpr std::uint64_t at_once = std::uint64_t{1} << 20;
    if (size > left()) fail(cut_short(*element_));
    if (position_ < begin_ || position_ + size > begin_ + buffer_.size()) {
      begin_ = position_;
      buffer_.resize(static_cast<std::size_t>(std::min(at_once, left())));
      if (!source_.try_read(begin_, buffer_.data(), buffer_.size())) fail(cut_short(*element_));
    }
    const char* bytes = buffer_.data() + (position_ - begin_);
    position_ += size;
    return bytes;
  }

  const MeshSource& source_;
  bool swapped_;
  const PlyElement* element_ = nullptr;
  std::uint64_t item_ = 0;  // of the element
  std::uint64_t position_;
  std::uint64_t begin_ = 0;  // of the buffer, in the file
  std::vector<char> buffer_;
};

/// Returns the size of an item; nothing if it has lists. [bytes]
std::optional<std::size_t> fixed_size(std::span<const PlyProperty> properties) {
  std::size_t size = 0;
  for (const PlyProperty& p : properties) {
    if (p.is_list()) return std::nullopt;
    size += p.type->size;
  }
  return size;
}

/// Returns the offset of a property in an item without lists before it. [bytes]
std::size_t offset_of(const PlyElement& element, const PlyProperty* property) {
  const auto before = static_cast<std::size_t>(property - element.properties.data());
  return fixed_size(std::span(element.properties).first(before)).value_or(0);
}

/// Reads the surface from a body: PlyText, or PlyBytes. Most items of PlyBytes have one size, and
/// are read on all processors.
template <class Body>
class SurfaceReader {
 public:
  SurfaceReader(const PlyHeader& header, const PlyLayout& layout, Body body)
      : header_(header), layout_(layout), body_(std::move(body)) {}

  MeshFile read(const MeshSource& source) {
    for (const PlyElement& element : header_.elements) {
      if (element.properties.empty()) continue;
      if constexpr (std::is_same_v<Body, PlyBytes>) {
        if (read_at_once(element)) continue;
      }
      for (std::uint64_t i = 0; i < element.count; ++i) {
        body_.begin_item(element, i);
        read_item(element);
        body_.end_item();
      }
    }
    if (body_.is_of_floats()) mesh_.round_to_floats();
    polygons_.cut_into(mesh_, source);  // last, because vertices may come after faces
    if (body_.has_more()) {
      mesh_.warnings.push_back("there is more in the file than its header declares: left out");
    }
    body_.warn_of_open_end(mesh_.warnings);
    mesh_.comments = header_.comments;
    return std::move(mesh_);
  }

 private:
  void read_item(const PlyElement& element) {
    Vec3 vertex = Vec3::Zero();
    for (const PlyProperty& property : element.properties) {
      const auto axis = std::ranges::find(layout_.coordinates, &property);
      if (axis != layout_.coordinates.end()) {
        vertex[axis - layout_.coordinates.begin()] = body_.take_real(*property.type);
      } else if (&property == layout_.corners) {
        read_polygon();
      } else {
        body_.skip(*property.type, property.is_list() ? body_.take_whole(*property.count_type) : 1);
      }
    }
    if (&element != layout_.vertex) return;
    body_.check_vertex(vertex, mesh_.surface.vertices.size());
    mesh_.surface.vertices.push_back(vertex);
  }

  void read_polygon() {
    const std::uint64_t count = body_.take_whole(*layout_.corners->count_type);
    for (std::uint64_t c = 0; c < count; ++c) {
      polygons_.add_corner(body_.take_whole(*layout_.corners->type), layout_.vertex->count, body_);
    }
    polygons_.end_polygon();
  }

  /// Reads all items of an element if they have one size and are complete. Otherwise reads nothing
  /// and returns false.
  bool read_at_once(const PlyElement& element) {
    if (&element == layout_.face && layout_.corners != nullptr) return read_triangles(element);
    const std::optional<std::size_t> size = fixed_size(element.properties);
    if (!size || element.count > body_.left() / *size) return false;
    if (&element == layout_.vertex) read_vertices(element, *size);
    body_.move_on(element.count * *size);
    return true;
  }

  void read_vertices(const PlyElement& element, std::size_t size) {
    std::array<std::size_t, 3> offsets;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      offsets[axis] = offset_of(element, layout_.coordinates[axis]);
    }
    const auto count = static_cast<std::size_t>(element.count);
    mesh_.surface.vertices = vector_in_huge_pages<Vec3>(count);
    share_ranges(count, processors(), [&](std::size_t begin, std::size_t end) {
      const std::vector<char> items = body_.copy(begin * size, (end - begin) * size);
      const char* item = items.data();
      for (std::size_t v = begin; v < end; ++v, item += size) {
        Vec3 vertex;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          vertex[static_cast<Eigen::Index>(axis)] =
              body_.real(item + offsets[axis], *layout_.coordinates[axis]->type);
        }
        body_.check_vertex(vertex, v);
        mesh_.surface.vertices[v] = vertex;
      }
    });
  }

  /// Like read_at_once(), for faces that are all valid triangles.
  bool read_triangles(const PlyElement& element) {
    const PlyScalar& count_type = *layout_.corners->count_type;
    const PlyScalar& corner_type = *layout_.corners->type;
    std::size_t size = count_type.size + 3 * corner_type.size;
    for (const PlyProperty& p : element.properties) {
      if (&p == layout_.corners) continue;
      if (p.is_list()) return false;
      size += p.type->size;
    }
    if (element.count > body_.left() / size || element.count > no_triangle / 3) return false;
    const std::size_t list = offset_of(element, layout_.corners);
    auto triangles = vector_in_huge_pages<Corners>(static_cast<std::size_t>(element.count));
    std::atomic<bool> good = true;
    share_ranges(triangles.size(), processors(), [&](std::size_t begin, std::size_t end) {
      if (!good) return;
      const std::vector<char> items = body_.copy(begin * size, (end - begin) * size);
      const char* place = items.data() + list;
      bool all_good = true;
      for (std::size_t t = begin; t < end; ++t, place += size) {
        all_good &= body_.whole(place, count_type) == 3;
        for (std::size_t i = 0; i < 3; ++i) {
          const auto vertex = static_cast<std::uint64_t>(
              body_.whole(place + count_type.size + i * corner_type.size, corner_type));
          all_good &= vertex < layout_.vertex->count;
          triangles[t][i] = static_cast<VertexId>(vertex);
        }
      }
      if (!all_good) good = false;
    });
    if (!good) return false;
    mesh_.surface.triangles = std::move(triangles);
    body_.move_on(element.count * size);
    return true;
  }

  const PlyHeader& header_;
  const PlyLayout& layout_;
  Body body_;
  Polygons polygons_;
  MeshFile mesh_;
};

}  // namespace

MeshFile read_ply(const MeshSource& source) {
  const PlyHeader header = read_ply_header(source);
  const PlyLayout layout = find_ply_layout(header, source);
  if (header.encoding != PlyEncoding::text) {
    return SurfaceReader(header, layout, PlyBytes(source, header)).read(source);
  }
  TextLines lines(source);
  while (lines.position() < header.size && lines.next()) continue;
  return SurfaceReader(header, layout, PlyText(lines)).read(source);
}

}  // namespace keepout
