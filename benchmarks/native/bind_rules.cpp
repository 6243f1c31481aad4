// SPDX-License-Identifier: BSD-3-Clause
#include <string>

#include "bindings.h"
#include "keepout/error.h"
#include "keepout/index/wide_bvh.h"
#include "rules/closest_point_planes.h"
#include "rules/distance_field_rule.h"
#include "rules/keepout_rule.h"
#include "rules/slide.h"
#include "terrain.h"

namespace keepout::peers {
namespace {

namespace py = pybind11;
using py::literals::operator""_a;

void bind_tasks(py::module_& module) {
  py::class_<Terrain, std::shared_ptr<Terrain>>(module, "Terrain",
                                                R"(A mesh with its index, for rules
and pushers of C++.

Terrain(vertices, triangles): (n, 3) and (m, 3), shared by all rules, pushers and trials on a mesh.)")
      .def(py::init([](const RowsRef& vertices, const Eigen::Ref<const CornerRows>& triangles) {
             Surface surface;
             for (const auto& v : vertices.rowwise()) surface.vertices.emplace_back(v);
             for (const auto& t : triangles.rowwise())
               surface.triangles.push_back({t[0], t[1], t[2]});
             return std::make_shared<Terrain>(std::make_shared<const Mesh>(std::move(surface)));
           }),
           "vertices"_a, "triangles"_a, Unlocked())
      .def("judge", &Terrain::judge, Unlocked(), "Returns a judge of the mesh, for one thread.");
  py::class_<Task>(module, "Task", "Keeps a tip away from a mesh, and in a corridor.")
      .def(py::init([](const std::shared_ptr<Terrain>& terrain, double margin, double radius) {
             return Task{terrain->index(), margin, radius};
           }),
           "terrain"_a, "margin"_a, "radius"_a)
      .def(
          "set_corridor",
          [](Task& task, const Vec3& point, const Vec3& normal, double half_width) {
            task.corridor = {point, normal, half_width};
          },
          "point"_a, "normal"_a, "half_width"_a);
}

void bind_fields(py::module_& module) {
  using Field = DistanceField;
  py::class_<Field, std::shared_ptr<Field>>(module, "DistanceField",
                                            R"(Signed distances at the corners of cubes, in a narrow
band around a surface: benchmarks/native/rules/distance_field.h.

DistanceField(terrain, cell, band): lengths in mm.)")
      .def(py::init([](const std::shared_ptr<Terrain>& terrain, double cell, double band) {
             return std::make_shared<Field>(terrain->index(), cell, band);
           }),
           "terrain"_a, "cell"_a, "band"_a, Unlocked())
      .def_property_readonly("error_bound", &Field::error_bound,
                             "The bound of the error of an interpolated distance. [mm]")
      .def_property_readonly("is_signed", &Field::is_signed,
                             "True if the mesh is closed, so that distances have a sign.")
      .def("sample", &Field::sample, "low"_a, "high"_a, Unlocked(),
           "Computes the blocks in a box; returns their memory. [bytes]")
      .def("memory_of_all", &Field::memory_of_all, Unlocked(),
           "Returns the memory of the blocks of the whole mesh. [bytes]")
      .def(
          "distances",
          [](const std::shared_ptr<Field>& field, const RowsRef& points) {
            Field::Reader reader(field);
            Eigen::VectorXd out(points.rows());
            for (Eigen::Index i = 0; i < points.rows(); ++i)
              out[i] = reader(points.row(i)).distance;
            return out;
          },
          "points"_a, Unlocked(), "Returns the interpolated distances of (n, 3) points: (n,).")
      .def(
          "gradients",
          [](const std::shared_ptr<Field>& field, const RowsRef& points) {
            Field::Reader reader(field);
            Rows out(points.rows(), 3);
            for (Eigen::Index i = 0; i < points.rows(); ++i)
              out.row(i) = reader(points.row(i)).gradient;
            return out;
          },
          "points"_a, Unlocked(), "Returns the gradients at (n, 3) points: (n, 3).");
}

void bind_sweeps(py::module_& module) {
  py::class_<Sweep, std::shared_ptr<Sweep>>(
      module, "Sweep", "Another library's answer for a ball that moves past a mesh.")
      .def(
          "__call__",
          [](const Sweep& sweep, const Vec3& tip, const Vec3& motion) {
            const SweepEnd end = sweep(tip, motion);
            return std::pair(end.fraction, end.normal);
          },
          "tip"_a, "motion"_a,
          "Returns the fraction of the motion, 0 to 1, for which the ball is free, and the normal\n"
          "of the contact; zero without one.");
  [[maybe_unused]] const auto add = [&](const char* name, auto make, const char* doc) {
    module.def(
        name,
        [make](const std::shared_ptr<Terrain>& terrain, double radius) -> std::shared_ptr<Sweep> {
          if (!(radius > 0.0)) throw Error("the ball needs a radius > 0");
          return make(terrain->mesh(), radius);
        },
        "terrain"_a, "radius"_a, Unlocked(), doc);
  };
#ifdef KEEPOUT_HAS_FCL
  add("continuous_collision", &continuous_collision,
      "Returns FCL's continuous collision of a ball with a mesh, at places along the motion.");
  add("conservative_advancement", &conservative_advancement,
      "Returns FCL's conservative advancement of a ball to a mesh.");
#endif
#ifdef KEEPOUT_HAS_BULLET
  add("convex_sweep", &convex_sweep, "Returns Bullet's sweep of a ball past a mesh.");
#endif
}

}  // namespace

void bind_rules(py::module_& module) {
  bind_tasks(module);
  bind_fields(module);
  bind_sweeps(module);
  py::class_<Rule>(module, "Rule", "A rule of C++: the interface of experiments/rules/rule.py.")
      .def("step", &Rule::step, "tip"_a, "desired"_a,
           "Returns the allowed motion, (3,) in mm, for a tip and a desired motion.");
  module.def("keepout_rule", &keepout_rule, "task"_a, "activation"_a, Unlocked(),
             "Returns the rule of a MotionConstraint with an activation rule.");
  module.def(
      "closest_point_planes",
      [](const Task& task, const std::string& obstacles, double gain) {
        static constexpr std::array<std::string_view, 3> names{"nearest", "minima", "all"};
        return closest_point_planes(task, named<Obstacles>(names, obstacles), gain);
      },
      "task"_a, "obstacles"_a, "gain"_a, Unlocked(),
      "Returns the rule with a plane for closest points of the mesh: `nearest`, `minima` or "
      "`all`.");
  module.def(
      "distance_field_rule",
      [](const Task& task, const std::shared_ptr<DistanceField>& field, const std::string& use) {
        static constexpr std::array<std::string_view, 3> names{"plane", "cut", "sure"};
        return distance_field_rule(task, field, named<FieldUse>(names, use));
      },
      "task"_a, "field"_a, "use"_a, Unlocked(),
      "Returns the rule of a distance field: `plane`, `cut` or `sure`.");
  module.def(
      "slide",
      [](const Task& task, const std::shared_ptr<Sweep>& sweep) { return slide(task, sweep); },
      "task"_a, "sweep"_a, Unlocked(),
      "Returns the rule that moves until contact and slides, at most four times.");
}

}  // namespace keepout::peers
