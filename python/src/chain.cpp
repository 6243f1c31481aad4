// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/robot/chain.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "keepout/error.h"
#include "keepout/robot/denavit_hartenberg.h"
#if KEEPOUT_HAS_URDF
#include "keepout/urdf/read_chain.h"
#endif

namespace keepout::python {
namespace {

/// Returns one of two values by its name. Throws Error with the argument for another name.
template <class Enum>
Enum named(std::string_view argument, const std::string& given,
           const std::array<std::pair<std::string, Enum>, 2>& names) {
  for (const auto& [name, value] : names) {
    if (given == name) return value;
  }
  refuse(argument, "'" + names[0].first + "' or '" + names[1].first + "'", "'" + given + "'");
}

using Optional = std::optional<double>;

JointKind kind_of(const std::string& kind) {
  return named<JointKind>(
      "kind", kind, {{{"revolute", JointKind::revolute}, {"prismatic", JointKind::prismatic}}});
}

JointLimits limits_of(Optional lower, Optional upper, Optional velocity, Optional increment) {
  const JointLimits none;
  return {.lower = lower.value_or(none.lower),
          .upper = upper.value_or(none.upper),
          .velocity = velocity.value_or(none.velocity),
          .increment = increment.value_or(none.increment)};
}

const char* kind_name(const Joint& joint) {
  return joint.kind == JointKind::revolute ? "revolute" : "prismatic";
}

/// Returns the pose of the flange for each row of q; NaN if a number is not finite.
py::array_t<double> forward_kinematics(const Chain& chain, const py::object& positions) {
  const auto n = static_cast<py::ssize_t>(chain.size());
  const std::string width = std::to_string(n);
  const std::string text = "(m, " + width + ") or (" + width + ",)";
  const Doubles q = doubles(positions, {"q", {any, n}, text, OneForAll::allowed});
  const py::ssize_t count = q.ndim() == 1 ? 1 : q.shape(0);
  std::vector<py::ssize_t> shape{count, 4, 4};
  if (q.ndim() == 1) shape.erase(shape.begin());
  py::array_t<double> poses(shape);
  ChainState state;
  for (py::ssize_t i = 0; i < count; ++i) {
    const std::span<const double> row(q.data() + i * n, static_cast<std::size_t>(n));
    double* const to = poses.mutable_data() + 16 * i;
    if (std::ranges::all_of(row, [](double x) { return std::isfinite(x); })) {
      chain.forward_kinematics(row, state);
      write(to, state.flange());
    } else {
      std::fill_n(to, 16, std::nan(""));
    }
  }
  return poses;
}

Chain chain_of_table(const std::vector<DenavitHartenberg>& rows, const std::string& convention,
                     const py::object& base, const py::object& flange) {
  auto [joints, end] = joints_of(
      rows, named<DhConvention>(
                "convention", convention,
                {{{"modified", DhConvention::modified}, {"standard", DhConvention::standard}}}));
  return Chain(std::move(joints), pose_of(base, "base"), end * pose_of(flange, "flange"));
}

#if KEEPOUT_HAS_URDF
Chain chain_of_file(const std::filesystem::path& path, const std::string& base,
                    const std::string& tip, double scale) {
  UrdfChain read = read_chain(path, base, tip, scale);
  return Chain(std::move(read.joints), {}, read.flange);
}
#else
Chain chain_of_file(const std::filesystem::path&, const std::string&, const std::string&, double) {
  throw Error(
      "read_chain: this build cannot read URDF; install liburdfdom-dev and liburdfdom-headers-dev, "
      "and rebuild the module, or define the chain with Chain or chain_of_table");
}
#endif

constexpr const char* joint_doc =
    R"(A joint of a chain, and its fixed transform from the link before it.

name: for messages.
kind: 'revolute' turns the links beyond it about the axis [rad]; 'prismatic' moves them along the
axis [length].
origin: (4, 4), the joint's frame in the frame of the link before it; None is the identity.
axis: (3,), a unit vector in the joint's frame; None is z.
lower, upper: limits of its position; None: no limit.
velocity: limit per second, above 0; None: no limit.
increment: limit per cycle, above 0; None: no limit.)";

constexpr const char* row_doc =
    R"(A row of a Denavit-Hartenberg table: a along x [length], alpha about x [rad], d along z
[length], theta about z [rad]. The joint position is added to theta of a revolute joint, or to d of
a prismatic one. The other arguments are as in Joint.)";

constexpr const char* chain_doc =
    R"(A serial chain of revolute and prismatic joints that carries an instrument. Link 0 is the
base; joint k moves link k, counted from 1. Frames are those of URDF.

joints: 1 to 8 of Joint, from the base on.
base: (4, 4), the pose of link 0 in the frame of the mesh; None is the identity.
flange: (4, 4), the frame that a step moves, in the frame of the last link; None is the identity.)";

