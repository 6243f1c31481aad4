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

/// Lends constraints to the threads of a planner. A constraint is for one thread at a time, while
/// OMPL asks that validators can be called from many: each call borrows one, and the pool makes
/// another when all are out. There is one of MotionConstraint and one of InstrumentConstraint.
template <class Guard>
class GuardPoolOf {
 public:
  /// What the constraints keep to.
  using Options = std::remove_cvref_t<decltype(std::declval<const Guard&>().options())>;

  /// `make`: builds a constraint, each time the same, on a mesh and an index that all share
  /// (make_motion_constraint, make_instrument_constraint). `most`: how many are made at most;
  /// threads beyond it wait. One is made at once, so that what is wrong with the settings is thrown
  /// here. Throws Error as well when `make` is empty or `most` is 0. Whatever `make` throws later
  /// makes a thread wait for a constraint that is there.
  explicit GuardPoolOf(std::function<Guard()> make, std::size_t most = cores());

  GuardPoolOf(const GuardPoolOf&) = delete;
  GuardPoolOf& operator=(const GuardPoolOf&) = delete;

  /// Gives a constraint back to the pool that it is of.
  struct GiveBack {
    GuardPoolOf* pool;  // where it belongs
    /// To the pool it goes.
    void operator()(Guard* guard) const noexcept;
  };
  /// A constraint for as long as this lives. It must not outlive the pool.
  using Loan = std::unique_ptr<Guard, GiveBack>;

  /// Waits while `most` are out. A thread that borrows a second one before it has given back the
  /// first may wait for ever.
  Loan borrow();

  /// What the constraints keep to.
  const Options& options() const noexcept { return options_; }
  /// How many have been made so far, lent or not.
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

/// For planning with a tip.
using GuardPool = GuardPoolOf<MotionConstraint>;
/// For planning with a whole instrument.
using InstrumentPool = GuardPoolOf<InstrumentConstraint>;

extern template class GuardPoolOf<MotionConstraint>;
extern template class GuardPoolOf<InstrumentConstraint>;

}  // namespace keepout
