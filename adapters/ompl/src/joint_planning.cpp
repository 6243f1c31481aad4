// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/ompl/joint_planning.h"

#include <ompl/base/spaces/RealVectorStateSpace.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "certified_checkers.h"
#include "keepout/error.h"
#include "keepout/robot/motion_bounds.h"

namespace keepout {
namespace {

namespace base = ompl::base;

using Joints = std::array<double, Chain::most_joints>;

double* values_of(base::State* state) noexcept {
  return state->as<base::RealVectorStateSpace::StateType>()->values;
}
const double* values_of(const base::State* state) noexcept {
  return state->as<base::RealVectorStateSpace::StateType>()->values;
}

/// See make_joint_space.
class JointSpace final : public base::RealVectorStateSpace {
 public:
  JointSpace(const Chain& chain, const Joints& weights)
      : RealVectorStateSpace(static_cast<unsigned int>(chain.size())), weights_(weights) {
    setName("Joints" + getName());
    base::RealVectorBounds bounds(getDimension());
    for (unsigned int i = 0; i < getDimension(); ++i) {
      const Joint& joint = chain.joint(static_cast<int>(i) + 1);
      bounds.setLow(i, joint.limits.lower);
      bounds.setHigh(i, joint.limits.upper);
      setDimensionName(i, joint.name);
    }
    setBounds(bounds);
  }

  double distance(const base::State* a, const base::State* b) const override {
    return length(values_of(a), values_of(b));
  }

  double getMaximumExtent() const override {
    return length(getBounds().low.data(), getBounds().high.data());
  }

 private:
  double length(const double* a, const double* b) const {
    double square = 0.0;
    for (std::size_t k = 0; k < getDimension(); ++k) {
      const double way = weights_[k] * (a[k] - b[k]);
      square += way * way;
    }
    return std::sqrt(square);
  }

  Joints weights_;
};

/// Returns the largest displacement of a body's point by each joint, for a unit of the joint.
Joints weights_of(const Instrument& instrument) {
  const Chain& chain = instrument.chain();
  Joints weights{};
  ChainState state;
  std::vector<int> at(static_cast<std::size_t>(chain.size()), 0);  // 0, 1, 2: low, middle, high
  std::vector<double> q(at.size());
  while (true) {
    for (std::size_t k = 0; k < at.size(); ++k) {
      const JointLimits& limits = chain.joint(static_cast<int>(k) + 1).limits;
      q[k] = limits.lower + 0.5 * at[k] * (limits.upper - limits.lower);
    }
    chain.forward_kinematics(q, state);
    for (const LinkPoint& point : instrument.points()) {
      const Vec3 place = state.at(point.link, point.position);
      for (int k = 1; k <= point.link; ++k) {
        double& weight = weights[static_cast<std::size_t>(k - 1)];
        weight = std::max(weight, state.linear(k, point.link, place).norm());
      }
    }
    std::size_t next = 0;
    while (next < at.size() && ++at[next] == 3) at[next++] = 0;
    if (next == at.size()) break;
  }
  // Joints that move no point of a body get a weight too, so that different states have a distance.
  for (double& weight : weights) weight = weight > 0.0 ? weight : 1e-3;
  return weights;
}

/// Throws Error unless the space is a joint space and there is a pool.
void require_joint_space(const std::shared_ptr<base::SpaceInformation>& space,
                         const std::shared_ptr<InstrumentPool>& guards) {
  if (!space) throw Error("planning: there is no SpaceInformation");
  if (!guards) throw Error("planning: there is no InstrumentPool; make one by std::make_shared");
  const InstrumentPool::Loan guard = guards->borrow();
  const Chain& chain = guard->instrument().chain();
  const auto* real = dynamic_cast<const base::RealVectorStateSpace*>(space->getStateSpace().get());
  if (real == nullptr || real->getDimension() != static_cast<unsigned int>(chain.size())) {
    throw Error("planning: '" + space->getStateSpace()->getName() + "' has " +
                std::to_string(space->getStateDimension()) +
                " dimensions and is not a RealVectorStateSpace of " + std::to_string(chain.size()) +
                ", one for each joint: use make_joint_space");
  }
  const base::RealVectorBounds& bounds = real->getBounds();
  for (unsigned int i = 0; i < real->getDimension(); ++i) {
    const Joint& joint = chain.joint(static_cast<int>(i) + 1);
    const bool is_range = std::isfinite(bounds.low[i]) && std::isfinite(bounds.high[i]) &&
                          bounds.low[i] < bounds.high[i];
    if (!is_range || bounds.low[i] < joint.limits.lower || bounds.high[i] > joint.limits.upper) {
      throw Error("planning: the bounds of '" + real->getName() + "' along axis " +
                  std::to_string(i) + " are not within the limits of joint '" + joint.name +
                  "', or not set: give it setBounds(), low below high, as far as it may go");
    }
  }
}

/// A motion in pieces. On each piece no point of a body moves farther than the thickest body is
/// wide. A long motion has many triangles near it, but most are far from any one piece, so pieces
/// cost less. Rounding moves the ends of pieces by 1e-16 of a position, a small part of the
/// tolerance.
struct Pieces {
  Pieces(const Instrument& instrument, const double* q, const double* to)
      : n(static_cast<std::size_t>(instrument.chain().size())), from(q), end(to) {
    double width = 0.0;
    for (const Body& body : instrument.bodies()) width = std::max(width, 2.0 * body.radius);
    Joints way{};
    for (std::size_t k = 0; k < n; ++k) way[k] = end[k] - from[k];
    ChainState state;
    instrument.chain().forward_kinematics({from, n}, state);
    double path = 0.0;
    for (const LinkPoint& point : instrument.points()) {
      const Vec3 place = state.at(point.link, point.position);
      path = std::max(path, motion_bounds(state, {way.data(), n}, point.link, place).path);
    }
    constexpr double most = 1e4;
    if (width > 0.0) count = std::clamp(std::ceil(path / width), 1.0, most);
  }

