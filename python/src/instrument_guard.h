// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <optional>
#include <vector>

#include "guard_of.h"

namespace keepout::python {

/// A step that outlives the next one: its own lists hide the views of the robot's step. The
/// increment has a number for each joint, zero unless ok.
struct InstrumentStepResult : InstrumentStep {
  std::vector<double> increment;
  std::vector<GuideState> guides;
  std::vector<DegradedClearance> degraded;
};

/// An instrument constraint as Python holds it.
class InstrumentGuard : public GuardOf<InstrumentConstraint, InstrumentConstraintSettings> {
 public:
  InstrumentGuard(std::shared_ptr<IndexHandle> index, Instrument instrument,
                  InstrumentConstraintSettings settings);

  // The methods of the Python class: see bind_instrument_guard.
  InstrumentStepResult step(const py::object& q, const py::object& linear,
                            const py::object& angular, const py::object& increment,
                            const py::object& weights);
  MotionProof prove(const py::object& q, const py::object& increment);
  py::object proofs(const py::object& q, const py::object& increments,
                    std::optional<py::ssize_t> threads);
  void follow(std::shared_ptr<IndexHandle> index, std::size_t mesh);
  std::size_t add_mesh(std::shared_ptr<IndexHandle> index, double margin);
  void place(std::size_t mesh, const py::object& pose, const py::object& linear,
             const py::object& angular);
  py::array_t<double> place_of(std::size_t mesh);

  const Instrument& instrument() const noexcept { return instrument_; }
  std::size_t mesh_count() const noexcept { return meshes_.size(); }

 private:
  InstrumentConstraint made_anew() const override;
  py::ssize_t joints() const noexcept { return instrument_.chain().size(); }
  /// Reads one number for each joint.
  Doubles of_joints(const py::object& argument, std::string_view name) const;

  /// Calls `take(i, proof)` for each motion. q and increments: (count, n), or (n,) for all.
  template <class Take>
  void prove_each(const Doubles& q, const Doubles& increments, std::size_t count, unsigned threads,
                  const Take& take);

  void require_mesh(std::size_t mesh) const;

  Instrument instrument_;
};

}  // namespace keepout::python
