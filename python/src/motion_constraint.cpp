// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <string>
#include <utility>

#include "guard.h"
#include "keepout/factory/convex_tool_text.h"

namespace keepout::python {
namespace {

py::str repr(const Guard& guard) {
  const MotionConstraintSettings& s = guard.settings();
  const StepOptions& o = s.options;
  return py::str(
             "<keepout.MotionConstraint index='{}' activation='{}' solver='{}' radius={:g} "
             "{}={} margin={:g} on {} triangles>")
      .format(guard.index()->name, s.activation, s.solver, o.radius,
              s.tool ? "tool" : "tool_radius",
              s.tool ? py::repr(py::cast(*s.tool)) : py::str("{:g}").format(o.tool_radius),
              o.margin, guard.index()->mesh->triangle_count());
}

constexpr const char* class_doc =
    R"(Keeps a tool tip out of a mesh, step by step. Several threads may use a constraint; they wait
for each other. Make one constraint for each parallel loop; the constraints may share the Index.

index: a name of indices(), or an Index of this mesh.
index_cache: a directory that keeps built indices for the next start.
tool: a ConvexTool, or the text of one, that must not touch the mesh, instead of a ball. With a
tool, leave tool_radius and activation unset; inside, refinements and nodes have no effect.
max_...: a capacity; a step that needs more ends with Status.over_capacity.)";

constexpr const char* constraint_signature =
    "__init__(self: keepout.MotionConstraint, mesh: keepout.Mesh, *, "
    "index: str | keepout.Index = 'wide_bvh', index_cache: str | os.PathLike[str] | None = None, "
    "tool: keepout.ConvexTool | str | None = None";

std::optional<ConvexTool> tool_from(const py::object& given) {
  if (given.is_none()) return std::nullopt;
  if (py::isinstance<ConvexTool>(given)) return given.cast<ConvexTool>();
  if (py::isinstance<py::str>(given)) return tool_of_text(given.cast<std::string>());
  refuse("tool", "a keepout.ConvexTool or the text of one, such as 'capsule:0,0,0:0,0,12:1.5'",
         type_name(given));
}

std::unique_ptr<Guard> make_guard(const py::object& mesh, const py::object& index,
                                  const std::optional<std::filesystem::path>& index_cache,
                                  const py::object& tool, const py::kwargs& given) {
  auto settings = settings_from<MotionConstraintSettings>("MotionConstraint", given,
                                                          {"mesh", "index", "index_cache", "tool"});
  settings.tool = tool_from(tool);
  return std::make_unique<Guard>(index_from(mesh, index, index_cache), std::move(settings));
}

constexpr const char* step_doc =
    R"(Returns the allowed motion nearest to the desired one: a Step. The constraint remembers the
path of the last step. If the tip is not on it, the step classifies the tip again. A number that is
not finite gives Status.invalid_input.

tip: (3,), in the frame of the mesh [length].
desired: (3,), the desired increment [length].
jacobian: (3, n), of the tip with respect to the joints [length / unit of the joint]. With n above 3
the constraint needs a damping above 0; without it the step is Status.ill_posed.
rows: a pair, matrix (m, n) and bounds (m,), for the increment u of the joints, or of the tip with
n = 3: matrix @ u >= bounds.)";

constexpr const char* steps_doc =
    R"(Returns one step for each pose: a Steps. Every tip is classified again, so the result does
not depend on the order or on the number of threads. Runs without Python's lock. The classification
may take longer than the step; inside='taken_as_is' skips it.

tips: (n, 3) [length].
desired: (n, 3) [length].
threads: 1 to 1024; None: one for each processor.
out: a Steps to write to; None for a new one.

A single tip or desired increment, (3,), serves all rows of the other array. Float64 and
C-contiguous arrays are not copied. A pose that is not finite has Status.invalid_input and zero
motion.)";

constexpr const char* replay_doc =
    R"(Returns the steps of 'keepout replay', one after another: a Steps. Runs without Python's
lock, on one processor, because each step may depend on the last.

poses: (n, 6) [length]. Each row is a tip and a desired increment. With closed_loop, it is a goal
and a reset position; the tip starts at the first reset position.
max_step: longest desired increment in a closed loop [length].
out: a Steps to write to; None for a new one.)";

constexpr const char* simulate_doc =
    R"(Runs closed loops: in each cycle the tip moves towards the commanded position, as far as the
step allows. Returns a Simulation. Loops are independent; one thread runs each. Runs without
Python's lock.

starts: (m, 3), the tips at the start [length].
hands: (m, cycles, 3), the commanded position in each cycle [length].
max_step: longest desired increment of a cycle, at most the radius [length].
threads: 1 to 1024; None: one for each processor.
out: a Simulation to write to; None for a new one.)";

constexpr const char* polytope_doc =
    R"(Returns the free space around a tip as one convex polytope, for a QP, an MPC or a sampler of
your own: a Polytope. Every motion that stays within all planes and within `radius` maintains the
required clearance, or the distance of the tip if that is less. The status is 'inside' for a tip on
the forbidden side, and 'unsupported' if there are guides or the rule guards a tool.

tip: (3,) [length]; radius >= 0 [length].)";

void bind_batches(py::class_<Guard>& type) {
  type.def("steps", &Guard::steps, py::arg("tips"), py::arg("desired"), py::kw_only(),
           py::arg("threads") = py::none(), py::arg("out") = py::none(), steps_doc)
      .def("replay", &Guard::replay, py::arg("poses"), py::kw_only(),
           py::arg("closed_loop") = false, py::arg("max_step") = 1.0, py::arg("out") = py::none(),
           replay_doc)
      .def("simulate", &Guard::simulate, py::arg("starts"), py::arg("hands"), py::kw_only(),
           py::arg("max_step") = 0.5, py::arg("threads") = py::none(), py::arg("out") = py::none(),
           simulate_doc);
}

}  // namespace

void bind_motion_constraint(py::module_& module) {
  const std::string doc = documented<MotionConstraintSettings>(class_doc);
  py::class_<Guard> type(module, "MotionConstraint", doc.c_str());
  bind_guard<MotionConstraintSettings>(
      type, "MotionConstraint", constraint_signature, py::init(&make_guard), py::arg("mesh"),
      py::kw_only(), py::arg("index") = "wide_bvh", py::arg("index_cache") = py::none(),
      py::arg("tool") = py::none());
  bind_batches(type);
  type.def("step", &Guard::step, py::arg("tip"), py::arg("desired"),
           py::arg("jacobian") = py::none(), py::arg("rows") = py::none(), step_doc)
      .def("follow", &Guard::follow, py::arg("index"),
           "Follows a mesh that has moved. Takes an Index of the moved mesh, such as\n"
           "index.refitted(mesh). All tips are classified again. If a tip is not classified\n"
           "(open mesh, or inside='taken_as_is'), keepout does not detect that a surface has\n"
           "moved over it.")
      .def("free_polytope", &Guard::free_polytope, py::arg("tip"), py::arg("radius"), polytope_doc)
      .def_property_readonly(
          "tool", [](const Guard& self) { return self.settings().tool; },
          "The ConvexTool that must not touch the mesh; None for the ball.")
      .def_property_readonly(
          "distance_kept",
          [](const Guard& self) { return required_clearance(self.settings().options); },
          "Required clearance of the tip, or of the whole tool: tool radius and margin\n"
          "[length].")
      .def("__repr__", &repr);
}

}  // namespace keepout::python
