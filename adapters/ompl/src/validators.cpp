// SPDX-License-Identifier: BSD-3-Clause
#include <ompl/base/MotionValidator.h>
#include <ompl/base/StateValidityChecker.h>

#include <atomic>
#include <cmath>
#include <mutex>
#include <string>
#include <utility>

#include "keepout/error.h"
#include "keepout/ompl/planning.h"
#include "keepout/ompl/straight_way.h"
#include "tip_space.h"

namespace keepout {

void require_tip_space(const std::shared_ptr<ompl::base::SpaceInformation>& space,
                       const std::shared_ptr<GuardPool>& guards) {
  if (!space) throw Error("planning: there is no SpaceInformation");
  if (!guards) throw Error("planning: there is no GuardPool; make one with std::make_shared");
  const auto* real =
      dynamic_cast<const ompl::base::RealVectorStateSpace*>(space->getStateSpace().get());
  if (real == nullptr || real->getDimension() != 3) {
    throw Error(
        "planning: '" + space->getStateSpace()->getName() + "' has " +
        std::to_string(space->getStateDimension()) +
        " dimensions and is not a RealVectorStateSpace of 3: plan for the tip, in the frame "
        "of the mesh, in std::make_shared<ompl::base::RealVectorStateSpace>(3)");
  }
  const ompl::base::RealVectorBounds& bounds = real->getBounds();
  for (unsigned int i = 0; i < 3; ++i) {
    const bool is_finite = std::isfinite(bounds.low[i]) && std::isfinite(bounds.high[i]);
    if (!is_finite || !(bounds.low[i] < bounds.high[i])) {
      throw Error("planning: the bounds of '" + real->getName() + "' are not set along axis " +
                  std::to_string(i) +
                  ": give it setBounds(), low below high, around the part of the mesh to plan in");
    }
  }
}

Box bounds_of(const ompl::base::SpaceInformation& space) {
  const auto& bounds = space.getStateSpace()->as<ompl::base::RealVectorStateSpace>()->getBounds();
  return {Vec3(bounds.low[0], bounds.low[1], bounds.low[2]),
          Vec3(bounds.high[0], bounds.high[1], bounds.high[2])};
}

namespace {

class CertifiedStates final : public ompl::base::StateValidityChecker {
 public:
  CertifiedStates(const ompl::base::SpaceInformationPtr& space, std::shared_ptr<GuardPool> guards)
      : StateValidityChecker(space), guards_(std::move(guards)) {}

  bool isValid(const ompl::base::State* state) const override {
    return si_->satisfiesBounds(state) && keeps_margin(*guards_->borrow(), tip_of(state));
  }

 private:
  std::shared_ptr<GuardPool> guards_;
};

class CertifiedMotions final : public ompl::base::MotionValidator {
 public:
  CertifiedMotions(const ompl::base::SpaceInformationPtr& space, std::shared_ptr<GuardPool> guards)
      : MotionValidator(space), guards_(std::move(guards)) {}

  bool checkMotion(const ompl::base::State* from, const ompl::base::State* to) const override {
    return counted(si_->satisfiesBounds(to) &&
                   proves(*guards_->borrow(), tip_of(from), tip_of(to)));
  }

  bool checkMotion(const ompl::base::State* from, const ompl::base::State* to,
                   std::pair<ompl::base::State*, double>& last_valid) const override {
    if (checkMotion(from, to)) return true;
    // Only now, as few ask for it. `last_valid.first` may be one of the two, so it is written last.
    ProvenPrefix prefix{.end = tip_of(from)};
    if (si_->satisfiesBounds(to)) {
      prefix = proven_prefix(*guards_->borrow(), tip_of(from), tip_of(to));
    }
    if (last_valid.first != nullptr) put(prefix.end, last_valid.first);
    last_valid.second = prefix.share;
    return false;
  }

 private:
  /// OMPL's own counters are no atomic ones.
  bool counted(bool is_valid) const {
    const std::lock_guard lock(count_);
    ++(is_valid ? valid_ : invalid_);
    return is_valid;
  }

  std::shared_ptr<GuardPool> guards_;
  mutable std::mutex count_;
};

}  // namespace

std::shared_ptr<ompl::base::StateValidityChecker> make_state_validity_checker(
    const std::shared_ptr<ompl::base::SpaceInformation>& space, std::shared_ptr<GuardPool> guards) {
  require_tip_space(space, guards);
  return std::make_shared<CertifiedStates>(space, std::move(guards));
}

std::shared_ptr<ompl::base::MotionValidator> make_motion_validator(
    const std::shared_ptr<ompl::base::SpaceInformation>& space, std::shared_ptr<GuardPool> guards) {
  require_tip_space(space, guards);
  return std::make_shared<CertifiedMotions>(space, std::move(guards));
}

void set_certified_checkers(const std::shared_ptr<ompl::base::SpaceInformation>& space,
                            const std::shared_ptr<GuardPool>& guards) {
  const auto states = make_state_validity_checker(space, guards);
  const auto motions = make_motion_validator(space, guards);
  space->setStateValidityChecker(states);
  space->setMotionValidator(motions);
}

}  // namespace keepout
