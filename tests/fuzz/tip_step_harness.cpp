// SPDX-License-Identifier: BSD-3-Clause
// A tip near a small mesh: the bytes choose options, guides and a sequence of calls. The oracle
// judges each step; the same calls on another index must give the same steps.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <optional>
#include <sstream>

#include "fuzz/step_scene.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/factory/make_motion_constraint.h"
#include "keepout/index/self_intersection.h"
#include "keepout/index/wide_bvh.h"
#include "keepout/judges/tip_judge.h"
#include "keepout/mesh/diagnostics.h"
#include "simulate/guide_audit.h"

namespace keepout::fuzz {
namespace {

constexpr int most_calls = 30;

using Jacobian = Eigen::Matrix<double, 3, Eigen::Dynamic>;

StepOptions any_options(double size, Source& source) {
  StepOptions options;
  options.radius = size * source.magnitude(-3.0, 0.5);
  options.tool_radius = source.once_in(2) ? size * source.magnitude(-4.0, -0.5) : 0.0;
  options.margin = size * source.magnitude(-6.0, -0.5);
  options.damping = source.once_in(2) ? 1e-6 : 0.0;
  options.recovery = source.once_in(4) ? 0.0 : size * source.magnitude(-5.0, 0.0);
  options.deepest = source.once_in(4) ? 0.0 : size;
  options.refinements = static_cast<int>(source.below(5));
  options.nodes = source.once_in(4) ? static_cast<int>(source.below(17)) : 0;
  options.query = static_cast<Query>(source.below(2));
  options.distances = static_cast<Distances>(source.below(2));
  return options;
}

/// Returns true if a triangle is so thin that rounding may classify a tip beside it.
bool has_sliver(const Mesh& mesh) {
  for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
    const Triangle c = mesh.triangle(t);
    double longest2 = 0.0;
    for (int e = 0; e < 3; ++e)
      longest2 = std::max(longest2, (c[(e + 1) % 3] - c[e]).squaredNorm());
    if (!((c[1] - c[0]).cross(c[2] - c[0]).norm() > 1e-8 * longest2)) return true;
  }
  return false;
}

/// The numbers of a step that must not depend on the index.
struct Outcome {
  Status status;
  Vec3 motion;
  std::vector<double> increment;
  std::optional<double> distance;
  bool is_cut_short;  // a budget or a capacity ended the search

  explicit Outcome(const Step& step)
      : status(step.status),
        motion(step.motion),
        increment(step.increment.begin(), step.increment.end()),
        distance(step.distance),
        is_cut_short(step.status == Status::out_of_budget || step.status == Status::over_capacity ||
                     step.limits.has(Limit::budget) || step.limits.has(Limit::capacity)) {}

  bool operator==(const Outcome& other) const {
    return status == other.status && motion == other.motion && increment == other.increment &&
           distance == other.distance;
  }
};

class TipCase {
 public:
  TipCase(std::shared_ptr<const Mesh> mesh, const MotionConstraintSettings& settings,
          Source& source)
      : source_(source),
        mesh_(std::move(mesh)),
        tree_(std::make_shared<WideBvh>(mesh_, 1)),
        guard_(make_motion_constraint(mesh_, tree_, settings)),
        inside_(settings.inside),
        size_(size_of(*mesh_)) {
    // A search that is cut short ends elsewhere on another index.
    if (settings.capacity.work_units == 0) {
      other_.emplace(make_motion_constraint(mesh_, make_index("brute_force", mesh_), settings));
    }
    place();
  }

  void call() {
    switch (source_.below(16)) {
      case 0:
        return step_of_joints();
      case 1:
        return invalid_step();
      case 2:
        return polytope();
      case 3:
        return set_guides();
      case 4:
        return set_options();
      case 5:
        return deform();
      case 6:
        return place();
      default:
        return step({.tip = tip_, .desired = desired()});
    }
  }

