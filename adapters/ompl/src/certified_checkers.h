// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ompl/base/MotionValidator.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/StateValidityChecker.h>

#include <mutex>
#include <utility>

namespace keepout {

// The checkers of states and motions for OMPL, for tips and whole instruments. A `Proof` knows the
// meaning of a state. Any thread may call its functions.
//
//   bool stands(state)
//       True if the state is valid.
//
//   bool goes(from, to)
//       True if the whole motion is proven, including both ends.
//
//   double goes_until(from, to, end)
//       The fraction of a motion that is proven from its start on, and the state at its end.

template <class Proof>
class CertifiedStates final : public ompl::base::StateValidityChecker {
 public:
  CertifiedStates(const ompl::base::SpaceInformationPtr& space, Proof proof)
      : StateValidityChecker(space), proof_(std::move(proof)) {}

  bool isValid(const ompl::base::State* state) const override {
    return si_->satisfiesBounds(state) && proof_.stands(state);
  }

 private:
  Proof proof_;
};

template <class Proof>
class CertifiedMotions final : public ompl::base::MotionValidator {
 public:
  CertifiedMotions(const ompl::base::SpaceInformationPtr& space, Proof proof)
      : MotionValidator(space), proof_(std::move(proof)) {}

  bool checkMotion(const ompl::base::State* from, const ompl::base::State* to) const override {
    return counted(si_->satisfiesBounds(to) && proof_.goes(from, to));
  }

  bool checkMotion(const ompl::base::State* from, const ompl::base::State* to,
                   std::pair<ompl::base::State*, double>& last_valid) const override {
    if (checkMotion(from, to)) return true;
    // Computed only here, because few callers need it. Some do not need the state.
    ompl::base::State* const end = si_->cloneState(from);
    last_valid.second = si_->satisfiesBounds(to) ? proof_.goes_until(from, to, end) : 0.0;
    if (last_valid.first != nullptr) si_->copyState(last_valid.first, end);
    si_->freeState(end);
    return false;
  }

 private:
  /// OMPL's own counters are not atomic.
  bool counted(bool is_valid) const {
    const std::lock_guard lock(count_);
    ++(is_valid ? valid_ : invalid_);
    return is_valid;
  }

  Proof proof_;
  mutable std::mutex count_;
};

}  // namespace keepout
