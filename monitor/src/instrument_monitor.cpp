// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "keepout/error.h"
#include "keepout/monitor/monitors.h"
#include "keepout/monitor/motion_check.h"

namespace keepout::monitor {
namespace {

constexpr double none = -std::numeric_limits<double>::infinity();
constexpr double allowance = 4.0;  // [tolerance]; the step promises 3

class MeshesMonitor final : public InstrumentMonitor {
 public:
  MeshesMonitor(const Instrument& instrument, std::span<const std::shared_ptr<const Mesh>> meshes,
                const MonitorCapacity& capacity)
      : robot_(model_of(instrument)), base_(instrument.chain().base()), capacity_(capacity) {
    for (const std::shared_ptr<const Mesh>& mesh : meshes) trees_.push_back(tree_of(mesh));
    adopt(trees_);
  }

  bool confirms(const MonitoredMotion& motion) noexcept override {
    const bool fits = motion.meshes.size() == trees_.size() && motion.pairs.size() == due_.size() &&
                      motion.from.size() == robot_.table.size() &&
                      motion.to.size() == robot_.table.size() && motion.tolerance > 0.0;
    if (!fits) return false;
    bool is_moving = false;
    for (std::size_t m = 0; m < trees_.size(); ++m) {
      const MonitoredMotion::OfMesh& mesh = motion.meshes[m];
      motions_[m] = {mesh.pose, mesh.way};
      is_moving |= !mesh.way.linear.isZero(0.0) || !mesh.way.angular.isZero(0.0);
    }
    for (std::size_t p = 0; p < due_.size(); ++p) {
      const double certified = motion.pairs[p].certified;
      if (std::isnan(certified) || (certified == none && !is_moving)) return false;
      due_[p] = certified - allowance * motion.tolerance;
    }
    const MotionFinding finding =
        check_.check({motion.from, motion.to, motions_}, due_, capacity_.work);
    if (finding.clearance != Clearance::kept) return false;
    for (std::size_t p = 0; p < due_.size(); ++p) {
      if (!is_enough(motion.pairs[p], p, motion.tolerance)) return false;
    }
    return true;
  }

  void follow(std::shared_ptr<const Mesh> mesh, std::size_t number) override {
    if (number > trees_.size()) throw Error("the monitor has no mesh before this one");
    std::vector<std::shared_ptr<const TriangleTree>> trees = trees_;
    trees.resize(std::max(trees.size(), number + 1));
    trees[number] = tree_of(mesh);
    adopt(std::move(trees));
  }

 private:
  static std::shared_ptr<const TriangleTree> tree_of(const std::shared_ptr<const Mesh>& mesh) {
    if (!mesh) throw Error("a monitor needs a mesh, but it is null");
    return std::make_shared<const TriangleTree>(mesh);
  }

  /// Makes all memory for these meshes. If this throws, nothing is changed.
  void adopt(std::vector<std::shared_ptr<const TriangleTree>> trees) {
    MotionCheck check(trees, robot_, base_, capacity_.triangles);
    std::vector<double> due(trees.size() * robot_.bodies.size());
    std::vector<MeshMotion> motions(trees.size());
    check_ = std::move(check);
    due_ = std::move(due);
    motions_ = std::move(motions);
    trees_ = std::move(trees);
  }

  /// Returns true if the certified clearance of a pair is not less than its distance at the start
  /// demands.
  bool is_enough(const MonitoredMotion::OfPair& pair, std::size_t p, double tolerance) noexcept {
    if (pair.target == none || pair.certified >= pair.target) return true;
    const double radius = robot_.bodies[p % robot_.bodies.size()].radius;
    const std::optional<Bracket> start =
        check_.core_distance(MotionCheck::End::start, p, radius + pair.target + pair.band);
    if (!start) return false;
    const double demanded = std::min(pair.target, start->low - radius - pair.band);
    return pair.certified >= demanded - allowance * tolerance;
  }

  JudgedRobot robot_;
  Pose base_;
  MonitorCapacity capacity_;
  std::vector<std::shared_ptr<const TriangleTree>> trees_;
  MotionCheck check_{{}, JudgedRobot{}, Pose{}, 0};
  std::vector<double> due_;
  std::vector<MeshMotion> motions_;
};

}  // namespace

JudgedRobot model_of(const Instrument& instrument) {
  JudgedRobot robot;
  for (int k = 1; k <= instrument.chain().size(); ++k) {
    const Joint& joint = instrument.chain().joint(k);
    robot.table.push_back(
        {.slides = joint.kind == JointKind::prismatic, .before = joint.origin, .axis = joint.axis});
  }
  for (const Body& body : instrument.bodies()) {
    JudgedBody& judged = robot.bodies.emplace_back(JudgedBody{.points = {}, .radius = body.radius});
    for (const LinkPoint& point : body.points)
      judged.points.push_back({point.link, point.position});
  }
  return robot;
}

std::unique_ptr<InstrumentMonitor> make_instrument_monitor(
    const Instrument& instrument, std::span<const std::shared_ptr<const Mesh>> meshes,
    const MonitorCapacity& capacity) {
  return std::make_unique<MeshesMonitor>(instrument, meshes, capacity);
}

}  // namespace keepout::monitor
