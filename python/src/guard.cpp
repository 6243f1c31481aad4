// SPDX-License-Identifier: BSD-3-Clause
#include "guard.h"

#include <algorithm>
#include <utility>

#include "arrays.h"

namespace keepout::python {
namespace {

/// Column-major.
using Jacobian = py::array_t<double, py::array::f_style | py::array::forcecast>;

// Functions on points (n, 3), or on one point (3,) that serves all.

py::ssize_t count_of(const Doubles& points) { return points.ndim() == 1 ? 1 : points.shape(0); }

Vec3 point_of(const Doubles& points, std::size_t i) {
  return row(points.data(), count_of(points) == 1 ? 0 : i);
}

/// Returns the increment, shortened to at most `longest`, as the keepout command does. [length]
Vec3 clipped(const Vec3& increment, double longest) {
  const double length = increment.norm();
  return length > longest ? Vec3(increment * (longest / length)) : increment;
}

void require_max_step(double max_step, double radius) {
  if (!(max_step >= 0.0) || max_step > radius) {
    refuse("max_step", "0 to the radius of the motion sphere, " + std::to_string(radius),
           std::to_string(max_step));
  }
}

/// The arrays that a batch writes to. `room` keeps the memory of the pointers alive.
struct StepColumns {
  py::tuple room;
  double* points;  // motions (count, 3); of a simulation, the tips (loops, cycles + 1, 3)
  std::uint8_t* status;
  std::uint32_t* planes;