 private:
  /// Sets the tip down at any place, and forgets the last step.
  void place() {
    const double kept = required_clearance(guard_.options());
    tip_ = place_near(*mesh_, kept * source_.between(-0.5, 2.5), source_);
    guard_.forget();
    if (other_) other_->forget();
    begin();
  }

  /// Begins to judge at the present tip. `may_escape`: the step may lead it out of the forbidden
  /// side.
  void begin(bool may_escape = true) {
    surface_.emplace(mesh_);
    audit_.emplace(guard_.guides(), tip_);
    const bool has_sides = inside_ == Inside::escape && is_watertight(*mesh_);
    judge_.reset();
    if (has_sides && has_sliver(*mesh_)) return;
    if (count_self_intersections(*mesh_, *tree_) > 0) {
      other_.reset();         // ties between triangles at the same place depend on the index
      if (has_sides) return;  // the forbidden side is not well defined
    }
    judge_.emplace(*surface_, guard_.options(), has_sides && may_escape, tip_);
  }

  Vec3 desired() {
    const double radius = guard_.options().radius;
    if (source_.once_in(8)) return Vec3::Zero();
    const Vec3 to =
        source_.once_in(2) ? source_.direction() : Vec3(place_near(*mesh_, 0.0, source_) - tip_);
    const double length = to.norm();
    const double most = source_.once_in(4) ? radius * source_.magnitude(-6.0, 0.0) : radius;
    return length > 0.0 ? Vec3(to * (std::min(most, source_.once_in(3) ? length : most) / length))
                        : Vec3(Vec3::Zero());
  }

  void step(const Motion& motion) {
    const Step step = without_allocation([&] { return guard_.step(motion); });
    try {
      check(motion, step);
      compare(motion, step);
      judge(motion, step);
    } catch (const Finding& finding) {
      throw Finding(finding.what() + described(motion, step));
    }
  }

  void judge(const Motion& motion, const Step& step) {
    Motion judged = motion;
    // Guides pull a tip back that is outside of their regions.
    const auto is_outside = [](const GuideState& guide) { return guide.excess > 0.0; };
    if (std::ranges::any_of(step.guides, is_outside)) judged.desired = step.motion;
    const auto verdict = judge_ ? judge_->judge(judged, step) : oracle::TipVerdict{};
    if (verdict.breach) {
      throw Finding("the theorem of the tip: " + std::string(name(*verdict.breach)));
    }
    tip_ += step.motion;
    require(!audit_->follow(tip_), "a tip leaves a guide by at most its band");
  }

  /// Returns the numbers of a step, for the message of a finding.
  std::string described(const Motion& motion, const Step& step) const {
    std::ostringstream out;
    out << std::setprecision(17) << "\n  status " << name(step.status) << ", tip "
        << motion.tip.transpose() << ", desired " << motion.desired.transpose() << ", motion "
        << step.motion.transpose() << ", " << mesh_->triangle_count() << " triangles, size "
        << size_ << ", longest edge " << mesh_->longest_edge() << ", distance "
        << surface_->oracle().distance(motion.tip) << " (reported " << step.distance.value_or(-1.0)
        << ')' << (judge_ ? "" : ", not judged") << ", " << guard_.guides().size() << " guides";
    if (motion.jacobian) out << ", " << motion.jacobian->joints() << " joints";
    for (const auto& option : step_options) {
      out << ", " << option.name << ' ' << keepout::text_of(option.get(guard_.options()));
    }
    return out.str();
  }

