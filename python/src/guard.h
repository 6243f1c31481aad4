// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <optional>

#include "guard_of.h"

namespace keepout::python {

/// A motion constraint as Python holds it.
class Guard : public GuardOf<MotionConstraint, MotionConstraintSettings> {
 public:
  Guard(std::shared_ptr<IndexHandle> index, MotionConstraintSettings settings);

  // As in Python: see bind_motion_constraint.
  StepResult step(const py::object& tip, const py::object& desired, const py::object& jacobian,
                  const py::object& rows);
  FreeSpace free_polytope(const py::object& tip, double radius);
  void follow(std::shared_ptr<IndexHandle> index);
  py::object steps(const py::object& tips, const py::object& desired,
                   std::optional<py::ssize_t> threads, const py::object& out);
  py::object replay(const py::object& poses, bool closed_loop, double max_step,
                    const py::object& out);
  py::object simulate(const py::object& starts, const py::object& hands, double max_step,
                      std::optional<py::ssize_t> threads, const py::object& out);

 private:
  MotionConstraint made_anew() const override;
};

}  // namespace keepout::python