  double at(std::size_t k, double fraction) const {
    return fraction == 1.0 ? end[k] : from[k] + fraction * (end[k] - from[k]);
  }

  std::size_t n;  // joints
  const double* from;
  const double* end;
  double count = 1.0;
};

/// Returns the fraction of a motion that is proven from its start on; 1 for all of it.
double proven_share(InstrumentConstraint& guard, const Pieces& pieces) {
  for (double i = 0.0; i < pieces.count; i += 1.0) {
    Joints start{}, increment{};
    for (std::size_t k = 0; k < pieces.n; ++k) {
      start[k] = pieces.at(k, i / pieces.count);
      increment[k] = pieces.at(k, (i + 1.0) / pieces.count) - start[k];
    }
    const MotionProof proof = guard.prove({start.data(), pieces.n}, {increment.data(), pieces.n});
    if (proof.is_clear()) continue;
    // A recovering motion starts too close, so no part of it counts.
    return (i + (proof.status == Status::recovering ? 0.0 : proof.fraction)) / pieces.count;
  }
  return 1.0;
}

/// The proofs for an instrument: see certified_checkers.h.
struct JointProof {
  std::shared_ptr<InstrumentPool> guards;

  bool stands(const base::State* state) const { return goes(state, state); }

  bool goes(const base::State* from, const base::State* to) const {
    return proves(*guards->borrow(), values_of(from), values_of(to));
  }

  double goes_until(const base::State* from, const base::State* to, base::State* end) const {
    const InstrumentPool::Loan guard = guards->borrow();
    const Pieces pieces(guard->instrument(), values_of(from), values_of(to));
    double* const there = values_of(end);
    // Rounding may put the end too close; then a slightly shorter motion is tried.
    double less = 1.0 / (64.0 * pieces.count);
    for (double fraction = proven_share(*guard, pieces); fraction > 0.0;
         fraction -= less, less *= 2.0) {
      for (std::size_t k = 0; k < pieces.n; ++k) there[k] = pieces.at(k, fraction);
      if (proves(*guard, pieces.from, there) && proves(*guard, there, there)) return fraction;
    }
    std::copy_n(pieces.from, pieces.n, there);
    return 0.0;
  }

 private:
  static bool proves(InstrumentConstraint& guard, const double* from, const double* to) {
    return proven_share(guard, Pieces(guard.instrument(), from, to)) == 1.0;
  }
};

}  // namespace

std::shared_ptr<base::StateSpace> make_joint_space(const Instrument& instrument) {
  const Chain& chain = instrument.chain();
  for (int k = 1; k <= chain.size(); ++k) {
    const JointLimits& limits = chain.joint(k).limits;
    if (!(limits.lower < limits.upper) || !std::isfinite(limits.upper - limits.lower)) {
      throw Error("planning: joint '" + chain.joint(k).name +
                  "' has no limits, or no range between them: set limits to plan within");
    }
  }
  return std::make_shared<JointSpace>(chain, weights_of(instrument));
}

std::shared_ptr<base::StateValidityChecker> make_state_validity_checker(
    const std::shared_ptr<base::SpaceInformation>& space, std::shared_ptr<InstrumentPool> guards) {
  require_joint_space(space, guards);
  return std::make_shared<CertifiedStates<JointProof>>(space, JointProof{std::move(guards)});
}

std::shared_ptr<base::MotionValidator> make_motion_validator(
    const std::shared_ptr<base::SpaceInformation>& space, std::shared_ptr<InstrumentPool> guards) {
  require_joint_space(space, guards);
  return std::make_shared<CertifiedMotions<JointProof>>(space, JointProof{std::move(guards)});
}

void set_certified_checkers(const std::shared_ptr<base::SpaceInformation>& space,
                            const std::shared_ptr<InstrumentPool>& guards) {
  const auto states = make_state_validity_checker(space, guards);
  const auto motions = make_motion_validator(space, guards);
  space->setStateValidityChecker(states);
  space->setMotionValidator(motions);
}

}  // namespace keepout
