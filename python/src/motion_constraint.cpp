// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <array>
#include <string>
#include <utility>

#include "guard.h"
#include "keywords.h"

namespace keepout::python {
namespace {

constexpr std::array<std::string_view, 23> arguments = {
    "mesh",          "index",       "index_cache",  "activation", "solver",    "radius",
    "tool_radius",   "tool",        "narrow_phase", "margin",     "damping",   "recovery",
    "deepest",       "refinements", "nodes",        "query",      "distances", "inside",
    "max_triangles", "max_planes",  "max_joints",   "max_rows",   "max_looks"};

py::str repr(const Guard& guard) {
  const MotionConstraintSettings& s = guard.settings();
  return py::str(
             "<keepout.MotionConstraint index='{}' activation='{}' solver='{}' radius={:g} "
             "{}={} margin={:g} on {} triangles>")
      .format(guard.index()->name, s.activation, s.solver, s.radius,
              s.tool ? "tool" : "tool_radius",
              s.tool ? py::repr(py::cast(*s.tool)) : py::str("{:g}").format(s.tool_radius),
              s.margin, guard.index()->mesh->triangle_count());
}

constexpr const char* class_doc =
    R"(Keeps a tool tip out of a mesh, step by step. It is safe to use from several threads, which
then wait for each other; for loops of their own give each a constraint, and let them share
the Index.

index: a name of indices(), or an Index of this mesh. index_cache: a folder that keeps built
indices for the next start. activation, solver: a name of activations(), solvers().
radius: of the motion sphere, the farthest that the tip may go in a step [length].
tool_radius: of the ball around the tip that shall not touch the mesh [length].
tool: a ConvexTool that shall not touch it in place of the ball; leave tool_radius and activation
as they are: inside, refinements and nodes have no effect. narrow_phase: a name of narrow_phases().
margin: distance to keep beyond that [length].
damping: weight of |u|^2 beside the task; above 0 with more than three joints, such as 1e-6 of
a squared column of the Jacobian.
recovery: how far a tip that is too close is led away in a step [length].
deepest: no tip is led out from deeper inside [length].
refinements: how often a certified motion is improved upon.
nodes: of a branch and bound for a better motion still; 0: none.
query: 'motion' looks for triangles as far as the motion can lead, 'sphere' in the whole ball.
distances: of which tips Step.distance is told, 'where_known' or 'always'.
inside: a tip that starts on the forbidden side is 'led_out' or 'taken_as_is'.
max_triangles, max_planes, max_joints, max_rows: room for a step; one that needs more ends
with Status.over_capacity. max_looks: the work of a step, a look taking some 50 ns to 100 ns; what
cannot be proven with it is not moved. 0: 65536 on wide_bvh, 4194304 on other indices.)";

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

}  // namespace

