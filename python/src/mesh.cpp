// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/mesh/mesh.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <array>
#include <optional>
#include <sstream>
#include <string>
#include <utility>

#include "arrays.h"
#include "bindings.h"
#include "keepout/index/pd_tree.h"
#include "keepout/index/self_intersection.h"
#include "keepout/mesh/diagnostics.h"

namespace keepout::python {
namespace {

using Ids = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>;

std::vector<Corners> triangles_from(py::handle argument, std::size_t vertices) {
  const py::array given = numbers(argument, {"triangles", {any, 3}, "(m, 3)"});
  if (given.size() > 0 && given.dtype().kind() == 'f') {
    refuse("triangles", "integers, the numbers of vertices from 0",
           "an array of dtype " + dtype_text(given));
  }
  const auto ids = converted<Ids>(given, "triangles", "integers of at most 64 bits");
  std::vector<Corners> triangles(static_cast<std::size_t>(ids.shape(0)));
  const std::int64_t* id = ids.data();
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (VertexId& corner : triangles[t]) {
      // Checked before the conversion to 32 bits: 2^32 must not become vertex 0.
      if (*id < 0 || static_cast<std::uint64_t>(*id) >= vertices) {
        refuse("triangles", "vertices from 0 to " + std::to_string(vertices) + " - 1",
               std::to_string(*id) + " in row " + std::to_string(t));
      }
      corner = static_cast<VertexId>(*id++);
    }
  }
  return triangles;
}

MeshHandle mesh_from(const py::object& vertices, const py::object& triangles, bool welded) {
  Surface surface;
  surface.vertices = points(vertices, {"vertices", {any, 3}, "(n, 3)"});
  surface.triangles = triangles_from(triangles, surface.vertices.size());
  MeshHandle mesh;
  {
    const py::gil_scoped_release release;
    // Before it is welded: what is not finite cannot be.
    mesh.mesh = std::make_shared<const Mesh>(welded ? surface : std::move(surface));
    if (welded) mesh.mesh = std::make_shared<const Mesh>(weld(std::move(surface)));
    for (const std::string& warning : quick_check(*mesh.mesh)) {
      mesh.warnings.push_back("Mesh: " + warning);
    }
  }
  for (const std::string& warning : mesh.warnings) warn(warning);
  return mesh;
}

AnatomicalSpace space_from(const char* argument, const std::optional<std::string>& given) {
  if (!given) return AnatomicalSpace::unstated;
  if (const auto space = space_named(*given)) return *space;
  refuse(argument, "'RAS', 'LPS' or None", "'" + *given + "'");
}

MeshHandle load(const std::filesystem::path& path, const std::optional<std::string>& space,
                const std::optional<std::string>& untagged, const std::optional<std::string>& unit,
                std::optional<double> scale, bool flip) {
  if (unit && unit->empty()) refuse("unit", "the name of a unit or None", "''");
  const LoadOptions options{.space = space_from("space", space),
                            .untagged = space_from("untagged", untagged),
                            .unit = unit.value_or(""),
                            .scale = scale,
                            .flip = flip};
  const auto loaded = [&] {
    const py::gil_scoped_release release;
    return load_mesh(path, options);
  };
  MeshHandle mesh{loaded()};
  // Users may not know of Mesh.warnings, so also issue Python warnings.
  for (const std::string& warning : mesh.warnings) warn(warning);
  if (!mesh.notices.empty()) {  // a requested change is no reason to warn
    const py::object log = py::module_::import("logging").attr("getLogger")("keepout").attr("info");
    for (const std::string& notice : mesh.notices) log("%s", notice);
  }
  return mesh;
}

const double* coordinates(const Vec3& point) { return point.data(); }

/// Computes the normals on the first call. Python's lock prevents two first calls at once.
py::array normals_of(const py::object& self) {
  auto& mesh = self.cast<MeshHandle&>();
  for (std::size_t t = mesh.normals.size(); t < mesh.mesh->triangle_count(); ++t) {
    mesh.normals.push_back(mesh.mesh->normal(static_cast<TriangleId>(t)));
  }
  return view(std::span<const Vec3>(mesh.normals), 3, coordinates, self);
}

/// The result of the mesh diagnostics. The search for self-intersections takes longest, and is made
/// on request.
struct Inspection : MeshFindings {
  std::optional<std::size_t> self_intersections = {};
  FaultPlaces crossings = {};
};

Inspection inspect(const MeshHandle& mesh, bool self_intersections, std::size_t places) {
  const py::gil_scoped_release release;
  Inspection inspection{examine(*mesh.mesh, places)};
  if (self_intersections) {
    SelfIntersections found = find_self_intersections(*mesh.mesh, PdTree(mesh.mesh), places);
    inspection.self_intersections = found.pairs;
    inspection.crossings = std::move(found.places);
  }
  return inspection;
}

/// Returns the corners of faults as an array (n, corners, 3).
py::array_t<double> corners_of(const FaultPlaces& faults, py::ssize_t corners) {
  py::array_t<double> array({std::ssize(faults.places), corners, py::ssize_t{3}});
  double* to = array.mutable_data();
  for (const FaultPlace& place : faults.places) {
    for (const Vec3& corner : place.corners) to = std::copy_n(corner.data(), 3, to);
  }
  return array;
}

py::dict places_of(const Inspection& inspection) {
  const MeshFaultPlaces& places = inspection.places;
  py::dict all;
  all["boundary_edges"] = corners_of(places.boundary_edges, 2);
  all["non_manifold_edges"] = corners_of(places.non_manifold_edges, 2);
  all["inconsistent_edges"] = corners_of(places.inconsistent_edges, 2);
  all["pinched_vertices"] = corners_of(places.pinched_vertices, 1);
  all["degenerate_triangles"] = corners_of(places.degenerate_triangles, 3);
  all["duplicate_triangles"] = corners_of(places.duplicate_triangles, 3);
  if (inspection.self_intersections) {
    all["self_intersections"] = corners_of(inspection.crossings, 6);
  }
  return all;
}

py::tuple tuple_of(const Vec3& v) { return py::make_tuple(v.x(), v.y(), v.z()); }

std::string summary(const Inspection& mesh) {
  std::ostringstream text;
  text << mesh.triangles << " triangles, " << mesh.vertices << " vertices, " << mesh.components
       << (mesh.components == 1 ? " component; " : " components; ")
       << (mesh.is_inside_out()   ? "watertight, but inside out"
           : mesh.is_watertight() ? "watertight"
           : mesh.is_closed()     ? "closed, but not a manifold with one orientation"
                                  : "open");
  const auto tell = [&](std::size_t count, const char* what) {
    if (count > 0) text << "; " << what << ": " << count;
  };
  tell(mesh.boundary_edges, "boundary edges");
  tell(mesh.non_manifold_edges, "non-manifold edges");
  tell(mesh.inconsistent_edges, "inconsistently wound edges");
  tell(mesh.pinched_vertices, "pinched vertices");
  tell(mesh.degenerate_triangles(), "degenerate triangles");
  tell(mesh.duplicate_triangles, "duplicate triangles");
  tell(mesh.unused_vertices, "unused vertices");
  tell(mesh.self_intersections.value_or(0), "self-intersecting pairs");
  if (mesh.looks_like_meters())
    text << "; smaller than 3 in every direction: if it is in meters, load it with unit=\"m\"";
  return text.str();
}

void bind_load_mesh(py::module_& module) {
  module.def(
      "load_mesh", &load, py::arg("path"), py::kw_only(), py::arg("space") = py::none(),
      py::arg("untagged") = py::none(), py::arg("unit") = py::none(), py::arg("scale") = py::none(),
      py::arg("flip") = false,
      R"(Reads a mesh from an STL, PLY, OBJ, OFF, legacy VTK or VTP file and welds it exactly.
Repairs nothing: see Mesh.inspect. Each doubt about the mesh is a UserWarning and an item of
Mesh.warnings; each requested change is an item of Mesh.notices.

space: 'RAS' or 'LPS', the space in which you need the coordinates. They are converted if the file
states the other one (SPACE=...). None: coordinates stay as in the file.
untagged: the space of a file that does not state one; ignored if the file states a space.
unit: 'm', 'cm', 'mm', 'um' or 'in', the unit of the lengths in the file, which are scaled to mm.
None: mm.
scale: the factor from lengths in the file to mm, above 0, instead of a unit.
flip: reverse the winding of each triangle, for normals that point into the solid.)");
}

}  // namespace

