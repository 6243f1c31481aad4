// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "keepout/error.h"
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
  MeshTipMonitor(std::shared_ptr<const Mesh> mesh, const MonitorCapacity& capacity)
      : capacity_(capacity) {
    follow(std::move(mesh));
  }

  bool confirms(const Vec3& from, const Vec3& to, const StepOptions& options) noexcept override {
    const std::array<MeshMotion, 1> still{};
    const InstrumentMotion motion{{from.data(), 3}, {to.data(), 3}, still};
    const double required = options.tool_radius + options.margin;
    const double tau = 2e-10 * (longest_edge_ + options.radius * (1.0 + 1e-9) + required) +
                       4e-16 * from.lpNorm<1>();
    const auto keeps = [&](double due) {
      const MotionFinding finding =
          check_->check(motion, {{due - allowance * tau}}, capacity_.work);
      return finding.clearance == Clearance::kept;
    };
    if (!(required > unpromised_within * tau)) return false;
    if (keeps(required)) return true;
    // A tip that starts closer must not come closer.
    const std::optional<Bracket> start =
        check_->core_distance(MotionCheck::End::start, 0, required);
    return start && start->low < required && start->low > unpromised_within * tau &&
           keeps(start->low);
  }

  void follow(std::shared_ptr<const Mesh> mesh) override {
    if (!mesh) throw Error("a monitor needs a mesh, but it is null");
    double longest = 0.0;
    for (TriangleId t = 0; t < mesh->triangle_count(); ++t) {
      const Triangle c = mesh->triangle(t);
      for (std::size_t e = 0; e < 3; ++e)
        longest = std::max(longest, (c[(e + 1) % 3] - c[e]).norm());
    }
    const std::array trees{std::make_shared<const TriangleTree>(std::move(mesh))};
    check_.emplace(trees, sliding_point(), Pose{}, capacity_.triangles);
    longest_edge_ = longest;
  }

 private:
  MonitorCapacity capacity_;
  double longest_edge_ = 0.0;  // [length]
  std::optional<MotionCheck> check_;
};

}  // namespace

std::unique_ptr<TipMonitor> make_tip_monitor(std::shared_ptr<const Mesh> mesh,
                                             const MonitorCapacity& capacity) {
  return std::make_unique<MeshTipMonitor>(std::move(mesh), capacity);
}

}  // namespace keepout::monitor
