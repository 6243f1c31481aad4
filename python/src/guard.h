// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "bindings.h"
#include "keepout/factory/make_motion_constraint.h"
#include "workers.h"

namespace keepout::python {

/// A motion constraint as Python holds it: one for its own steps, and one for each worker of its
/// batches. All share mesh and index. A batch changes nothing for the steps: they remember where
/// the last of their own led.
class Guard {
 public:
  Guard(std::shared_ptr<IndexHandle> index, MotionConstraintSettings settings);

  // As in Python: see bind_motion_constraint.
  StepResult step(const py::object& tip, const py::object& desired, const py::object& jacobian,
                  const py::object& rows);
  FreeSpace free_polytope(const py::object& tip, double radius);
  void forget();
  void set_guides(std::vector<Guide> guides);
  void follow(std::shared_ptr<IndexHandle> index);
  py::object steps(const py::object& tips, const py::object& desired,
                   std::optional<py::ssize_t> threads, const py::object& out);
  py::object replay(const py::object& poses, bool closed_loop, double max_step,
                    const py::object& out);
  py::object simulate(const py::object& starts, const py::object& hands, double max_step,
                      std::optional<py::ssize_t> threads, const py::object& out);

  const MotionConstraintSettings& settings() const noexcept { return settings_; }
  std::shared_ptr<IndexHandle> index() const { return index_; }

 private:
  MotionConstraint make() const;
  MotionConstraint make_guided() const;

  /// See Workers.
  template <class Item>
  void do_each(std::size_t items, std::size_t chunk, unsigned threads, const Item& item);

  std::shared_ptr<IndexHandle> index_;
  MotionConstraintSettings settings_;
  MotionConstraint constraint_;
  std::mutex constraint_in_use_;
  Workers<MotionConstraint> workers_;
};

}  // namespace keepout::python
