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
    R"(Keeps a tool tip out of a mesh, step by step. It is safe to use from several threads, which
then wait for each other; for loops of their own give each a constraint, and let them share
the Index.

index: a name of indices(), or an Index of this mesh. index_cache: a directory that keeps built
indices for the next start. tool: a ConvexTool, or the text of one, that must not touch the mesh, in place of the ball;
leave tool_radius and activation as they are: inside, refinements and nodes have no effect.
A max_... is a capacity: a step that needs more ends with Status.over_capacity.)";

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
    R"(The allowed motion nearest to the one desired: a Step. It remembers where the last step led; a
tip from elsewhere is placed anew. A number that is not finite gives Status.invalid_input.

tip: (3,) in the frame of the mesh [length]. desired: (3,), the increment asked for [length].
jacobian: (3, n), of the tip in the joints that move it [length / unit of the joint]; with n
above 3 give the constraint a damping above 0, or the step is Status.ill_posed.
rows: a pair, matrix (m, n) and bounds (m,), which the increment u of the joints (or of the
tip, n = 3) must satisfy: matrix @ u >= bounds.)";

constexpr const char* steps_doc =
    R"(One step for each pose, each for itself: every tip is placed anew, so that the result does not
depend on the order or on the number of threads. Runs without Python's lock. Placing a tip may
take longer than its step; where sides are known, inside='taken_as_is' does without.

tips: (n, 3) [length]. desired: (n, 3) [length]. A single one of either, (3,), serves all of
the other. Taken without a copy if they are float64 and
C-contiguous. threads: 1 to 1024; None for one a processor. out: a Steps to write to; None for
a new one. A pose that is not finite has Status.invalid_input and zero motion.)";

constexpr const char* replay_doc =
    R"(The steps of 'keepout replay', one after another: a Steps. Runs without Python's lock, on one
processor, as each step may depend on the last.

poses: (n, 6) [length]: a tip and a desired increment a row; with closed_loop, a goal and a
reset position, of which the first is where the tip starts. max_step: longest increment asked
for in a closed loop [length]. out: a Steps to write to; None for a new one.)";

constexpr const char* simulate_doc =
    R"(Closed loops: in each cycle the tip makes for where the hand is, as far as the step allows.
Loops share nothing; each is done by one thread. Runs without Python's lock.

starts: (m, 3), where the tips start [length]. hands: (m, cycles, 3), where the hand is in each
cycle [length]. max_step: longest increment asked for in a cycle [length], at most the radius.
threads: 1 to 1024; None for one a processor. out: a Simulation to write to; None for a new one.)";

constexpr const char* polytope_doc =
    R"(The free space around a tip as one convex polytope, for a QP, an MPC or a sampler of your own:
every motion that stays within all planes and within `radius` keeps the margin. Sides are not
asked about: around a tip inside it is the space inside.

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
      .def(
          "follow", &Guard::follow, py::arg("index"),
          "Replaces the mesh by one that has moved: an Index of it, such as index.refitted(mesh).\n"
          "All tips are placed anew. Nothing tells if a surface has moved over a tip whose side "
          "is\n"
          "not checked: of an open mesh or with inside='taken_as_is'.")
      .def("free_polytope", &Guard::free_polytope, py::arg("tip"), py::arg("radius"), polytope_doc)
      .def_property_readonly(
          "tool", [](const Guard& self) { return self.settings().tool; },
          "The ConvexTool that must not touch the mesh; None for the ball.")
      .def_property_readonly(
          "distance_kept",
          [](const Guard& self) { return required_clearance(self.settings().options); },
          "Clearance of the tip, or of all of the tool: tool radius and margin [length].")
      .def("__repr__", &repr);
}

}  // namespace keepout::python
