// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <optional>
#include <sstream>

#include "bindings.h"
#include "keepout/index/pd_tree.h"
#include "keepout/index/self_intersection.h"
#include "keepout/mesh/doctor.h"
#include "mesh_handle.h"

namespace keepout::python {
namespace {

/// What the doctor found; the search for self-intersections takes longest and is made when asked
/// for.
struct Inspection {
  MeshFindings findings;
  std::optional<std::size_t> self_intersections;
};

Inspection inspect(const MeshHandle& mesh, bool self_intersections) {
  const py::gil_scoped_release release;
  Inspection inspection{examine(mesh.mesh()), std::nullopt};
  if (self_intersections) {
    inspection.self_intersections = count_self_intersections(mesh.mesh(), PdTree(mesh.shared()));
  }
  return inspection;
}

py::tuple tuple_of(const Vec3& v) { return py::make_tuple(v.x(), v.y(), v.z()); }

std::string summary(const Inspection& inspection) {
  const MeshFindings& mesh = inspection.findings;
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
  tell(inspection.self_intersections.value_or(0), "self-intersecting pairs");
  if (mesh.looks_like_metres()) text << "; smaller than 3 in every direction: metres, not mm?";
  return text.str();
}

}  // namespace

void bind_inspection(py::module_& module) {
  py::class_<Inspection> type(module, "Inspection",
                              "What there is to know about a mesh before it guards anything. The "
                              "attributes are those of 'keepout inspect --json'.");
  const auto count = [&](const char* name, std::size_t MeshFindings::*member, const char* doc) {
    type.def_property_readonly(
        name, [member](const Inspection& i) { return i.findings.*member; }, doc);
  };
  count("vertices", &MeshFindings::vertices, "Vertices that a triangle uses.");
  count("unused_vertices", &MeshFindings::unused_vertices, "Vertices that no triangle uses.");
  count("triangles", &MeshFindings::triangles, "Triangles.");
  count("edges", &MeshFindings::edges, "Edges, each once.");
  count("boundary_edges", &MeshFindings::boundary_edges, "Edges of one triangle: holes and rims.");
  count("non_manifold_edges", &MeshFindings::non_manifold_edges,
        "Edges of three triangles or more.");
  count("inconsistent_edges", &MeshFindings::inconsistent_edges,
        "Edges whose two triangles are wound against each other.");
  count("pinched_vertices", &MeshFindings::pinched_vertices,
        "Vertices by which alone parts of the surface hang together.");
  count("repeated_vertex_triangles", &MeshFindings::repeated_vertex_triangles,
        "Triangles that name a vertex twice.");
  count("collinear_triangles", &MeshFindings::collinear_triangles,
        "Triangles whose three vertices are on one line, exactly.");
  count("duplicate_triangles", &MeshFindings::duplicate_triangles,
        "Triangles of the same three vertices as an earlier one.");
  count("components", &MeshFindings::components, "Parts held together by shared vertices.");
  count("edge_components", &MeshFindings::edge_components, "Parts held together by shared edges.");
  type.def_property_readonly(
          "closed", [](const Inspection& i) { return i.findings.is_closed(); },
          "Whether every edge has two triangles or more.")
      .def_property_readonly(
          "watertight", [](const Inspection& i) { return i.findings.is_watertight(); },
          "Whether every edge has two triangles, wound alike: then there is an inside.")
      .def_property_readonly(
          "inside_out", [](const Inspection& i) { return i.findings.is_inside_out(); },
          "Whether it is watertight with normals that point into the solid.")
      .def_property_readonly(
          "looks_like_metres", [](const Inspection& i) { return i.findings.looks_like_metres(); },
          "Whether it is smaller than 3 in every direction, where millimetres are expected.")
      .def_property_readonly(
          "euler_characteristic",
          [](const Inspection& i) { return i.findings.euler_characteristic; },
          "Vertices - edges + triangles.")
      .def_property_readonly(
          "genus", [](const Inspection& i) { return i.findings.genus; },
          "Handles in all; None unless watertight and without pinched vertices.")
      .def_property_readonly(
          "area", [](const Inspection& i) { return i.findings.area; }, "Area [length^2].")
      .def_property_readonly(
          "signed_volume",
          [](const Inspection& i) {
            return i.findings.is_watertight() ? std::optional(i.findings.signed_volume)
                                              : std::nullopt;
          },
          "Volume [length^3], below 0 if inside out; None unless watertight.")
      .def_property_readonly(
          "low", [](const Inspection& i) { return tuple_of(i.findings.bounds.low); },
          "Lowest corner of the bounds [length].")
      .def_property_readonly(
          "high", [](const Inspection& i) { return tuple_of(i.findings.bounds.high); },
          "Highest corner of the bounds [length].")
      .def_property_readonly(
          "self_intersections", [](const Inspection& i) { return i.self_intersections; },
          "Pairs of triangles that cut through each other; None unless asked for.")
      .def("__str__", &summary)
      .def("__repr__",
           [](const Inspection& i) { return "<keepout.Inspection: " + summary(i) + ">"; });

  py::class_<MeshHandle>(module.attr("Mesh"))
      .def("inspect", &inspect, py::kw_only(), py::arg("self_intersections") = false,
           "Examines the mesh; repairs nothing. The search for self-intersections takes longest.");
}

}  // namespace keepout::python