const std::shared_ptr<const Mesh>& mesh_of(const py::object& mesh) {
  if (!py::isinstance<MeshHandle>(mesh)) {
    refuse("mesh", "a keepout.Mesh", Py_TYPE(mesh.ptr())->tp_name);
  }
  return mesh.cast<const MeshHandle&>().mesh;
}

void bind_inspection(py::module_& module) {
  py::class_<Inspection>(module, "Inspection",
                         "The result of the mesh diagnostics. The attributes are those of\n"
                         "'keepout inspect --json'.")
      .def_readonly("vertices", &Inspection::vertices, "Number of vertices that a triangle uses.")
      .def_readonly("unused_vertices", &Inspection::unused_vertices,
                    "Number of vertices that no triangle uses.")
      .def_readonly("triangles", &Inspection::triangles, "Number of triangles.")
      .def_readonly("edges", &Inspection::edges, "Number of edges, each counted once.")
      .def_readonly("boundary_edges", &Inspection::boundary_edges,
                    "Number of edges with one triangle, as at holes.")
      .def_readonly("non_manifold_edges", &Inspection::non_manifold_edges,
                    "Number of edges with three triangles or more.")
      .def_readonly("inconsistent_edges", &Inspection::inconsistent_edges,
                    "Number of edges whose two triangles have opposite windings.")
      .def_readonly("pinched_vertices", &Inspection::pinched_vertices,
                    "Number of vertices that are the only connection of parts of the surface.")
      .def_readonly("repeated_vertex_triangles", &Inspection::repeated_vertex_triangles,
                    "Number of triangles that use a vertex twice.")
      .def_readonly("collinear_triangles", &Inspection::collinear_triangles,
                    "Number of triangles whose three vertices are exactly collinear.")
      .def_readonly("duplicate_triangles", &Inspection::duplicate_triangles,
                    "Number of triangles with the same three vertices as an earlier one.")
      .def_readonly("components", &Inspection::components,
                    "Number of parts that shared vertices connect.")
      .def_readonly("edge_components", &Inspection::edge_components,
                    "Number of parts that shared edges connect.")
      .def_property_readonly(
          "closed", [](const Inspection& i) { return i.is_closed(); },
          "True if every edge has two triangles or more.")
      .def_property_readonly(
          "watertight", [](const Inspection& i) { return i.is_watertight(); },
          "True if every edge has two triangles with consistent winding, so that inside is\n"
          "defined.")
      .def_property_readonly(
          "inside_out", [](const Inspection& i) { return i.is_inside_out(); },
          "True if it is watertight and its normals point into the solid.")
      .def_property_readonly(
          "looks_like_meters", [](const Inspection& i) { return i.looks_like_meters(); },
          "True if the mesh is smaller than 3 in every direction; in mm that is unlikely.")
      .def_readonly("euler_characteristic", &Inspection::euler_characteristic,
                    "Vertices - edges + triangles.")
      .def_readonly("genus", &Inspection::genus,
                    "Total number of handles; None unless watertight and without pinched\n"
                    "vertices.")
      .def_readonly("area", &Inspection::area, "Area [length^2].")
      .def_property_readonly(
          "signed_volume",
          [](const Inspection& i) {
            return i.is_watertight() ? std::optional(i.signed_volume) : std::nullopt;
          },
          "Volume [length^3], below 0 if inside out; None unless watertight.")
      .def_property_readonly(
          "low", [](const Inspection& i) { return tuple_of(i.bounds.low); },
          "Lowest corner of the bounds [length].")
      .def_property_readonly(
          "high", [](const Inspection& i) { return tuple_of(i.bounds.high); },
          "Highest corner of the bounds [length].")
      .def_readonly("self_intersections", &Inspection::self_intersections,
                    "Number of pairs of triangles that intersect; None unless requested.")
      .def_property_readonly(
          "places", &places_of,
          "The places of the faults: a dict by the name of the count. A value is an array (n,\n"
          "k, 3) with the corners of n faults. k is 2 for an edge, 1 for a vertex, 3 for a\n"
          "triangle and 6 for a pair of triangles. 'degenerate_triangles' has repeated-vertex\n"
          "and collinear triangles. The first places are from different groups of connected\n"
          "faults, such as one edge of each hole.")
      .def("__str__", &summary)
      .def("__repr__",
           [](const Inspection& i) { return "<keepout.Inspection: " + summary(i) + ">"; });
}

