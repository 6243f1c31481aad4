// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <type_traits>
#include <utility>
#include <vector>

#include "keepout/robot/instrument_constraint.h"
#include "keepout/step/motion_constraint.h"

namespace keepout {

/// A pool of constraints for the threads of a planner. A constraint is for one thread at a time,
/// but OMPL calls validators from several threads. So each call borrows a constraint, and the pool
/// makes another one if all are in use. Guard is MotionConstraint or InstrumentConstraint.
template <class Guard>
class GuardPoolOf {
 public:
  /// The options of a constraint.
  using Options = std::remove_cvref_t<decltype(std::declval<const Guard&>().options())>;

  /// Makes a pool with one constraint. `make`: builds equal constraints on a shared mesh and index
  /// (make_motion_constraint, make_instrument_constraint). `most`: the largest number of
  /// constraints; further threads wait. Passes on the Error of `make` for wrong settings. Also
  /// throws Error if `make` is empty or `most` is 0. If `make` throws later, the thread waits for
  /// an existing constraint.
  explicit GuardPoolOf(std::function<Guard()> make, std::size_t most = cores());

  GuardPoolOf(const GuardPoolOf&) = delete;
  GuardPoolOf& operator=(const GuardPoolOf&) = delete;

  /// Returns a constraint to its pool when a loan ends.
  struct GiveBack {
    GuardPoolOf* pool;  // the pool of the constraint
    /// Returns the constraint to the pool.
    void operator()(Guard* guard) const noexcept;
  };
  /// A borrowed constraint. It must not outlive the pool.
  using Loan = std::unique_ptr<Guard, GiveBack>;

  /// Borrows a constraint. Waits while `most` constraints are in use. A thread that borrows a
  /// second constraint before it returns the first may wait forever.
  Loan borrow();

  /// Returns the options of the constraints.
  const Options& options() const noexcept { return options_; }
  /// Returns the number of constraints made so far.
  std::size_t made() const;

 private:
  static std::size_t cores() noexcept;
  std::unique_ptr<Guard> made_anew(std::unique_lock<std::mutex>& lock);

  std::function<Guard()> make_;
  std::size_t most_;
  Options options_;
  mutable std::mutex mutex_;
  std::condition_variable returned_;
  std::vector<std::unique_ptr<Guard>> free_;
  std::size_t made_ = 0;
};

/// The pool for planning with a tip.
using GuardPool = GuardPoolOf<MotionConstraint>;
/// The pool for planning with a whole instrument.
using InstrumentPool = GuardPoolOf<InstrumentConstraint>;

extern template class GuardPoolOf<MotionConstraint>;
extern template class GuardPoolOf<InstrumentConstraint>;

}  // namespace keepout
