// SPDX-License-Identifier: BSD-3-Clause
// An instrument beside small meshes: the bytes choose its chain and bodies, options, guides and a
// sequence of calls. The oracle judges each cycle and each proof.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <numbers>
#include <optional>
#include <sstream>

#include "fuzz/any_instrument.h"
#include "fuzz/step_scene.h"
#include "keepout/index/wide_bvh.h"
#include "keepout/judges/robot_judge.h"
#include "keepout/robot/instrument_constraint.h"
#include "keepout/solvers/registry.h"
#include "simulate/guide_audit.h"

namespace keepout::fuzz {
namespace {

constexpr int most_calls_of_an_instrument = 16;

oracle::JudgedRobot judged(const Instrument& instrument) {
  oracle::JudgedRobot robot;
  const Chain& chain = instrument.chain();
  for (int k = 1; k <= chain.size(); ++k) {
    const Joint& joint = chain.joint(k);
    robot.table.push_back(
        {.slides = joint.kind == JointKind::prismatic, .before = joint.origin, .axis = joint.axis});
  }
  for (const Body& body : instrument.bodies()) {
    oracle::JudgedBody& one = robot.bodies.emplace_back();
    one.radius = body.radius;
    for (const LinkPoint& point : body.points) one.points.push_back({point.link, point.position});
  }
  return robot;
}

class InstrumentCase {
 public:
  InstrumentCase(Instrument instrument, const InstrumentOptions& options,
                 const InstrumentCapacity& capacity, Source& source)
      : source_(source),
        robot_(judged(instrument)),
        guard_(std::move(instrument), make_solver("active_set"), options, capacity),
        joints_(static_cast<std::size_t>(chain().size())) {
    for (std::size_t m = 1 + source.below(2); m > 0; --m) add_mesh();
    place_joints();
  }

  void call() {
    switch (source_.below(16)) {
      case 0:
        return invalid_step();
      case 1:
        return set_guides();
      case 2:
        return set_options();
      case 3:
        return deform();
      case 4:
        return place_joints();
      case 5:
      case 6:
        return place_mesh();
      case 7:
        return prove();
      case 8:
      case 9:
        return step_of_joints();
      default:
        return step([&] { return guard_.step(q_, twist_); });
    }
  }

 private:
  const Chain& chain() const noexcept { return guard_.instrument().chain(); }

  void add_mesh() {
    const auto mesh = any_mesh(source_);
    const auto index = std::make_shared<WideBvh>(mesh, 1);
    const InstrumentOptions& options = guard_.options();
    const double margin = source_.once_in(3) ? 2.0 * options.margin : 0.0;
    guard_.add_mesh(mesh, index, margin);
    meshes_.push_back({mesh, index, margin});
  }

  /// Sets the joints anywhere within their limits; seldom beyond.
  void place_joints() {
    q_.clear();
    for (int k = 1; k <= chain().size(); ++k) {
      const Joint& joint = chain().joint(k);
      const double range = joint.kind == JointKind::prismatic ? 20.0 : 3.0;
      const double beyond = source_.once_in(16) ? 0.1 * range : 0.0;
      q_.push_back(source_.between(std::max(joint.limits.lower, -range) - beyond,
                                   std::min(joint.limits.upper, range) + beyond));
    }
    choose_twist();
    guard_.forget();
    begin();
  }

  void choose_twist() {
    const double length = source_.magnitude(-4.0, 1.0);
    twist_ = {.linear = length * source_.direction(),
              .angular = source_.magnitude(-4.0, 0.0) * source_.direction()};
    if (source_.once_in(4)) twist_.angular = Vec3::Zero();
    if (source_.once_in(8)) twist_.linear = Vec3::Zero();
  }

  oracle::JudgedScene scene() const {
    oracle::JudgedScene scene{.robot = robot_,
                              .base = chain().base(),
                              .meshes = {},
                              .guides = app::judged_guides(guides_)};
    for (std::size_t m = 0; m < meshes_.size(); ++m) {
      scene.meshes.push_back({std::make_shared<const oracle::TriangleTree>(meshes_[m].mesh),
                              meshes_[m].margin, guard_.place_of(m)});
    }
    return scene;
  }

  /// Begins to judge at the present joints. Meshes stop.
  void begin() {
    for (std::size_t m = 0; m < meshes_.size(); ++m) {
      // A mesh that has moved too far away cannot be placed there.
      if (!is_ok(guard_.place(m, guard_.place_of(m)))) guard_.place(m, {});
    }
    has_motion_ = false;
    judge_.emplace(scene(), chain(), q_, guard_.options(), guard_.tolerance());
  }