void bind_mesh(py::module_& module) {
  py::class_<MeshHandle>(
      module, "Mesh",
      "An immutable surface of triangles, which its users share. The arrays are copied.\n"
      "\n"
      "From the free side, the vertices of a triangle run counterclockwise. Use one unit of\n"
      "length everywhere, usually mm.\n"
      "\n"
      "vertices: (n, 3), finite [length]. triangles: (m, 3) integers from 0, m > 0.\n"
      "weld: merges vertices of equal coordinates, and renumbers them. Without it, a surface\n"
      "whose triangles do not share their vertices looks open. Warns like load_mesh.")
      .def(py::init(&mesh_from), py::arg("vertices"), py::arg("triangles"), py::kw_only(),
           py::arg("weld") = false)
      .def_property_readonly(
          "vertices",
          [](const py::object& self) {
            return view(self.cast<const MeshHandle&>().mesh->vertices(), 3, coordinates, self);
          },
          "(n, 3) float64 [length], read-only: the mesh's own memory.")
      .def_property_readonly(
          "triangles",
          [](const py::object& self) {
            return view(
                self.cast<const MeshHandle&>().mesh->triangles(), 3,
                [](const Corners& corners) { return corners.data(); }, self);
          },
          "(m, 3) uint32, read-only: the mesh's own memory.")
      .def_property_readonly(
          "normals", &normals_of,
          "(m, 3) float64, read-only: unit normals of the triangles, towards the free side;\n"
          "zero for a triangle without area. Computed on first use.")
      .def_property_readonly(
          "bounds",
          [](const MeshHandle& self) {
            const Box& box = self.mesh->bounds();
            py::array_t<double> bounds({2, 3});
            std::copy_n(box.low.data(), 3, bounds.mutable_data(0, 0));
            std::copy_n(box.high.data(), 3, bounds.mutable_data(1, 0));
            return bounds;
          },
          "(2, 3) float64: the lowest and the highest corner of the bounding box [length].")
      .def_readonly("warnings", &MeshHandle::warnings,
                    "Warnings about the mesh, or the file that it came from: a list of "
                    "sentences. Mesh and\nload_mesh also issue them as Python's warnings.")
      .def_readonly("notices", &MeshHandle::notices,
                    "Requested changes that load_mesh made (scaled, turned, flipped): a list of\n"
                    "sentences, which also go to the logger 'keepout' at level INFO.")
      .def_readonly("scale", &MeshHandle::scale,
                    "The factor by which load_mesh multiplied lengths.")
      .def_readonly("flipped", &MeshHandle::flipped,
                    "True if load_mesh reversed the winding of each triangle.")
      .def_property_readonly(
          "space",
          [](const MeshHandle& self) -> std::optional<std::string> {
            if (self.space == AnatomicalSpace::unstated) return std::nullopt;
            return std::string(name(self.space));
          },
          "The anatomical space of the coordinates, 'RAS' or 'LPS'; None if unknown.")
      .def("inspect", &inspect, py::kw_only(), py::arg("self_intersections") = false,
           py::arg("places") = 10,
           "Examines the mesh and returns an Inspection. Repairs nothing. The search for\n"
           "self-intersections takes longest.\n"
           "\n"
           "places: the maximum number of places to report for each kind of fault, from 0 on.")
      .def("__len__", [](const MeshHandle& self) { return self.mesh->triangle_count(); })
      .def("__repr__", [](const MeshHandle& self) {
        return py::str("<keepout.Mesh of {} triangles, {} vertices>")
            .format(self.mesh->triangle_count(), self.mesh->vertex_count());
      });
  bind_load_mesh(module);
}

}  // namespace keepout::python
