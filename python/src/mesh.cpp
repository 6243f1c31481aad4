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
#include "keepout/mesh/doctor.h"

namespace keepout::python {
namespace {

using Ids = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>;

std::vector<Corners> triangles_from(py::handle argument, std::size_t vertices) {
  const py::array given = numbers(argument, {"triangles", {any, 3}, "(m, 3)"});
  if (given.size() > 0 && given.dtype().kind() == 'f') {
    refuse("triangles", "integers, which count vertices from 0",
           "an array of dtype " + dtype_text(given));
  }
  const auto ids = converted<Ids>(given, "triangles", "integers of at most 64 bits");
  std::vector<Corners> triangles(static_cast<std::size_t>(ids.shape(0)));
  const std::int64_t* id = ids.data();
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (VertexId& corner : triangles[t]) {
      // Before they are narrowed: 2^32 is not vertex 0.
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
  // Nobody looks at warnings who does not know of any.
  for (const std::string& warning : mesh.warnings) warn(warning);
  if (!mesh.notices.empty()) {  // what was asked for is no reason to warn
    const py::object log = py::module_::import("logging").attr("getLogger")("keepout").attr("info");
    for (const std::string& notice : mesh.notices) log("%s", notice);
  }
  return mesh;
}

const double* coordinates(const Vec3& point) { return point.data(); }

/// Made on the first call, which Python's lock keeps from being two.
py::array normals_of(const py::object& self) {
  auto& mesh = self.cast<MeshHandle&>();
  for (std::size_t t = mesh.normals.size(); t < mesh.mesh->triangle_count(); ++t) {
    mesh.normals.push_back(mesh.mesh->normal(static_cast<TriangleId>(t)));
  }
  return view(std::span<const Vec3>(mesh.normals), 3, coordinates, self);
}

/// What the doctor found; the search for self-intersections takes longest and is made when asked
/// for.
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

/// (n, corners, 3)
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
  if (mesh.looks_like_metres())
    text << "; smaller than 3 in every direction: metres, not mm? Then load it with unit=\"m\"";
  return text.str();
}

void bind_load_mesh(py::module_& module) {
  module.def(
      "load_mesh", &load, py::arg("path"), py::kw_only(), py::arg("space") = py::none(),
      py::arg("untagged") = py::none(), py::arg("unit") = py::none(), py::arg("scale") = py::none(),
      py::arg("flip") = false,
      R"(Reads a mesh from an STL, PLY, OBJ, OFF, legacy VTK or VTP file, and welds it exactly.
Nothing is repaired: see Mesh.inspect. What is odd about the mesh is a UserWarning, and in
Mesh.warnings; what was done to it, as asked for, is in Mesh.notices.

space: 'RAS' or 'LPS', which the coordinates shall be in; they are turned if the file
says the other one (SPACE=...). None: as they stand.
untagged: the space of a file that does not say. One that does is believed.
unit: 'm', 'cm', 'mm', 'um' or 'in', the unit of the lengths in the file, which are scaled
to mm. None: mm.
scale: the factor from lengths in the file to mm, above 0, instead of a unit.
flip: wind each triangle the other way, for normals that point into the solid.)");
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
                         "What there is to know about a mesh before it guards anything. The "
                         "attributes are those of 'keepout inspect --json'.")
      .def_readonly("vertices", &Inspection::vertices, "Vertices that a triangle uses.")
      .def_readonly("unused_vertices", &Inspection::unused_vertices,
                    "Vertices that no triangle uses.")
      .def_readonly("triangles", &Inspection::triangles, "Triangles.")
      .def_readonly("edges", &Inspection::edges, "Edges, each once.")
      .def_readonly("boundary_edges", &Inspection::boundary_edges,
                    "Edges of one triangle: holes and rims.")
      .def_readonly("non_manifold_edges", &Inspection::non_manifold_edges,
                    "Edges of three triangles or more.")
      .def_readonly("inconsistent_edges", &Inspection::inconsistent_edges,
                    "Edges whose two triangles are wound against each other.")
      .def_readonly("pinched_vertices", &Inspection::pinched_vertices,
                    "Vertices by which alone parts of the surface hang together.")
      .def_readonly("repeated_vertex_triangles", &Inspection::repeated_vertex_triangles,
                    "Triangles that name a vertex twice.")
      .def_readonly("collinear_triangles", &Inspection::collinear_triangles,
                    "Triangles whose three vertices are on one line, exactly.")
      .def_readonly("duplicate_triangles", &Inspection::duplicate_triangles,
                    "Triangles of the same three vertices as an earlier one.")
      .def_readonly("components", &Inspection::components,
                    "Parts held together by shared vertices.")
      .def_readonly("edge_components", &Inspection::edge_components,
                    "Parts held together by shared edges.")
      .def_property_readonly(
          "closed", [](const Inspection& i) { return i.is_closed(); },
          "Whether every edge has two triangles or more.")
      .def_property_readonly(
          "watertight", [](const Inspection& i) { return i.is_watertight(); },
          "Whether every edge has two triangles, wound alike: then there is an inside.")
      .def_property_readonly(
          "inside_out", [](const Inspection& i) { return i.is_inside_out(); },
          "Whether it is watertight with normals that point into the solid.")
      .def_property_readonly(
          "looks_like_metres", [](const Inspection& i) { return i.looks_like_metres(); },
          "Whether it is smaller than 3 in every direction, where millimetres are expected.")
      .def_readonly("euler_characteristic", &Inspection::euler_characteristic,
                    "Vertices - edges + triangles.")
      .def_readonly("genus", &Inspection::genus,
                    "Handles in all; None unless watertight and without pinched vertices.")
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
                    "Pairs of triangles that cut through each other; None unless asked for.")
      .def_property_readonly(
          "places", &places_of,
          "Where faults are: (n, k, 3) arrays of the corners of n faults of a kind, by the name "
          "of\n"
          "its count ('degenerate_triangles' has both kinds of these). An edge has k = 2 corners, "
          "a\nvertex 1, a triangle 3; a pair of 'self_intersections' has those of both triangles. "
          "One\nfault of each group that shares vertices, such as each hole, comes first.")
      .def("__str__", &summary)
      .def("__repr__",
           [](const Inspection& i) { return "<keepout.Inspection: " + summary(i) + ">"; });
}