void bind_joints(py::module_& module) {
  py::class_<Joint>(module, "Joint", joint_doc)
      .def(py::init([](std::string name, const std::string& kind, const py::object& origin,
                       const py::object& axis, Optional lower, Optional upper, Optional velocity,
                       Optional increment) {
             return Joint{std::move(name), kind_of(kind), pose_of(origin, "origin"),
                          axis.is_none() ? Vec3(0, 0, 1) : point(axis, "axis"),
                          limits_of(lower, upper, velocity, increment)};
           }),
           py::arg("name") = "", py::kw_only(), py::arg("kind") = "revolute",
           py::arg("origin") = py::none(), py::arg("axis") = py::none(),
           py::arg("lower") = py::none(), py::arg("upper") = py::none(),
           py::arg("velocity") = py::none(), py::arg("increment") = py::none())
      .def_readonly("name", &Joint::name, "For messages.")
      .def_property_readonly("kind", &kind_name, "'revolute' or 'prismatic'.")
      .def_property_readonly(
          "lower", [](const Joint& self) { return self.limits.lower; },
          "Lower limit of the position [rad or length]; -inf without a limit.")
      .def_property_readonly(
          "upper", [](const Joint& self) { return self.limits.upper; },
          "Upper limit of the position [rad or length]; inf without a limit.")
      .def_property_readonly(
          "velocity", [](const Joint& self) { return self.limits.velocity; },
          "Limit of the velocity [rad/s or length/s]; inf without a limit.")
      .def_property_readonly(
          "increment", [](const Joint& self) { return self.limits.increment; },
          "Limit of the increment of a cycle [rad or length]; inf without a limit.")
      .def("__repr__", [](const Joint& self) {
        return py::str("<keepout.Joint '{}', {}>").format(self.name, kind_name(self));
      });

  py::class_<DenavitHartenberg>(module, "TableRow", row_doc)
      .def(py::init([](std::string name, const std::string& kind, double a, double alpha, double d,
                       double theta, Optional lower, Optional upper, Optional velocity,
                       Optional increment) {
             return DenavitHartenberg{std::move(name),
                                      kind_of(kind),
                                      a,
                                      alpha,
                                      d,
                                      theta,
                                      limits_of(lower, upper, velocity, increment)};
           }),
           py::arg("name") = "", py::kw_only(), py::arg("kind") = "revolute", py::arg("a") = 0.0,
           py::arg("alpha") = 0.0, py::arg("d") = 0.0, py::arg("theta") = 0.0,
           py::arg("lower") = py::none(), py::arg("upper") = py::none(),
           py::arg("velocity") = py::none(), py::arg("increment") = py::none());
}

}  // namespace

void bind_chain(py::module_& module) {
  bind_joints(module);
  py::class_<Chain>(module, "Chain", chain_doc)
      .def(
          py::init([](std::vector<Joint> joints, const py::object& base, const py::object& flange) {
            return Chain(std::move(joints), pose_of(base, "base"), pose_of(flange, "flange"));
          }),
          py::arg("joints"), py::kw_only(), py::arg("base") = py::none(),
          py::arg("flange") = py::none())
      .def("forward_kinematics", &forward_kinematics, py::arg("q"),
           "Returns the pose of the flange in the frame of the mesh: (4, 4) for joint positions\n"
           "(n,), or (m, 4, 4) for (m, n) [rad or length]. The pose is NaN if a position is not\n"
           "finite.")
      .def_property_readonly(
          "joints",
          [](const Chain& self) {
            std::vector<Joint> joints;
            for (int k = 1; k <= self.size(); ++k) joints.push_back(self.joint(k));
            return joints;
          },
          "The joints from the base on: a list of Joint.")
      .def_property_readonly(
          "base", [](const Chain& self) { return matrix_of(self.base()); },
          "(4, 4) float64: the pose of link 0 in the frame of the mesh.")
      .def_property_readonly(
          "flange", [](const Chain& self) { return matrix_of(self.flange()); },
          "(4, 4) float64: the frame that a step moves, in the frame of the last link.")
      .def("__len__", &Chain::size)
      .def("__repr__", [](const Chain& self) {
        return py::str("<keepout.Chain of {} joints>").format(self.size());
      });

  module.def(
      "chain_of_table", &chain_of_table, py::arg("rows"), py::kw_only(),
      py::arg("convention") = "modified", py::arg("base") = py::none(),
      py::arg("flange") = py::none(),
      "Returns a Chain from a list of TableRow.\n"
      "\n"
      "convention: 'modified' (Craig: about x, along x, about z, along z) or 'standard' (about\n"
      "z, along z, along x, about x).\n"
      "base: as in Chain.\n"
      "flange: (4, 4), in the last frame of the table; None is the identity.");
  module.def("read_chain", &chain_of_file, py::arg("path"), py::kw_only(), py::arg("base") = "",
             py::arg("tip") = "", py::arg("scale") = 1000.0,
             "Reads a Chain from a URDF file. Raises Error if this build cannot read URDF.\n"
             "\n"
             "base: the first link; empty for the root.\n"
             "tip: the link of the flange; empty for the only leaf below `base`.\n"
             "scale: the length of a meter in the unit of the mesh.\n"
             "\n"
             "Link 0 is at the origin of the mesh. To move it, make Chain(chain.joints, base=...,\n"
             "flange=chain.flange).");
}

}  // namespace keepout::python