  template <class Make>
  void step(const Make& make) {
    if (source_.once_in(4)) choose_twist();
    const InstrumentStep step = without_allocation(make);
    require(step.ok() ? step.increment.size() == joints_ : step.increment.empty(),
            "a step has an increment, or fails");
    require(step.fraction >= 0.0 && step.fraction <= 1.0, "a fraction is from 0 to 1");
    require(step.clearance_fraction >= 0.0 && step.clearance_fraction <= 1.0,
            "a clearance fraction is from 0 to 1");
    require(step.guides.size() == (step.guides.empty() ? 0 : guides_.size()),
            "each guide has a state");
    std::vector<double> next = q_;
    for (std::size_t k = 0; k < step.increment.size(); ++k) {
      require(std::isfinite(step.increment[k]), "an increment is finite");
      next[k] += step.increment[k];
    }
    const auto verdict = judge_->judge(next, step);
    // Beside a moving mesh, the step may drop a guide for this cycle.
    const bool may_drop = has_motion_ && std::ranges::any_of(step.guides, &GuideState::relaxed);
    if (verdict.is_below || verdict.limits_broken || (verdict.is_guide_left && !may_drop)) {
      throw Finding(described(step, verdict, next));
    }
    for (std::size_t m = 0; m < meshes_.size(); ++m) {
      require((judge_->pose(m).position - guard_.place_of(m).position).norm() <=
                  1e-9 * (1.0 + judge_->pose(m).position.norm()),
              "a mesh moves at its velocity");
    }
    q_ = next;
    if (may_drop) begin();
  }

  /// Returns the numbers of a step, for the message of a finding.
  std::string described(const InstrumentStep& step, const oracle::RobotVerdict& verdict,
                        const std::vector<double>& next) const {
    std::ostringstream out;
    out << std::setprecision(17)
        << (verdict.is_below        ? "a body loses its clearance by "
            : verdict.limits_broken ? "a joint leaves its limits, "
                                    : "a guided point leaves its region by ")
        << (verdict.is_below ? -verdict.beyond : -verdict.guide_room) << ", tolerance "
        << guard_.tolerance() << ", least clearance " << verdict.least << ", status "
        << name(step.status) << ", clearance fraction " << step.clearance_fraction << ", "
        << meshes_.size() << " meshes, " << guides_.size() << " guides"
        << (has_motion_ ? ", a mesh moves" : "") << ", relaxation " << name(step.relaxation)
        << "\n  q";
    for (const double q : q_) out << ' ' << q;
    out << ", next";
    for (const double q : next) out << ' ' << q;
    for (const auto& option : instrument_options) {
      out << ", " << option.name << ' ' << keepout::text_of(option.get(guard_.options()));
    }
    for (int k = 1; k <= chain().size(); ++k) {
      const JointLimits& limits = chain().joint(k).limits;
      out << "\n  joint " << k
          << (chain().joint(k).kind == JointKind::revolute ? " turns" : " slides") << ", limits "
          << limits.lower << ' ' << limits.upper << ' ' << limits.velocity << ' '
          << limits.increment;
    }
    for (const Placed& one : meshes_) {
      out << "\n  mesh of " << one.mesh->triangle_count() << " triangles, size "
          << size_of(*one.mesh) << ", margin " << one.margin;
    }
    return out.str();
  }

  void step_of_joints() {
    std::vector<double> desired, weights;
    const double size = source_.magnitude(-4.0, 0.5);
    for (std::size_t k = 0; k < joints_; ++k) desired.push_back(size * source_.between(-1.0, 1.0));
    if (source_.once_in(3)) {
      for (std::size_t k = 0; k < joints_; ++k) weights.push_back(source_.magnitude(-3.0, 3.0));
    }
    step([&] { return guard_.step(q_, desired, weights); });
  }

  void invalid_step() {
    std::vector<double> q = q_;
    Twist twist = twist_;
    if (source_.once_in(3)) {
      q.resize(source_.below(10));
    } else if (source_.once_in(2)) {
      q[source_.below(joints_)] = source_.any_number();
    } else {
      twist.linear[static_cast<Eigen::Index>(source_.below(3))] = source_.any_number();
    }
    const InstrumentStep step = without_allocation([&] { return guard_.step(q, twist); });
    for (const double dq : step.increment) require(std::isfinite(dq), "an increment is finite");
    require(!step.ok() || q.size() == joints_, "joints of another number do not move");
    guard_.forget();
    begin();
  }