void bind_mesh(py::module_& module) {
  py::class_<MeshHandle>(
      module, "Mesh",
      "An immutable triangle surface, shared by all that is built on it.\n\n"
      "Seen from the free side, the vertices of a triangle run counter-clockwise; any one unit of\n"
      "length, usually mm. What is given is copied; what is read from it is not.\n\n"
      "vertices: (n, 3), finite [length]. triangles: (m, 3) integers from 0, m > 0.\n"
      "weld: merge vertices of equal coordinates, which renumbers them; a surface whose triangles\n"
      "do not share their vertices looks open otherwise. Warns as load_mesh does.")
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
          "(m, 3) float64, read-only: unit normals of the triangles, towards the free side; zero\n"
          "for one without an area. Made when first asked for.")
      .def_property_readonly(
          "bounds",
          [](const MeshHandle& self) {
            const Box& box = self.mesh->bounds();
            py::array_t<double> bounds({2, 3});
            std::copy_n(box.low.data(), 3, bounds.mutable_data(0, 0));
            std::copy_n(box.high.data(), 3, bounds.mutable_data(1, 0));
            return bounds;
          },
          "(2, 3) float64 [length]: the lowest and the highest corner of the smallest box around.")
      .def_readonly("warnings", &MeshHandle::warnings,
                    "What is odd about the mesh, or the file that it came from: a list of "
                    "sentences, which Mesh and\nload_mesh show as Python's warnings, too.")
      .def_readonly("notices", &MeshHandle::notices,
                    "What load_mesh did because it was asked to: scaled, turned, flipped. A list "
                    "of sentences,\nwhich also go to the logger 'keepout' at level INFO.")
      .def_readonly("scale", &MeshHandle::scale, "What the lengths of the file were multiplied by.")
      .def_readonly("flipped", &MeshHandle::flipped,
                    "True if load_mesh wound each triangle the other way.")
      .def_property_readonly(
          "space",
          [](const MeshHandle& self) -> std::optional<std::string> {
            if (self.space == AnatomicalSpace::unstated) return std::nullopt;
            return std::string(name(self.space));
          },
          "The anatomical space of the coordinates, 'RAS' or 'LPS', if it is known; or None.")
      .def("inspect", &inspect, py::kw_only(), py::arg("self_intersections") = false,
           py::arg("places") = 10,
           "Examines the mesh; repairs nothing. The search for self-intersections takes "
           "longest.\n\n"
           "places: at most so many places of each kind of fault are kept, from 0 on.")
      .def("__len__", [](const MeshHandle& self) { return self.mesh->triangle_count(); })
      .def("__repr__", [](const MeshHandle& self) {
        return py::str("<keepout.Mesh of {} triangles, {} vertices>")
            .format(self.mesh->triangle_count(), self.mesh->vertex_count());
      });
  bind_load_mesh(module);
}

}  // namespace keepout::python