  /// Checks that the parts of a step agree with each other.
  void check(const Motion& motion, const Step& step) {
    require(step.ok() || (step.motion.isZero(0.0) && step.increment.empty()),
            "a failed step has no motion");
    require(step.active.empty() || step.ok(), "a failed step has no active plane");
    const auto rows = motion.rows ? static_cast<std::size_t>(motion.rows->count()) : 0;
    for (const std::uint32_t active : step.active) {
      require(active < step.planes.size() + rows, "an active plane exists");
    }
    const double slack = 1e-9 * guard_.options().radius;
    if (step.ok() && motion.jacobian) {
      const Eigen::Map<const Eigen::VectorXd> dq(step.increment.data(), std::ssize(step.increment));
      require((jacobian_ * dq - step.motion).norm() <= slack, "the joints make the motion");
    } else if (step.ok()) {
      require(std::ranges::equal(step.increment, step.motion), "the increment is the motion");
    }
    if (step.status == Status::free && !motion.jacobian && guard_.options().damping == 0.0) {
      require((step.motion - motion.desired).norm() <= slack, "a free motion is the desired one");
    }
    require(guard_.work_units() <=
                2 * Capacity::work_units_or_default(guard_.capacity().work_units, *tree_),
            "a step spends its budget at most");
    if (!step.distance) return;
    const double distance = surface_->oracle().distance(motion.tip);
    const double tau = surface_->tolerance(guard_.options(), motion.tip);
    const double touching = 1e-12 * (size_ + motion.tip.lpNorm<1>());
    if (!(std::abs(*step.distance - distance) <= 1e-9 * distance + tau + touching)) {
      throw Finding("the reported distance is that of the tip, not " +
                    keepout::text_of(*step.distance));
    }
  }

  /// Makes the same step with another index.
  void compare(const Motion& motion, const Step& step) {
    if (!other_) return;
    const Outcome one(step);
    const Outcome two(other_->step(motion));
    if (one.is_cut_short || two.is_cut_short) {
      other_.reset();
    } else {
      if (!(one == two)) {
        std::ostringstream out;
        out << "the step does not depend on the index: " << name(two.status) << ", motion "
            << std::setprecision(17) << two.motion.transpose();
        if (two.distance) out << ", distance " << *two.distance;
        throw Finding(out.str());
      }
    }
  }

  void step_of_joints() {
    const auto joints = static_cast<Eigen::Index>(1 + source_.below(7));
    jacobian_.resize(3, joints);
    for (Eigen::Index k = 0; k < joints; ++k) jacobian_.col(k) = source_.point(1.0);
    const auto count = static_cast<Eigen::Index>(source_.below(4));
    std::vector<double> matrix, bounds;
    for (Eigen::Index i = 0; i < count; ++i) {
      for (Eigen::Index k = 0; k < joints; ++k) matrix.push_back(source_.between(-1.0, 1.0));
      bounds.push_back(guard_.options().radius * source_.between(-1.0, 0.25));
    }
    begin(false);  // with joints, no tip escapes
    step({.tip = tip_,
          .desired = desired(),
          .jacobian = TipJacobian(jacobian_),
          .rows = count > 0 ? std::optional(ExtraRows(matrix.data(), bounds.data(), count))
                            : std::nullopt});
    begin();
  }

  void invalid_step() {
    Motion motion{.tip = tip_, .desired = desired()};
    (source_.once_in(2) ? motion.tip
                        : motion.desired)[static_cast<Eigen::Index>(source_.below(3))] =
        source_.any_number();
    const Step step = without_allocation([&] { return guard_.step(motion); });
    const bool is_finite = motion.tip.allFinite() && motion.desired.allFinite();
    require(step.ok() ? is_finite : step.motion.isZero(0.0), "invalid numbers move nothing");
    guard_.forget();
    if (other_) other_->forget();
    begin();
  }

