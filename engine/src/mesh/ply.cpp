// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include <atomic>
#include <optional>
#include <span>
#include <utility>

#include "../huge_pages.h"
#include "../parallel.h"
#include "ply_body.h"
#include "polygons.h"

namespace keepout {
namespace {

/// How many bytes an item takes; nothing if it has lists.
std::optional<std::size_t> fixed_size(std::span<const PlyProperty> properties) {
  std::size_t size = 0;
  for (const PlyProperty& p : properties) {
    if (p.is_list()) return std::nullopt;
    size += p.type->size;
  }
  return size;
}

/// Where a property is in an item without lists before it.
std::size_t offset_of(const PlyElement& element, const PlyProperty* property) {
  const auto before = static_cast<std::size_t>(property - element.properties.data());
  return fixed_size(std::span(element.properties).first(before)).value_or(0);
}

void check_vertex(const Vec3& vertex, std::uint64_t v, const PlyBody& body) {
  if (vertex.allFinite()) return;
  body.fail("vertex " + std::to_string(v) +
            " has a coordinate that is not finite; repair the mesh and export it again");
}

/// Takes the surface out of a body.
class SurfaceReader {
 public:
  SurfaceReader(const PlyHeader& header, const PlyLayout& layout, PlyBody& body)
      : header_(header), layout_(layout), body_(body) {}
  virtual ~SurfaceReader() = default;

  MeshFile read(const std::string& file) {
    for (const PlyElement& element : header_.elements) {
      if (element.properties.empty() || read_at_once(element)) continue;
      for (std::uint64_t i = 0; i < element.count; ++i) {
        body_.begin_item(element);
        read_item(element);
        body_.end_item();
      }
    }
    if (body_.is_of_floats()) mesh_.round_to_floats();
    polygons_.cut_into(mesh_, file);  // only now: the vertices may stand after the faces
    if (body_.has_more()) {
      mesh_.warnings.push_back("there is more in the file than its header declares: left out");
    }
    mesh_.comments = header_.comments;
    return std::move(mesh_);
  }

 protected:
  /// All items of an element, if there is a quick way; else nothing, and false.
  virtual bool read_at_once(const PlyElement&) { return false; }

  const PlyHeader& header_;
  const PlyLayout& layout_;
  MeshFile mesh_;

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
    check_vertex(vertex, mesh_.surface.vertices.size(), body_);
    mesh_.surface.vertices.push_back(vertex);
  }

  void read_polygon() {
    const std::uint64_t count = body_.take_whole(*layout_.corners->count_type);
    for (std::uint64_t c = 0; c < count; ++c) {
      const std::uint64_t vertex = body_.take_whole(*layout_.corners->type);
      if (vertex >= layout_.vertex->count) {
        body_.fail("a face names vertex " + std::to_string(vertex) + ", but there are only " +
                   std::to_string(layout_.vertex->count) + "; the file is damaged");
      }
      polygons_.add_corner(static_cast<VertexId>(vertex));
    }
    polygons_.end_polygon();
  }

  PlyBody& body_;
  Polygons polygons_;
};

/// The same of a binary file, whose items are mostly of one size: these are read on all processors.
class BinaryReader final : public SurfaceReader {
 public:
  BinaryReader(const PlyHeader& header, const PlyLayout& layout, PlyBytes& bytes,
               const ReadOnlyFile& file)
      : SurfaceReader(header, layout, bytes), bytes_(bytes), file_(file) {}

 private:
  bool read_at_once(const PlyElement& element) override {
    if (&element == layout_.face && layout_.corners != nullptr) return read_triangles(element);
    const std::optional<std::size_t> size = fixed_size(element.properties);
    // Where they are not all there, they are read one by one, up to the first that is not.
    if (!size || element.count > bytes_.left() / *size) return false;
    if (&element == layout_.vertex) read_vertices(element, *size);
    bytes_.move_on(element.count * *size);
    return true;
  }

  /// Calls read(i, bytes) for each item on, each of `size` bytes.
  template <class Read>
  void share_items(const PlyElement& element, std::size_t size, const Read& read) const {
    share_ranges(element.count, processors(), [&](std::size_t begin, std::size_t end) {
      std::vector<char> items((end - begin) * size);
      if (!file_.read(bytes_.position() + begin * size, items.data(), items.size())) {
        bytes_.fail("cannot be read to its end; check the disk");
      }
      for (std::size_t i = begin; i < end; ++i) read(i, items.data() + (i - begin) * size);
    });
  }

  void read_vertices(const PlyElement& element, std::size_t size) {
    std::array<std::size_t, 3> offsets;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      offsets[axis] = offset_of(element, layout_.coordinates[axis]);
    }
    mesh_.surface.vertices = vector_in_huge_pages<Vec3>(element.count);
    share_items(element, size, [&](std::size_t v, const char* item) {
      Vec3& vertex = mesh_.surface.vertices[v];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        vertex[static_cast<Eigen::Index>(axis)] =
            bytes_.real(item + offsets[axis], *layout_.coordinates[axis]->type);
      }
      check_vertex(vertex, v, bytes_);
    });
  }

  /// If all faces are triangles and nothing is wrong with them.
  bool read_triangles(const PlyElement& element) {
    const PlyScalar& count_type = *layout_.corners->count_type;
    const PlyScalar& corner_type = *layout_.corners->type;
    std::size_t size = count_type.size + 3 * corner_type.size;
    for (const PlyProperty& p : element.properties) {
      if (&p == layout_.corners) continue;
      if (p.is_list()) return false;
      size += p.type->size;
    }
    if (element.count > bytes_.left() / size || element.count > no_triangle / 3) return false;
    const std::size_t list = offset_of(element, layout_.corners);
    auto triangles = vector_in_huge_pages<Corners>(element.count);
    std::atomic<bool> good = true;
    share_items(element, size, [&](std::size_t t, const char* item) {
      if (!good.load(std::memory_order_relaxed)) return;
      const char* place = item + list;
      bool is_good = bytes_.whole(place, count_type) == 3;
      for (std::size_t i = 0; i < 3; ++i) {
        const auto vertex = static_cast<std::uint64_t>(
            bytes_.whole(place + count_type.size + i * corner_type.size, corner_type));
        is_good &= vertex < layout_.vertex->count;
        triangles[t][i] = static_cast<VertexId>(vertex);
      }
      if (!is_good) good.store(false, std::memory_order_relaxed);
    });
    if (!good) return false;
    mesh_.surface.triangles = std::move(triangles);
    bytes_.move_on(element.count * size);
    return true;
  }

  PlyBytes& bytes_;
  const ReadOnlyFile& file_;
};

}  // namespace

MeshFile read_ply(const std::filesystem::path& path) {
  const std::string name = path.string();
  const PlyHeader header = read_ply_header(path);
  const PlyLayout layout = find_ply_layout(header, name);
  if (header.encoding != PlyEncoding::text) {
    const ReadOnlyFile file(path);
    PlyBytes bytes(file, name, header);
    return BinaryReader(header, layout, bytes, file).read(name);
  }
  const std::string contents = contents_of(path);
  TextLines lines(contents, name);
  while (lines.position() < header.size && lines.next()) continue;
  PlyText text(lines);
  return SurfaceReader(header, layout, text).read(name);
}

}  // namespace keepout
