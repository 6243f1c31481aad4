// SPDX-License-Identifier: BSD-3-Clause
#include <atomic>
#include <optional>
#include <span>
#include <type_traits>
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

/// Takes the surface out of a body: PlyText, or PlyBytes, whose items are mostly of one size and
/// are then read on all processors.
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
        body_.begin_item(element);
        read_item(element);
        body_.end_item();
      }
    }
    if (body_.is_of_floats()) mesh_.round_to_floats();
    polygons_.cut_into(mesh_, source);  // only now: the vertices may stand after the faces
    if (body_.has_more()) {
      mesh_.warnings.push_back("there is more in the file than its header declares: left out");
    }
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
    check_vertex(vertex, mesh_.surface.vertices.size());
    mesh_.surface.vertices.push_back(vertex);
  }

  void read_polygon() {
    const std::uint64_t count = body_.take_whole(*layout_.corners->count_type);
    for (std::uint64_t c = 0; c < count; ++c) {
      polygons_.add_corner(body_.take_whole(*layout_.corners->type), layout_.vertex->count, body_);
    }
    polygons_.end_polygon();
  }

  void check_vertex(const Vec3& vertex, std::uint64_t v) const {
    if (vertex.allFinite()) return;
    body_.fail("vertex " + std::to_string(v) +
               " has a coordinate that is not finite; repair the mesh and export it again");
  }

  /// All items of an element, if they are of one size and all there; else nothing, and false.
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
    mesh_.surface.vertices = vector_in_huge_pages<Vec3>(element.count);
    share_ranges(element.count, processors(), [&](std::size_t begin, std::size_t end) {
      const std::vector<char> items = body_.copy(begin * size, (end - begin) * size);
      const char* item = items.data();
      for (std::size_t v = begin; v < end; ++v, item += size) {
        Vec3 vertex;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          vertex[static_cast<Eigen::Index>(axis)] =
              body_.real(item + offsets[axis], *layout_.coordinates[axis]->type);
        }
        check_vertex(vertex, v);
        mesh_.surface.vertices[v] = vertex;
      }
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
    if (element.count > body_.left() / size || element.count > no_triangle / 3) return false;
    const std::size_t list = offset_of(element, layout_.corners);
    auto triangles = vector_in_huge_pages<Corners>(element.count);
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