  void prove() {
    std::vector<double> increment, to = q_;
    const double size = source_.magnitude(-3.0, 0.7);
    for (std::size_t k = 0; k < joints_; ++k) {
      increment.push_back(size * source_.between(-1.0, 1.0));
    }
    const MotionProof proof = without_allocation([&] { return guard_.prove(q_, increment); });
    require(proof.fraction >= 0.0 && proof.fraction <= 1.0, "a fraction is from 0 to 1");
    require(!proof.is_clear() || proof.fraction == 1.0, "a clear motion is proved to its end");
    begin();
    for (std::size_t k = 0; k < joints_; ++k) to[k] += proof.fraction * increment[k];
    require(!judge_->judge(to).is_below, "a proved motion maintains the clearance");
    begin();
  }

  void set_guides() {
    ChainState state;
    chain().forward_kinematics(q_, state);
    std::vector<Guide> guides;
    ignore_errors([&] {
      for (std::size_t i = source_.below(4); i > 0; --i) guides.push_back(any_guide(state));
      guard_.set_guides(guides);
      guides_ = guides;
    });
    begin();
  }

  Guide any_guide(const ChainState& state) {
    const auto link = static_cast<int>(1 + source_.below(joints_));
    const LinkPoint point{link, source_.point(10.0)};
    switch (source_.below(3)) {
      case 0: {
        const Vec3 axis = source_.direction();
        const Vec3 near = state.link(link).rotation * axis + 0.3 * source_.point(1.0);
        return Guide::axis("axis", link, axis, near, source_.magnitude(-2.0, 0.0));
      }
      case 1: {
        const LinkPoint other{source_.once_in(2) ? 0 : link, source_.point(10.0)};
        const Vec3 near = state.at(link, point.position) + source_.point(1.0);
        return Guide::remote_center("center", other, point, near, source_.magnitude(-1.0, 0.5));
      }
      default:
        return Guide::point("point", point,
                            any_region(state.at(link, point.position), 5.0, source_));
    }
  }

  void set_options() {
    InstrumentOptions options = any_instrument_options(source_);
    ignore_errors([&] { guard_.set_options(options); });
    judge_->follow(guard_.options());  // the certified clearance stays
  }

  /// Places a mesh, with a velocity.
  void place_mesh() {
    const std::size_t m = source_.below(meshes_.size());
    if (source_.once_in(3)) {
      guard_.place(m, any_pose(10.0, source_));
      begin();
    }
    const Pose pose = guard_.place_of(m);
    const double period = guard_.options().period;
    const Twist velocity{.linear = source_.magnitude(-4.0, 0.5) / period * source_.direction(),
                         .angular = source_.magnitude(-4.0, -0.5) / period * source_.direction()};
    const Status status = without_allocation([&] { return guard_.place(m, pose, velocity); });
    if (is_ok(status)) {
      judge_->place(m, guard_.place_of(m), velocity);
      has_motion_ = true;
    } else {
      begin();
    }
  }

  void deform() {
    const std::size_t number = source_.below(meshes_.size());
    Placed& placed = meshes_[number];
    const auto moved = deformed(*placed.mesh, source_);
    placed.index->refit(moved, 1);
    require(!guard_.step(q_, twist_).ok(), "no step on an outdated mesh");
    bool is_followed = false;
    ignore_errors([&] {
      guard_.follow(moved, placed.index, number);
      is_followed = true;
    });
    if (is_followed) {
      placed.mesh = moved;
    } else {  // its size does not suit the margin
      placed.index->refit(placed.mesh, 1);
      guard_.follow(placed.mesh, placed.index, number);
    }
    begin();
  }

  struct Placed {
    std::shared_ptr<const Mesh> mesh;
    std::shared_ptr<WideBvh> index;
    double margin;
  };

  Source& source_;
  oracle::JudgedRobot robot_;
  InstrumentConstraint guard_;
  std::size_t joints_;
  std::vector<Placed> meshes_;
  std::vector<Guide> guides_;
  std::vector<double> q_;
  Twist twist_;
  bool has_motion_ = false;  // a mesh moves
  std::optional<oracle::RobotJudge> judge_;
};

void run_instrument(Bytes bytes) {
  Source source(bytes);
  InstrumentCapacity capacity{.triangles = 1024};
  if (source.once_in(4)) capacity.work_units = 1 + 8 * source.below(256);
  if (source.once_in(16)) capacity.planes = 1 + source.below(32);
  ignore_errors([&] {
    Instrument instrument = any_instrument(source);
    InstrumentCase all(std::move(instrument), any_instrument_options(source), capacity, source);
    for (int i = 0; i < most_calls_of_an_instrument && !source.is_empty(); ++i) all.call();
  });
}

}  // namespace

std::span<const Harness> instrument_harnesses() noexcept {
  static constexpr Harness all[] = {
      {"instrument_step", "robot/src solvers/src engine/src/index/wide_bvh", run_instrument}};
  return all;
}

}  // namespace keepout::fuzz
