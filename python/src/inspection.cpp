// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <optional>
#include <sstream>

#include "bindings.h"
#include "keepout/index/pd_tree.h"
#include "keepout/index/self_intersection.h"
#include "keepout/mesh/doctor.h"

namespace keepout::python {
namespace {

/// What the doctor found; the search for self-intersections takes longest and is made when asked
/// for.
struct Inspection : MeshFindings {
  std::optional<std::size_t> self_intersections;
};

Inspection inspect(const MeshHandle& mesh, bool self_intersections) {
  const py::gil_scoped_release release;
  Inspection inspection{examine(*mesh.mesh), std::nullopt};
  if (self_intersections) {
    inspection.self_intersections = count_self_intersections(*mesh.mesh, PdTree(mesh.mesh));
  }
  return inspection;
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
  if (mesh.looks_like_metres()) text << "; smaller than 3 in every direction: metres, not mm?";
  return text.str();
}

}  // namespace

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
      .def("__str__", &summary)
      .def("__repr__",
           [](const Inspection& i) { return "<keepout.Inspection: " + summary(i) + ">"; });

  py::class_<MeshHandle>(module.attr("Mesh"))
      .def("inspect", &inspect, py::kw_only(), py::arg("self_intersections") = false,
           "Examines the mesh; repairs nothing. The search for self-intersections takes longest.");
}

}  // namespace keepout::python
