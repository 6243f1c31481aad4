// SPDX-License-Identifier: BSD-3-Clause
// The module keepout_peers: what judges the experiments, what keepout is held against, and on what.
#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "judge.h"
#include "keepout/error.h"
#include "keepout/fixtures/counterexamples.h"
#include "keepout/fixtures/real_mesh.h"
#include "keepout/fixtures/shapes.h"
#include "keepout/mesh/load_mesh.h"
#include "sweep.h"

namespace keepout::peers {
namespace {

namespace py = pybind11;
using py::literals::operator""_a;

using CornerRows = Eigen::Matrix<std::uint32_t, Eigen::Dynamic, 3, Eigen::RowMajor>;
using Unlocked = py::call_guard<py::gil_scoped_release>;

Mesh mesh_of(const RowsRef& vertices, const Eigen::Ref<const CornerRows>& triangles) {
  Surface surface;
  for (const auto& v : vertices.rowwise()) surface.vertices.emplace_back(v);
  for (const auto& t : triangles.rowwise()) surface.triangles.push_back({t[0], t[1], t[2]});
  return Mesh(std::move(surface));
}

void bind_judge(py::module_& module) {
  py::class_<Judge>(module, "Judge", R"(
Judges the motions of a tip past a mesh with exact arithmetic, and shares nothing with keepout.

Judge(vertices, triangles): (n, 3) and (m, 3). One for each thread. Motions that are near each other
are judged fastest in their order. Lengths are in the unit of the mesh.)")
      .def(py::init([](const RowsRef& vertices, const Eigen::Ref<const CornerRows>& triangles) {
             return Judge(std::make_shared<const Mesh>(mesh_of(vertices, triangles)));
           }),
           "vertices"_a, "triangles"_a, Unlocked())
      .def_property_readonly("closed", &Judge::closed, "Whether the mesh has an inside.")
      .def("distances", &Judge::distances, "points"_a, Unlocked(),
           "Of (n, 3) points from the mesh: (n,), less than 0 inside of a closed one.")
      .def("least_distances", &Judge::least_distances, "starts"_a, "ends"_a,
           "reach"_a = std::numeric_limits<double>::infinity(), Unlocked(),
           "Of n straight motions from the mesh: (n,), 0 if and only if one touches, infinite "
           "where it "
           "is more than `reach`; the less that is, the faster.")
      .def("crossings", &Judge::crossings, "starts"_a, "ends"_a, Unlocked(),
           "Which of n straight motions touch the mesh: (n,) of bool, exact.")
      .def("best_step", &Judge::best_step, "tip"_a, "desired"_a, "margin"_a, Unlocked(),
           "The motion nearest to the desired one on whose whole way the tip keeps the margin, "
           "what it "
           "costs, |motion - desired|, and what any such costs at least; found by branch and "
           "bound.");
}

void bind_sweeps(py::module_& module) {
  py::class_<Sweep>(module, "Sweep", "What another library says of a ball that moves past a mesh.")
      .def("time_of_impact", &Sweep::time_of_impact, "tip"_a, "motion"_a,
           "The share of the motion that the ball is said to be free for: from 0 to 1.");
  const auto add = [&](const char* name, auto make, const char* doc) {
    module.def(
        name,
        [make](const RowsRef& vertices, const Eigen::Ref<const CornerRows>& triangles,
               double radius) {
          if (!(radius > 0.0)) throw Error("the ball needs a radius > 0");
          return make(mesh_of(vertices, triangles), radius);
        },
        "vertices"_a, "triangles"_a, "radius"_a, Unlocked(), doc);
  };
  add("continuous_collision", &continuous_collision,
      "FCL's continuous collision of a ball with a mesh, by places all along the motion.");
  add("convex_sweep", &convex_sweep, "Bullet's sweep of a ball past a mesh.");
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

/// The vertices and the triangles of a mesh, as arrays.
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
  module.doc() = "What the experiments hold keepout against, and what judges them.";
  py::register_local_exception<keepout::Error>(module, "Error", PyExc_ValueError);
  bind_judge(module);
  bind_sweeps(module);
  module.def("named_meshes", &named_meshes,
             "Name and kind of each mesh that keepout names: solid, sheet, broken; or real.");
  module.def("counterexamples", &all_counterexamples,
             "Meshes and motions on which some reading of the paper's Algorithm 1 fails: name, "
             "vertices, triangles, tip, desired motion and radius of the motion sphere of each.");
  module.def(
      "named_mesh", &named_mesh, "name"_a, Unlocked(),
      "Its vertices, (n, 3) in mm, and triangles, (m, 3). ValueError: unknown, or not prepared.");
}