void bind_motion_constraint(py::module_& module) {
  const MotionConstraintSettings usual;
  py::class_<Guard>(module, "MotionConstraint", class_doc)
      .def(py::init([](const py::object& mesh, const py::object& index,
                       const std::optional<std::filesystem::path>& index_cache,
                       std::string activation, std::string solver, double radius,
                       double tool_radius, std::optional<ConvexTool> tool, std::string narrow_phase,
                       double margin, double damping, double recovery, double deepest,
                       int refinements, int nodes, const std::string& query,
                       const std::string& distances, const std::string& inside,
                       py::ssize_t max_triangles, py::ssize_t max_planes, py::ssize_t max_joints,
                       py::ssize_t max_rows, py::ssize_t max_looks, const py::kwargs& others) {
             refuse_others("MotionConstraint", others, arguments);
             MotionConstraintSettings settings;
             settings.activation = std::move(activation);
             settings.solver = std::move(solver);
             settings.radius = radius;
             settings.tool_radius = tool_radius;
             settings.tool = std::move(tool);
             settings.narrow_phase = std::move(narrow_phase);
             settings.margin = margin;
             settings.damping = damping;
             settings.recovery = recovery;
             settings.deepest = deepest;
             settings.refinements = refinements;
             settings.nodes = nodes;
             settings.query = named<Query>(
                 "query", query, {{{"motion", Query::motion}, {"sphere", Query::sphere}}});
             settings.distances = named<Distances>(
                 "distances", distances,
                 {{{"where_known", Distances::where_known}, {"always", Distances::always}}});
             settings.inside = named<Inside>(
                 "inside", inside,
                 {{{"led_out", Inside::led_out}, {"taken_as_is", Inside::taken_as_is}}});
             settings.capacity.triangles = count(max_triangles, "max_triangles");
             settings.capacity.planes = count(max_planes, "max_planes");
             settings.capacity.variables = count(max_joints, "max_joints");
             settings.capacity.extra_rows = count(max_rows, "max_rows");
             settings.capacity.looks = count(max_looks, "max_looks");
             return std::make_unique<Guard>(index_from(mesh, index, index_cache),
                                            std::move(settings));
           }),
           py::arg("mesh"), py::kw_only(), py::arg("index") = usual.index,
           py::arg("index_cache") = py::none(), py::arg("activation") = usual.activation,
           py::arg("solver") = usual.solver, py::arg("radius") = usual.radius,
           py::arg("tool_radius") = usual.tool_radius, py::arg("tool") = py::none(),
           py::arg("narrow_phase") = usual.narrow_phase, py::arg("margin") = usual.margin,
           py::arg("damping") = usual.damping, py::arg("recovery") = usual.recovery,
           py::arg("deepest") = usual.deepest, py::arg("refinements") = usual.refinements,
           py::arg("nodes") = usual.nodes, py::arg("query") = "motion",
           py::arg("distances") = "where_known", py::arg("inside") = "led_out",
           py::arg("max_triangles") = usual.capacity.triangles,
           py::arg("max_planes") = usual.capacity.planes,
           py::arg("max_joints") = usual.capacity.variables,
           py::arg("max_rows") = usual.capacity.extra_rows,
           py::arg("max_looks") = usual.capacity.looks)
      .def("step", &Guard::step, py::arg("tip"), py::arg("desired"),
           py::arg("jacobian") = py::none(), py::arg("rows") = py::none(), step_doc)
      .def("forget", &Guard::forget,
           "Forgets where the last step led: the next tip is placed anew, as at the start.")
      .def(
          "set_guides", &Guard::set_guides, py::arg("guides"),
          "Keeps the tip in the regions of these guides as well, instead of those that there are:\n"
          "a list of at most 16 Guide.point(name, region). In steps and batches from now on.")
      .def(
          "follow", &Guard::follow, py::arg("index"),
          "Goes on with anatomy that has moved: an Index of the moved mesh, such as\n"
          "index.refitted(mesh). All tips are placed anew. Whether a surface has moved over a tip\n"
          "whose side is not asked about, of an open mesh or with inside='taken_as_is', nothing\n"
          "tells.")
      .def("free_polytope", &Guard::free_polytope, py::arg("tip"), py::arg("radius"), polytope_doc)
      .def("steps", &Guard::steps, py::arg("tips"), py::arg("desired"), py::kw_only(),
           py::arg("threads") = py::none(), py::arg("out") = py::none(), steps_doc)
      .def("replay", &Guard::replay, py::arg("poses"), py::kw_only(),
           py::arg("closed_loop") = false, py::arg("max_step") = 1.0, py::arg("out") = py::none(),
           replay_doc)
      .def("simulate", &Guard::simulate, py::arg("starts"), py::arg("hands"), py::kw_only(),
           py::arg("max_step") = 0.5, py::arg("threads") = py::none(), py::arg("out") = py::none(),
           simulate_doc)
      .def_property_readonly(
          "mesh", [](const Guard& self) { return self.index()->mesh_object; }, "The mesh.")
      .def_property_readonly("index", &Guard::index, "Its Index, which others may share.")
      .def_property_readonly(
          "radius", [](const Guard& self) { return self.settings().radius; },
          "Of the motion sphere [length].")
      .def_property_readonly(
          "tool_radius", [](const Guard& self) { return self.settings().tool_radius; },
          "Of the ball around the tip that shall not touch the mesh [length].")
      .def_property_readonly(
          "margin", [](const Guard& self) { return self.settings().margin; },
          "Distance that is kept beyond that, or from the tool [length].")
      .def_property_readonly(
          "tool", [](const Guard& self) { return self.settings().tool; },
          "The ConvexTool that shall not touch the mesh; None for the ball.")
      .def_property_readonly(
          "distance_kept",
          [](const Guard& self) { return self.settings().tool_radius + self.settings().margin; },
          "From the tip, or all of the tool, to the mesh: tool radius and margin [length].")
      .def("__repr__", &repr);
}

}  // namespace keepout::python
