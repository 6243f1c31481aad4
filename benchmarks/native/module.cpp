// SPDX-License-Identifier: BSD-3-Clause
// The module keepout_peers: judge, rules, loops and meshes of the experiments.
#include <string>
#include <utility>
#include <vector>

#include "bindings.h"
#include "keepout/error.h"
#include "keepout/fixtures/counterexamples.h"
#include "keepout/fixtures/real_mesh.h"
#include "keepout/fixtures/shapes.h"
#include "keepout/mesh/load_mesh.h"

namespace keepout::peers {
namespace {

namespace py = pybind11;
using py::literals::operator""_a;

void bind_judge(py::module_& module) {
  py::class_<Judge>(module, "Judge", R"(Judges the motions of a tip beside a mesh with exact
arithmetic. Shares no code with keepout. Terrain.judge() makes one.

Use one for each thread. It is fastest if each motion is near the last. Lengths are in the unit of
the mesh.)")
      .def_property_readonly("closed", &Judge::closed, "True if the mesh has an inside.")
      .def("distances", &Judge::distances, "points"_a, Unlocked(),
           "Returns the distances of (n, 3) points from the mesh: (n,), below 0 inside a closed\n"
           "mesh.")
      .def("crossings", &Judge::crossings, "starts"_a, "ends"_a, Unlocked(),
           "Returns which of n straight motions touch the mesh: (n,) of bool, exact.")
      .def("best_step", &Judge::best_step, "tip"_a, "desired"_a, "margin"_a, Unlocked(),
           "Returns the motion nearest to the desired one that keeps the margin along its whole\n"
           "path; its cost, |motion - desired|; and a lower bound of the cost of any such\n"
           "motion. Uses branch and bound.");
}

std::vector<std::pair<std::string, std::string>> named_meshes() {
  std::vector<std::pair<std::string, std::string>> out;
  for (const Shape& shape : shapes()) {
    const bool is_solid = shape.kind == ShapeKind::solid, is_sheet = shape.kind == ShapeKind::sheet;
    out.emplace_back(shape.name, is_solid ? "solid" : is_sheet ? "sheet" : "broken");
  }
  for (const std::string_view name : real_meshes()) out.emplace_back(name, "real");
  return out;
}

/// Returns the vertices and the triangles of a mesh as arrays.
std::pair<Rows, CornerRows> arrays_of(const Mesh& mesh) {
  Rows vertices(mesh.vertex_count(), 3);
  for (VertexId v = 0; v < mesh.vertex_count(); ++v) vertices.row(v) = mesh.vertex(v);
  CornerRows triangles(mesh.triangle_count(), 3);
  for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
    const Corners& c = mesh.corners(t);
    triangles.row(t) << c[0], c[1], c[2];
  }
  return {std::move(vertices), std::move(triangles)};
}

std::pair<Rows, CornerRows> named_mesh(const std::string& name) {
  for (const Shape& shape : shapes()) {
    if (shape.name == name) return arrays_of(Mesh(shape.make()));
  }
  return arrays_of(*load_mesh(fixture_path(name)).mesh);
}

py::list all_counterexamples() {
  py::list out;
  for (const Counterexample& example : counterexamples()) {
    const auto [vertices, triangles] = arrays_of(Mesh(example.surface));
    out.append(py::make_tuple(std::string(example.name), vertices, triangles, example.tip,
                              example.desired, example.radius));
  }
  return out;
}

}  // namespace
}  // namespace keepout::peers

PYBIND11_MODULE(keepout_peers, module) {
  using namespace keepout::peers;
  module.doc() = "The rules, the judge and the loops of the experiments.";
  py::register_local_exception<keepout::Error>(module, "Error", PyExc_ValueError);
  bind_judge(module);
  bind_rules(module);
  bind_pushes(module);
  bind_trials(module);
  module.def("named_meshes", &named_meshes,
             "Returns name and kind of each mesh that keepout names: solid, sheet, broken or\n"
             "real.");
  module.def("counterexamples", &all_counterexamples,
             "Returns meshes and motions on which some reading of Algorithm 1 of Li et al.\n"
             "(2020) fails: for each its name, vertices, triangles, tip, desired motion and\n"
             "radius of the motion sphere.");
  module.def(
      "named_mesh", &named_mesh, "name"_a, Unlocked(),
      "Returns its vertices, (n, 3) in mm, and triangles, (m, 3). Raises ValueError if the name\n"
      "is unknown or the mesh is not prepared.");
}
