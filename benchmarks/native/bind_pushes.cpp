// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <string>

#include "bindings.h"
#include "push.h"
#include "python_rule.h"

namespace keepout::peers {
namespace {

namespace py = pybind11;
using py::literals::operator""_a;

py::dict rows_of(const Push& push) {
  return py::dict("steps"_a = push.steps, "entered"_a = push.entered, "depth"_a = push.depth,
                  "clearance"_a = push.clearance, "unsafe"_a = push.unsafe,
                  "free_asked"_a = push.free_asked, "free_lost"_a = push.free_lost,
                  "excess"_a = push.excess, "excess_of"_a = push.excess_of,
                  "seconds"_a = push.seconds);
}

}  // namespace

void bind_pushes(py::module_& module) {
  py::class_<Pusher>(module, "Pusher",
                     "A simulated operator that tries to push a tip through a surface.")
      .def("next", &Pusher::next, "tip"_a, "Returns the desired motion, (3,) in mm.");
  py::class_<PointPusher, Pusher>(module, "PointPusher",
                                  R"(An operator that sees the tip and the surface.

PointPusher(terrain, route, longest, seed): one of ROUTES; `longest` motion of a cycle in mm.
benchmarks/native/push.h describes the routes.)")
      .def(py::init([](const Terrain& terrain, const std::string& route, double longest,
                       std::uint64_t seed) {
             return std::make_unique<PointPusher>(terrain, named<Route>(route_names, route),
                                                  longest, Random(seed));
           }),
           "terrain"_a, "route"_a, "longest"_a, "seed"_a, py::keep_alive<1, 2>());
  py::class_<SteadyPusher, Pusher>(module, "SteadyPusher",
                                   "An operator that always commands one motion.")
      .def(py::init<const Vec3&>(), "motion"_a);
  module.attr("ROUTES") =
      py::tuple(py::cast(std::vector<std::string>(route_names.begin(), route_names.end())));
  module.def(
      "start",
      [](const Terrain& terrain, const std::string& route, double clearance, double height,
         std::uint64_t seed) {
        Random random(seed);
        return terrain.place(kind_of(named<Route>(route_names, route)), clearance, height, random);
      },
      "terrain"_a, "route"_a, "clearance"_a, "height"_a, "seed"_a, Unlocked(),
      "Returns a place on the free side for the start of a route, at most `height` mm above the\n"
      "surface. Raises ValueError if no place has the clearance.");
  module.def(
      "push",
      [](Judge& judge, const py::object& rule, Pusher& pusher, const Vec3& start, double margin,
         int cycles, int cycles_inside, int best_steps, std::uint64_t seed) {
        const RuleArgument chosen(rule);
        Push found;
        {
          const py::gil_scoped_release unlocked;
          found = push(judge, chosen.rule(), pusher, start,
                       {margin, cycles, cycles_inside, best_steps, seed});
        }
        return rows_of(found);
      },
      "judge"_a, "rule"_a, "pusher"_a, "start"_a, py::kw_only(), "margin"_a, "cycles"_a,
      "cycles_inside"_a = 0, "best_steps"_a = 0, "seed"_a = 0,
      "Pushes a tip from `start` and judges each step; the rule is of C++ or Python, or None.\n"
      "Returns the members of Push in benchmarks/native/push.h as a dict.");
}

}  // namespace keepout::peers