  /// Returns the keepout.Steps or keepout.Simulation.
  py::object result() const { return room[0]; }
};

/// Returns the columns of `out`; for None, of a new result of that type and size. See room_for in
/// _results.py, which throws Error for arrays that cannot be written to.
StepColumns columns(const char* type, const py::tuple& size, const py::object& out,
                    const py::tuple& inputs) {
  const py::module_ results = py::module_::import("keepout._results");
  const py::tuple room = results.attr("room_for")(results.attr(type), size, out, inputs);
  const auto memory = [&](int i) { return py::array(room[i]).mutable_data(); };
  return {room, static_cast<double*>(memory(1)), static_cast<std::uint8_t*>(memory(2)),
          static_cast<std::uint32_t*>(memory(3))};
}

/// Writes the result of a step in a batch, except the motion. Leaves out Step::triangles: with a
/// rule that uses the index's traversal it depends on the last trials, and so on the worker.
void write(const StepColumns& columns, std::size_t i, const Step& step) {
  columns.status[i] = static_cast<std::uint8_t>(step.status);
  columns.planes[i] = static_cast<std::uint32_t>(step.planes.size());
}

void write(double* points, std::size_t i, const Vec3& point) {
  std::copy_n(point.data(), 3, points + 3 * i);
}

/// Runs one loop: the tip follows the commanded positions as far as the steps allow.
void run_loop(MotionConstraint& constraint, Vec3 tip, const double* hand, std::size_t loop,
              std::size_t cycles, double max_step, const StepColumns& to,
              const std::stop_token& stop) {
  constraint.forget();
  const std::size_t first_tip = loop * (cycles + 1);
  write(to.points, first_tip, tip);
  for (std::size_t cycle = 0; cycle < cycles && !stop.stop_requested(); ++cycle) {
    const std::size_t i = loop * cycles + cycle;
    const Step step =
        constraint.step({.tip = tip, .desired = clipped(row(hand, i) - tip, max_step)});
    tip += step.motion;
    write(to.points, first_tip + cycle + 1, tip);
    write(to, i, step);
  }
}

}  // namespace

Guard::Guard(std::shared_ptr<IndexHandle> index, MotionConstraintSettings settings)
    : GuardOf(std::move(index), std::move(settings), [](const auto& on, const auto& made_as) {
        return make_motion_constraint(on->mesh, on->index, made_as);
      }) {}

MotionConstraint Guard::made_anew() const {
  return make_motion_constraint(index()->mesh, index()->index, settings_);
}

StepResult Guard::step(const py::object& tip, const py::object& desired, const py::object& jacobian,
                       const py::object& rows) {
  Motion motion{.tip = point(tip, "tip"), .desired = point(desired, "desired")};
  Jacobian j;
  Doubles matrix;
  Doubles bounds;
  py::ssize_t variables = 3;
  if (!jacobian.is_none()) {
    j = converted<Jacobian>(numbers(jacobian, {"jacobian", {3, any}, "(3, n)"}), "jacobian",
                            "numbers that fit a double");
    variables = j.shape(1);
    if (variables == 0) refuse("jacobian", "a column for each joint, (3, n)", "none, (3, 0)");
    motion.jacobian.emplace(j.data(), variables);
  }
  if (!rows.is_none()) {
    if (!py::isinstance<py::sequence>(rows) || py::len(rows) != 2) {
      refuse("rows", "a pair: a matrix (m, n) and bounds (m,), as in matrix @ u >= bounds",
             Py_TYPE(rows.ptr())->tp_name);
    }
    const auto pair = py::reinterpret_borrow<py::sequence>(rows);
    const std::string text = "(m, " + std::to_string(variables) + ")";
    matrix = doubles(pair[0], {"rows[0]", {any, variables}, text});
    const py::ssize_t count = matrix.shape(0);
    const std::string length = "(" + std::to_string(count) + ",)";
    bounds = doubles(pair[1], {"rows[1]", {count}, length});
    if (count > 0) motion.rows.emplace(matrix.data(), bounds.data(), count);
  }
  const InUse in_use(constraint_in_use_);
  const Step step = constraint_.step(motion);
  return {step,
          {step.increment.begin(), step.increment.end()},
          {{step.planes.begin(), step.planes.end()}},
          {step.active.begin(), step.active.end()},
          {step.guides.begin(), step.guides.end()}};
}

FreeSpace Guard::free_polytope(const py::object& tip, double radius) {
  const Vec3 at = point(tip, "tip");
  const InUse in_use(constraint_in_use_);
  const Polytope polytope = constraint_.free_polytope(at, radius);
  return {{{polytope.planes.begin(), polytope.planes.end()}}, polytope.status};
}

void Guard::follow(std::shared_ptr<IndexHandle> index) {
  replace_mesh(0, index, [&] { constraint_.follow(index->mesh, index->index); });
}

py::object Guard::steps(const py::object& tips, const py::object& desired,
                        std::optional<py::ssize_t> threads, const py::object& out) {
  const Doubles from = doubles(tips, {"tips", {any, 3}, "(n, 3) or (3,)", OneForAll::allowed});
  const py::ssize_t many = count_of(from) == 1 ? any : count_of(from);
  const std::string shape = many == any
                                ? "(n, 3) or (3,)"
                                : "(" + std::to_string(many) + ", 3), as many as tips, or (3,)";
  const Doubles wanted = doubles(desired, {"desired", {any, 3}, shape, OneForAll::allowed});
  if (many != any && count_of(wanted) != 1 && count_of(wanted) != many) {
    refuse("desired", "numbers of shape " + shape, "shape " + shape_text(wanted));
  }
  const py::ssize_t count = many == any ? count_of(wanted) : many;
  const auto poses = static_cast<std::size_t>(count);
  const StepColumns to = columns("Steps", py::make_tuple(count), out, py::make_tuple(from, wanted));
  do_each(poses, 64, threads_for(poses, threads),
          [&](MotionConstraint& constraint, std::size_t i, const std::stop_token&) {
            // The result must not depend on the worker's previous pose.
            constraint.forget();
            const Step step =
                constraint.step({.tip = point_of(from, i), .desired = point_of(wanted, i)});
            write(to.points, i, step.motion);
            write(to, i, step);
          });
  return to.result();
}

py::object Guard::replay(const py::object& poses, bool closed_loop, double max_step,
                         const py::object& out) {
  const Doubles lines = doubles(poses, {"poses", {any, 6}, "(n, 6)"});
  const auto count = static_cast<std::size_t>(lines.shape(0));
  if (closed_loop) require_max_step(max_step, settings_.options.radius);
  const StepColumns to =
      columns("Steps", py::make_tuple(lines.shape(0)), out, py::make_tuple(lines));
  const double* const data = lines.data();
  // One item on one thread: each step may depend on the last.
  do_each(1, 1, 1, [&](MotionConstraint& constraint, std::size_t, const std::stop_token& stop) {
    constraint.forget();
    Vec3 tip = count > 0 ? row(data, 1) : Vec3::Zero();
    for (std::size_t i = 0; i < count && !stop.stop_requested(); ++i) {
      const Vec3 first = row(data, 2 * i);
      const Motion motion = closed_loop
                                ? Motion{.tip = tip, .desired = clipped(first - tip, max_step)}
                                : Motion{.tip = first, .desired = row(data, 2 * i + 1)};
      const Step step = constraint.step(motion);
      write(to.points, i, step.motion);
      write(to, i, step);
      tip += step.motion;
    }
  });
  return to.result();
}

py::object Guard::simulate(const py::object& starts, const py::object& hands, double max_step,
                           std::optional<py::ssize_t> threads, const py::object& out) {
  const Doubles from = doubles(starts, {"starts", {any, 3}, "(m, 3)"});
  const std::string shape = "(" + std::to_string(from.shape(0)) + ", cycles, 3), as many as starts";
  const Doubles paths = doubles(hands, {"hands", {from.shape(0), any, 3}, shape});
  require_max_step(max_step, settings_.options.radius);
  const auto loops = static_cast<std::size_t>(paths.shape(0));
  const auto cycles = static_cast<std::size_t>(paths.shape(1));
  const StepColumns to = columns("Simulation", py::make_tuple(paths.shape(0), paths.shape(1)), out,
                                 py::make_tuple(from, paths));
  const double* const tips = from.data();
  const double* const hand = paths.data();
  do_each(loops, 1, threads_for(loops, threads),
          [&](MotionConstraint& constraint, std::size_t i, const std::stop_token& stop) {
            run_loop(constraint, row(tips, i), hand, i, cycles, max_step, to, stop);
          });
  return to.result();
}

}  // namespace keepout::python
