// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "keepout/error.h"
#include "keepout/monitor/inside.h"
#include "keepout/monitor/monitors.h"
#include "keepout/monitor/motion_check.h"

namespace keepout::monitor {
namespace {

constexpr double allowance = 4.0;          // [tau]; the step promises 3
constexpr double unpromised_within = 8.0;  // of the surface [tau]

/// A tip is a robot: a ball of radius 0 on three joints that slide along the axes.
JudgedRobot sliding_point() {
  return {.table = {{.slides = true, .axis = Vec3::UnitX()},
                    {.slides = true, .axis = Vec3::UnitY()},
                    {.slides = true, .axis = Vec3::UnitZ()}},
          .bodies = {{{{3}}, 0.0}}};
}

class MeshTipMonitor final : public TipMonitor {
 public:
  MeshTipMonitor(std::shared_ptr<const TriangleTree> tree, const MonitorCapacity& capacity)
      : capacity_(capacity) {
    adopt(std::move(tree));
  }

  bool confirms(const Vec3& from, const Vec3& to, const StepOptions& options) noexcept override {
    const double required = options.tool_radius + options.margin;
    const double tau = tau_of(from, options);
    const auto keeps = [&](double due) {
      return check(from, to, due - allowance * tau).clearance == Clearance::kept;
    };
    if (!(required > unpromised_within * tau)) return false;
    if (keeps(required)) return true;
    // A tip that starts closer must not come closer.
    const std::optional<Bracket> start =
        check_->core_distance(MotionCheck::End::start, 0, required);
    return start && start->low < required && start->low > allowance * tau && keeps(start->low);
  }

  bool confirms_escape(const Vec3& from, const Vec3& to,
                       const StepOptions& options) noexcept override {
    if (!from.allFinite() || !to.allFinite()) return false;
    if (side_->is_forbidden(from, capacity_.work).value_or(false)) return true;
    if (side_->is_forbidden(to, capacity_.work).value_or(true)) return false;
    // The tip must start on the surface, and leave it.
    const double tau = tau_of(from, options);
    const double near = unpromised_within * tau;
    check(from, to, 0.0);
    const std::optional<Bracket> start = check_->core_distance(MotionCheck::End::start, 0, near);
    if (!start || start->low > near) return false;
    const Vec3 beyond_start = from + std::min(1.0, near / (to - from).norm()) * (to - from);
    return check(beyond_start, to, tau).clearance == Clearance::kept;
  }

  void follow(std::shared_ptr<const Mesh> mesh) override {
    adopt(mesh ? std::make_shared<const TriangleTree>(std::move(mesh)) : nullptr);
  }

 private:
  /// Makes all memory for this mesh. If this throws, nothing is changed.
  void adopt(std::shared_ptr<const TriangleTree> tree) {
    if (!tree) throw Error("a monitor needs a mesh, but it is null");
    const Mesh& mesh = tree->mesh();
    double longest = 0.0;
    for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
      const Triangle c = mesh.triangle(t);
      for (std::size_t e = 0; e < 3; ++e)
        longest = std::max(longest, (c[(e + 1) % 3] - c[e]).norm());
    }
    MotionCheck check({{tree}}, sliding_point(), Pose{}, capacity_.triangles);
    SideTest side(std::move(tree), capacity_.triangles);
    check_ = std::move(check);
    side_ = std::move(side);
    longest_edge_ = longest;
  }

  double tau_of(const Vec3& from, const StepOptions& options) const noexcept {
    return 2e-10 * (longest_edge_ + options.radius * (1.0 + 1e-9) + options.tool_radius +
                    options.margin) +
           4e-16 * from.lpNorm<1>();
  }

  /// Decides if the tip stays `due` away from the mesh.
  MotionFinding check(const Vec3& from, const Vec3& to, double due) noexcept {
    const std::array<MeshMotion, 1> still{};
    return check_->check({{from.data(), 3}, {to.data(), 3}, still}, {{due}}, capacity_.work);
  }

  MonitorCapacity capacity_;
  double longest_edge_ = 0.0;  // [length]
  std::optional<MotionCheck> check_;
  std::optional<SideTest> side_;
};

}  // namespace

std::unique_ptr<TipMonitor> make_tip_monitor(std::shared_ptr<const TriangleTree> mesh,
                                             const MonitorCapacity& capacity) {
  return std::make_unique<MeshTipMonitor>(std::move(mesh), capacity);
}

}  // namespace keepout::monitor