  void polytope() {
    const double radius = guard_.options().radius * source_.magnitude(-2.0, 0.0);
    const Polytope polytope =
        without_allocation([&] { return guard_.free_polytope(tip_, radius); });
    if (other_) other_->free_polytope(tip_, radius);
    const auto is_within = [&](const Vec3& d) {
      return d.norm() <= radius && std::ranges::all_of(polytope.planes, [&](const HalfSpace& p) {
               return p.normal.dot(d) >= p.offset;
             });
    };
    if (polytope.ok()) require(is_within(Vec3::Zero()), "a polytope contains the tip");
    oracle::SafetyOracle oracle = surface_->oracle();
    double size = 0.0;
    for (const Vec3& v : mesh_->vertices()) size = std::max(size, (v - tip_).norm());
    const double rounding = 1e-12 * radius + 2e-14 * size + 4e-16 * (tip_.lpNorm<1>() + radius);
    const double kept = std::min(required_clearance(guard_.options()), oracle.distance(tip_));
    for (int i = 0; i < 8; ++i) {
      Vec3 motion = radius * source_.direction();
      for (const HalfSpace& p : polytope.planes) {
        const double along = p.normal.dot(motion);
        if (along < p.offset) motion *= std::max(0.0, p.offset / along);
      }
      if (!is_within(motion) || motion.isZero(0.0)) continue;
      require(polytope.ok(), "the planes of a failure allow no motion");
      const auto found = oracle.check(tip_, tip_ + motion, std::max(0.0, kept - rounding));
      require(!found.below, "each motion within a polytope maintains the clearance");
    }
  }

  void set_guides() {
    std::vector<Guide> guides;
    ignore_errors([&] {
      for (std::size_t i = source_.below(4); i > 0; --i) {
        guides.push_back(Guide::point("guide", any_region(tip_, size_, source_)));
        if (source_.once_in(2)) {
          guides.back() = guides.back().with_band(size_ * source_.magnitude(-7.0, -2.0));
        }
      }
      guard_.set_guides(guides);
      if (other_) other_->set_guides(guides);
    });
    begin();
  }

  void set_options() {
    StepOptions options = any_options(size_, source_);
    options.nodes = 0;
    ignore_errors([&] {
      guard_.set_options(options);
      if (other_) other_->set_options(options);
    });
    begin();
  }

  /// Moves the mesh, and follows it.
  void deform() {
    const auto moved = deformed(*mesh_, source_);
    tree_->refit(moved, 1);
    const Step step = guard_.step({.tip = tip_, .desired = Vec3::Zero()});
    require(step.status == Status::mesh_changed, "no step on an outdated mesh");
    ignore_errors([&] {
      guard_.follow(moved, tree_);
      mesh_ = moved;
    });
    if (mesh_ != moved) {  // its size does not suit the options
      tree_->refit(mesh_, 1);
      guard_.follow(mesh_, tree_);
    }
    if (other_) other_->follow(mesh_, make_index("brute_force", mesh_));
    begin();
  }

  Source& source_;
  std::shared_ptr<const Mesh> mesh_;
  std::shared_ptr<WideBvh> tree_;
  MotionConstraint guard_;
  std::optional<MotionConstraint> other_;  // on another index
  Inside inside_;
  double size_;
  Vec3 tip_ = Vec3::Zero();
  Jacobian jacobian_;
  std::optional<oracle::JudgedSurface> surface_;
  std::optional<oracle::TipJudge> judge_;
  std::optional<app::GuideAudit> audit_;
};

void run_tip(Bytes bytes) {
  Source source(bytes);
  const auto mesh = any_mesh(source);
  MotionConstraintSettings settings;
  settings.options = any_options(size_of(*mesh), source);
  settings.inside = static_cast<Inside>(source.below(2));
  settings.capacity.nodes = static_cast<std::size_t>(settings.options.nodes);
  settings.capacity.triangles = 1024;
  settings.capacity.planes = 1024;
  if (source.once_in(4)) settings.capacity.work_units = 1 + 8 * source.below(256);
  if (source.once_in(16)) settings.capacity.planes = 16 + source.below(64);
  ignore_errors([&] {
    TipCase tip(mesh, settings, source);
    for (int i = 0; i < most_calls && !source.is_empty(); ++i) tip.call();
  });
}

}  // namespace

std::span<const Harness> tip_harnesses() noexcept {
  static constexpr Harness all[] = {
      {"tip_step", "engine/src/step engine/src/activation solvers/src", run_tip}};
  return all;
}

}  // namespace keepout::fuzz
