// SPDX-License-Identifier: BSD-3-Clause
#include "guard.h"

#include <cmath>
#include <utility>

#include "arguments.h"
#include "keepout/error.h"

namespace keepout::python {
namespace {

/// Takes a lock that another thread of Python's may hold, which needs Python's own to go on: never
/// waits for it while holding that.
class InUse {
 public:
  explicit InUse(std::mutex& mutex) : lock_(mutex, std::try_to_lock) {
    if (lock_.owns_lock()) return;
    const py::gil_scoped_release release;
    lock_.lock();
  }

 private:
  std::unique_lock<std::mutex> lock_;
};

/// Column by column.
using Jacobian = py::array_t<double, py::array::f_style | py::array::forcecast>;

/// The increment, shortened to at most `longest`: as the keepout command does. [length]
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

/// What there is to know of a step in a batch, but for its motion. How many triangles it rests on
/// is left out: a rule that searches an index has that depend on where it searched before, and so
/// on which worker did the pose.
void write(const StepColumns& columns, std::size_t i, const Step& step) {
  columns.status[i] = static_cast<std::uint8_t>(step.status);
  columns.planes[i] = static_cast<std::uint32_t>(step.planes.size());
}

void write(double* points, std::size_t i, const Vec3& point) {
  points[3 * i] = point.x();
  points[3 * i + 1] = point.y();
  points[3 * i + 2] = point.z();
}

/// One loop: the tip follows the hand as far as the steps lead.
void run_loop(MotionConstraint& constraint, Vec3 tip, const double* hand, std::size_t loop,
              std::size_t cycles, double max_step, const StepColumns& to,
              const std::stop_token& stop) {
  constraint.forget();
  const std::size_t first_tip = loop * (cycles + 1);
  write(to.motions, first_tip, tip);
  for (std::size_t cycle = 0; cycle < cycles && !stop.stop_requested(); ++cycle) {
    const std::size_t i = loop * cycles + cycle;
    const Step step =
        constraint.step({.tip = tip, .desired = clipped(row(hand, i) - tip, max_step)});
    tip += step.motion;
    write(to.motions, first_tip + cycle + 1, tip);
    write(to, i, step);
  }
}

}  // namespace

Guard::Guard(std::shared_ptr<IndexHandle> index, MotionConstraintSettings settings)
    : index_(std::move(index)), settings_(std::move(settings)), constraint_(make()) {}

MotionConstraint Guard::make() const {
  const py::gil_scoped_release release;
  return make_motion_constraint(index_->mesh(), index_->shared(), settings_);
}

std::deque<MotionConstraint>& Guard::workers(unsigned threads) {
  while (workers_.size() < threads) {
    workers_.push_back(make_motion_constraint(index_->mesh(), index_->shared(), settings_));
  }
  return workers_;
}

StepResult Guard::step(const py::object& tip, const py::object& desired, const py::object& jacobian,
                       const py::object& rows) {
  Motion motion{.tip = point(tip, "tip"), .desired = point(desired, "desired")};
  Jacobian j;
  Doubles matrix;
  Doubles bounds;
  py::ssize_t variables = 3;
  if (!jacobian.is_none()) {
    j = Jacobian::ensure(numbers(jacobian, {"jacobian", {3, any}, "(3, n)"}));
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
  return StepResult(constraint_.step(motion));
}

FreeSpace Guard::free_polytope(const py::object& tip, double radius) {
  const Vec3 at = point(tip, "tip");
  const InUse in_use(constraint_in_use_);
  const Polytope polytope = constraint_.free_polytope(at, radius);
  return {{{polytope.planes.begin(), polytope.planes.end()}}, polytope.status};
}

void Guard::forget() {
  const InUse in_use(constraint_in_use_);
  constraint_.forget();
}

py::object Guard::steps(const py::object& tips, const py::object& desired,
                        std::optional<py::ssize_t> threads, const py::object& out) {
  const Doubles from = doubles(tips, {"tips", {any, 3}, "(n, 3) or (3,)", OneForAll::allowed});
  const Points tip(from);
  const py::ssize_t many = tip.count() == 1 ? any : tip.count();
  const std::string shape = many == any
                                ? "(n, 3) or (3,)"
                                : "(" + std::to_string(many) + ", 3), as many as tips, or (3,)";
  const Doubles wanted = doubles(desired, {"desired", {any, 3}, shape, OneForAll::allowed});
  const Points aim(wanted);
  if (many != any && aim.count() != 1 && aim.count() != many) {
    refuse("desired", "numbers of shape " + shape, "shape " + shape_text(wanted));
  }
  const py::ssize_t count = tip.count() == 1 ? aim.count() : tip.count();
  const auto poses = static_cast<std::size_t>(count);
  const StepColumns to = steps_columns(out, count, {from, wanted});
  const unsigned crew = threads_for(poses, threads);
  {
    const py::gil_scoped_release release;
    const std::lock_guard in_use(workers_in_use_);
    std::deque<MotionConstraint>& constraints = workers(crew);
    const Work work = [&](unsigned worker, std::size_t begin, std::size_t end,
                          const std::stop_token& stop) {
      MotionConstraint& constraint = constraints[worker];
      for (std::size_t i = begin; i < end && !stop.stop_requested(); ++i) {
        // Or the answer would depend on which pose this worker did before.
        constraint.forget();
        const Step step = constraint.step({.tip = tip[i], .desired = aim[i]});
        write(to.motions, i, step.motion);
        write(to, i, step);
      }
    };
    constexpr std::size_t chunk = 64;
    if (poses <= chunk) {
      // A thread takes longer to start.
      work(0, 0, poses, std::stop_token());
    } else {
      run_batch(poses, chunk, crew, work);
    }
  }
  return to.result;
}

py::object Guard::replay(const py::object& poses, bool closed_loop, double max_step,
                         const py::object& out) {
  const Doubles lines = doubles(poses, {"poses", {any, 6}, "(n, 6)"});
  const auto count = static_cast<std::size_t>(lines.shape(0));
  if (closed_loop) require_max_step(max_step, settings_.radius);
  const StepColumns to = steps_columns(out, lines.shape(0), {lines});
  const double* const data = lines.data();
  {
    const py::gil_scoped_release release;
    const std::lock_guard in_use(workers_in_use_);
    MotionConstraint& constraint = workers(1).front();
    constraint.forget();
    // One after another, whatever the number of processors: each step may depend on the last.
    run_batch(1, 1, 1, [&](unsigned, std::size_t, std::size_t, const std::stop_token& stop) {
      Vec3 tip = count > 0 ? row(data, 1) : Vec3::Zero();
      for (std::size_t i = 0; i < count && !stop.stop_requested(); ++i) {
        const Vec3 first = row(data, 2 * i);
        const Motion motion = closed_loop
                                  ? Motion{.tip = tip, .desired = clipped(first - tip, max_step)}
                                  : Motion{.tip = first, .desired = row(data, 2 * i + 1)};
        const Step step = constraint.step(motion);
        write(to.motions, i, step.motion);
        write(to, i, step);
        tip += step.motion;
      }
    });
  }
  return to.result;
}

py::object Guard::simulate(const py::object& starts, const py::object& hands, double max_step,
                           std::optional<py::ssize_t> threads, const py::object& out) {
  const Doubles from = doubles(starts, {"starts", {any, 3}, "(m, 3)"});
  const std::string shape = "(" + std::to_string(from.shape(0)) + ", cycles, 3), as many as starts";
  const Doubles paths = doubles(hands, {"hands", {from.shape(0), any, 3}, shape});
  require_max_step(max_step, settings_.radius);
  const auto loops = static_cast<std::size_t>(paths.shape(0));
  const auto cycles = static_cast<std::size_t>(paths.shape(1));
  const StepColumns to = simulation_columns(out, paths.shape(0), paths.shape(1), {from, paths});
  const unsigned crew = threads_for(loops, threads);
  const double* const tips = from.data();
  const double* const hand = paths.data();
  {
    const py::gil_scoped_release release;
    const std::lock_guard in_use(workers_in_use_);
    std::deque<MotionConstraint>& constraints = workers(crew);
    run_batch(
        loops, 1, crew,
        [&](unsigned worker, std::size_t begin, std::size_t end, const std::stop_token& stop) {
          for (std::size_t i = begin; i < end; ++i) {
            run_loop(constraints[worker], row(tips, i), hand, i, cycles, max_step, to, stop);
          }
        });
  }
  return to.result;
}

}  // namespace keepout::python
