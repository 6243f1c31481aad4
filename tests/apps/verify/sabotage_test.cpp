// SPDX-License-Identifier: BSD-3-Clause
// The campaign can fail: each guard here is broken in a way of its own, and each is found out.

#include <algorithm>
#include <optional>

#include "keepout/activation/paper.h"
#include "keepout/index/pd_tree.h"
#include "keepout/solvers/active_set.h"
#include "small_campaign.h"
#include "trials.h"

namespace keepout::app {
namespace {

/// Goes wherever it is asked to.
class NoGuard final : public Guard {
 public:
  using Guard::Guard;
  Step step(const Motion& motion) noexcept override {
    Step step;
    step.status = Status::free;
    step.motion = motion.desired;
    return step;
  }
};

/// The paper's rule, which knows of no tolerance.
class PaperGuard final : public Guard {
 public:
  explicit PaperGuard(const Scene& scene) : Guard(scene), scene_(&scene) {}

  void begin(const StepOptions& options, Inside) override {
    StepOptions bare = options;
    bare.tool_radius = 0.0;
    bare.margin = 0.0;
    constraint_.emplace(scene_->mesh(), std::make_unique<PdTree>(scene_->mesh()),
                        std::make_unique<PaperRule>(), std::make_unique<ActiveSet>(), bare,
                        Capacity{.triangles = 4096});
  }
  Step step(const Motion& motion) noexcept override { return constraint_->step(motion); }

 private:
  const Scene* scene_;
  std::optional<MotionConstraint> constraint_;
};

/// Keeps less than it should: by so little that only exact distances tell.
class CarelessGuard final : public Guard {
 public:
  explicit CarelessGuard(const Scene& scene) : Guard(scene), scene_(&scene) {}
  void begin(const StepOptions& options, Inside inside) override {
    StepOptions less = options;
    double& part = options.margin > 0.0 ? less.margin : less.tool_radius;
    part = std::max(0.0, part - 3.5 * tolerance(*scene_, options, Vec3::Zero()));
    Guard::begin(less, inside);
  }

 private:
  const Scene* scene_;
};

/// Forgets that the tool is more than a point.
class PointGuard final : public Guard {
 public:
  using Guard::Guard;
  void begin(const StepOptions& options, Inside inside) override {
    StepOptions less = options;
    if (less.margin > 0.0) less.tool_radius = 0.0;
    Guard::begin(less, inside);
  }
};

class OverlongGuard final : public Guard {
 public:
  using Guard::Guard;
  Step step(const Motion& motion) noexcept override {
    Step step = Guard::step(motion);
    if (step.status == Status::free) step.motion *= 1.0 + 1e-6;
    return step;
  }
};

class RestlessGuard final : public Guard {
 public:
  using Guard::Guard;
  Step step(const Motion& motion) noexcept override {
    Step step = Guard::step(motion);
    if (!step.ok()) step.motion = 1e-12 * motion.desired;
    return step;
  }
};

/// Does not care which side a tip is on.
class LenientGuard final : public Guard {
 public:
  using Guard::Guard;
  void begin(const StepOptions& options, Inside) override {
    Guard::begin(options, Inside::taken_as_is);
  }
};

/// Leads tips that are inside the wrong way.
class PerverseGuard final : public Guard {
 public:
  using Guard::Guard;
  Step step(const Motion& motion) noexcept override {
    Step step = Guard::step(motion);
    if (step.status == Status::recovering) step.motion = -step.motion;
    return step;
  }
};

template <class Kind>
std::unique_ptr<Guard> make(const Scene& scene) {
  return std::make_unique<Kind>(scene);
}

struct Sabotaged {
  const char* name;
  std::string_view shape;
  std::unique_ptr<Guard> (*make_guard)(const Scene&);
  Breach breach;
  std::uint64_t at_least = 1;  // breaches
  std::uint64_t steps = 10'000;
};
class Sabotage : public testing::TestWithParam<Sabotaged> {};
INSTANTIATE_TEST_SUITE_P(
    Guards, Sabotage,
    testing::Values(
        Sabotaged{"WithoutAGuardATipPenetrates", "sphere", make<NoGuard>, Breach::penetration, 11},
        Sabotaged{"WithoutAGuardATipIsTooNear", "sphere", make<NoGuard>, Breach::too_near, 11},
        Sabotaged{"ThePaperWithoutAMarginPenetrates", "triangle_soup", make<PaperGuard>,
                  Breach::penetration},
        Sabotaged{"ThePaperWithoutAMarginIsTooNear", "saddle_terrain", make<PaperGuard>,
                  Breach::too_near, 11},
        Sabotaged{"AFewTolerancesTooLittle", "cube", make<CarelessGuard>, Breach::too_near, 6},
        Sabotaged{"AFewTolerancesTooLittleInFolds", "cortex", make<CarelessGuard>, Breach::too_near,
                  6},
        Sabotaged{"AToolTakenForAPoint", "cortex", make<PointGuard>, Breach::too_near, 11, 20'000},
        Sabotaged{"AStepLongerThanAskedFor", "sphere", make<OverlongGuard>, Breach::too_long, 11},
        Sabotaged{"AMotionOfAFailedStep", "sphere", make<RestlessGuard>, Breach::moved_anyway, 1,
                  50'000},
        Sabotaged{"ATipLeftInside", "sphere", make<LenientGuard>, Breach::left_inside},
        Sabotaged{"ATipLedDeeper", "sphere", make<PerverseGuard>, Breach::led_deeper}),
    by_name);

TEST_P(Sabotage, IsCaught) {
  const Sabotaged& row = GetParam();
  const Findings findings =
      campaign_on(row.shape, {.steps = row.steps, .make_guard = row.make_guard});
  EXPECT_GE(count(findings, row.breach), row.at_least);
}

TEST(SabotagedStep, ABreachIsNotedWithAllThatIsNeededToRepeatIt) {
  const Findings findings =
      campaign_on("cube", {.steps = 20'000, .make_guard = make<CarelessGuard>});
  ASSERT_FALSE(findings.breaches.empty());
  Scene scene("cube", make_shape("cube"), "wide_bvh");
  const auto vector = [](const Json& json) {
    const auto xyz = json.get<std::array<double, 3>>();
    return Vec3(xyz[0], xyz[1], xyz[2]);
  };
  for (const Json& breach : findings.breaches) {
    if (breach["joints"] > 0) continue;
    CarelessGuard guard(scene);
    guard.begin({.radius = breach["radius"],
                 .tool_radius = breach["tool_radius"],
                 .margin = breach["margin"],
                 .damping = breach["damping"],
                 .recovery = breach["recovery"],
                 .refinements = breach["refinements"],
                 .nodes = breach["nodes"],
                 .query = breach["query"] == "sphere" ? Query::sphere : Query::motion},
                Inside::taken_as_is);
    const Step step =
        guard.step({.tip = vector(breach["tip"]), .desired = vector(breach["desired"])});
    EXPECT_EQ(step.motion, vector(breach["motion"])) << breach;
    EXPECT_EQ(name(step.status), breach["status"]);
  }
}

}  // namespace
}  // namespace keepout::app
