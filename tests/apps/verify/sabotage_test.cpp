// SPDX-License-Identifier: BSD-3-Clause
// Campaigns can fail: each step here is broken in one respect, and the campaign finds its breach.

#include <algorithm>
#include <optional>

#include "keepout/activation/paper.h"
#include "keepout/index/pd_tree.h"
#include "keepout/solvers/active_set.h"
#include "small_campaign.h"
#include "trials.h"

namespace keepout::app {
namespace {

using oracle::Breach;

/// A step of a tip that is broken in one respect. The judge assumes the options that were drawn.
struct TipDefect {
  void (*of_options)(const Scene&, StepOptions&, Inside&) = [](auto&, auto&, auto&) {};
  void (*of_step)(const Motion&, Step&) = [](auto&, auto&) {};
};

class BrokenGuard final : public Guard {
 public:
  BrokenGuard(const Scene& scene, const TipDefect& defect)
      : Guard(scene), scene_(&scene), defect_(defect) {}

  void begin(const StepOptions& options, Inside inside) override {
    StepOptions wrong = options;
    defect_.of_options(*scene_, wrong, inside);
    Guard::begin(wrong, inside);
  }
  Step step(const Motion& motion) noexcept override {
    Step step = Guard::step(motion);
    defect_.of_step(motion, step);
    return step;
  }

 private:
  const Scene* scene_;
  TipDefect defect_;
};

/// The rule of Li et al. (2020), which has no tolerance.
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

/// Makes every desired motion.
constexpr TipDefect no_guard{.of_step = [](const Motion& motion, Step& step) {
  step = {};
  step.status = Status::free;
  step.motion = motion.desired;
}};

/// Keeps too little clearance, by so little that only exact distances show it.
constexpr TipDefect careless{.of_options = [](const Scene& scene, StepOptions& options, Inside&) {
  double& part = options.margin > 0.0 ? options.margin : options.tool_radius;
  part = std::max(0.0, part - 3.5 * scene.judged().tolerance(options, Vec3::Zero()));
}};

/// Treats the tool as a point.
constexpr TipDefect point{.of_options = [](const Scene&, StepOptions& options, Inside&) {
  if (options.margin > 0.0) options.tool_radius = 0.0;
}};

constexpr TipDefect overlong{.of_step = [](const Motion&, Step& step) {
  if (step.status == Status::free) step.motion *= 1.0 + 1e-6;
}};

constexpr TipDefect restless{.of_step = [](const Motion& motion, Step& step) {
  if (!step.ok()) step.motion = 1e-12 * motion.desired;
}};

/// Does not classify the side of a tip.
constexpr TipDefect lenient{
    .of_options = [](const Scene&, StepOptions&, Inside& inside) { inside = Inside::taken_as_is; }};

/// Moves tips that are inside in the wrong direction.
constexpr TipDefect perverse{.of_step = [](const Motion&, Step& step) {
  if (step.status == Status::recovering) step.motion = -step.motion;
}};

/// A step of an instrument that is broken in one respect.
struct Defect {
  void (*of_setup)(RobotSetup&) = [](RobotSetup&) {};
  void (*of_step)(InstrumentStep&, std::vector<double>&) = [](auto&, auto&) {};
  double margin_less = 0.0;  // [tolerances]
  bool knows_velocities = true;
};

class BrokenSubject final : public RobotSubject {
 public:
  BrokenSubject(RobotSetup setup, const Defect& defect) : defect_(defect) {
    defect.of_setup(setup);
    meshes_ = setup.meshes.size();
    subject_ = make_subject(setup);
  }
  void set_options(const InstrumentOptions& options) override {
    InstrumentOptions less = options;
    less.margin -= defect_.margin_less * tolerance();
    subject_->set_options(less);
  }
  void place(std::size_t mesh, const Pose& pose, const Twist& velocity) override {
    if (mesh < meshes_) subject_->place(mesh, pose, defect_.knows_velocities ? velocity : Twist{});
  }
  InstrumentStep step(std::span<const double> q, const Twist& desired) override {
    InstrumentStep step = subject_->step(q, desired);
    defect_.of_step(step, increment_);
    return step;
  }
  double tolerance() const override { return subject_->tolerance(); }

 private:
  Defect defect_;
  std::size_t meshes_;
  std::unique_ptr<RobotSubject> subject_;
  std::vector<double> increment_;
};

void widen_guides(RobotSetup& setup) {
  for (oracle::JudgedGuide& guide : setup.guides) {
    guide.radius += 3.0 * guide.band;
    if (guide.region == oracle::JudgedGuide::Region::half_space) {
      guide.radius = 0.0;
      guide.origin -= 3.0 * guide.band * guide.direction;
    }
  }
}

/// Removes the first point of the last body, which has at least three.
void cut_off_a_corner(RobotSetup& setup) {
  const auto cut = [](auto& points) { points.erase(points.begin()); };
  cut(setup.robot.bodies.back().points);
  cut(setup.robot.model.bodies.back().points);
}

void forget_a_mesh(RobotSetup& setup) { setup.meshes.pop_back(); }

/// Stands still instead of retreating.
void freeze(InstrumentStep& step, std::vector<double>&) {
  if (step.status != Status::free) step = {.status = Status::unsolved, .clearance_fraction = 0.0};
}

/// Makes 2.2 times a free motion.
void overshoot(InstrumentStep& step, std::vector<double>& longer) {
  if (step.status != Status::free) return;
  longer.assign(step.increment.begin(), step.increment.end());
  for (double& x : longer) x *= 2.2;
  step.increment = longer;
}

using MakeGuard = std::unique_ptr<Guard> (*)(const Scene&);
template <const TipDefect& defect>
std::unique_ptr<Guard> make(const Scene& scene) {
  return std::make_unique<BrokenGuard>(scene, defect);
}
std::unique_ptr<Guard> make_paper(const Scene& scene) {
  return std::make_unique<PaperGuard>(scene);
}

Campaign campaign_of(std::uint64_t steps, MakeGuard make_guard) {
  return {.steps = steps, .make_guard = make_guard};
}
Campaign campaign_of(const std::string& scenario, std::uint64_t cycles, const Defect& defect) {
  return {.scenarios = {scenario},
          .cycles = test::trials(cycles),
          .speeds = {1.0},
          .make_subject = [defect](const RobotSetup& setup) {
            return std::make_unique<BrokenSubject>(setup, defect);
          }};
}

struct Sabotaged {
  const char* name;
  std::string_view mesh;
  Campaign campaign;
  Breach breach;
  std::uint64_t at_least = 1;  // breaches
};
Sabotaged tip(const char* name, std::string_view mesh, MakeGuard make_guard, Breach breach,
              std::uint64_t at_least = 1, std::uint64_t steps = 10'000) {
  return {name, mesh, campaign_of(steps, make_guard), breach, at_least};
}
Sabotaged instrument(const char* name, const std::string& scenario, std::string_view mesh,
                     const Defect& defect, Breach breach = Breach::too_near,
                     std::uint64_t at_least = 1, std::uint64_t cycles = 10'000) {
  return {name, mesh, campaign_of(scenario, cycles, defect), breach, at_least};
}

class Sabotage : public testing::TestWithParam<Sabotaged> {};
INSTANTIATE_TEST_SUITE_P(
    Guards, Sabotage,
    testing::Values(
        tip("WithoutAGuardATipPenetrates", "sphere", make<no_guard>, Breach::penetration, 11),
        tip("WithoutAGuardATipIsTooNear", "sphere", make<no_guard>, Breach::too_near, 11),
        tip("ThePaperWithoutAMarginPenetrates", "triangle_soup", make_paper, Breach::penetration),
        tip("ThePaperWithoutAMarginIsTooNear", "saddle_terrain", make_paper, Breach::too_near, 11),
        tip("AFewTolerancesTooLittle", "cube", make<careless>, Breach::too_near, 6),
        tip("AFewTolerancesTooLittleInFolds", "cortex", make<careless>, Breach::too_near, 6),
        tip("AToolTakenForAPoint", "cortex", make<point>, Breach::too_near, 11, 20'000),
        tip("AStepLongerThanAskedFor", "sphere", make<overlong>, Breach::too_long, 11),
        tip("AMotionOfAFailedStep", "sphere", make<restless>, Breach::moved_anyway, 1, 50'000),
        tip("ATipLeftInside", "sphere", make<lenient>, Breach::left_inside),
        tip("ATipLedDeeper", "sphere", make<perverse>, Breach::led_deeper)),
    by_name);
INSTANTIATE_TEST_SUITE_P(
    Scenarios, Sabotage,
    testing::Values(
        instrument("GuidesThatAreTooWide", "guides", "saddle", {.of_setup = widen_guides},
                   Breach::guide_left),
        instrument("GuidesOfATipThatAreTooWide", "tip_guides", "saddle", {.of_setup = widen_guides},
                   Breach::guide_left),
        instrument("AMeshWhoseVelocityIsNotKnown", "moving", "bowl", {.knows_velocities = false}),
        instrument("AMeshThatIsForgotten", "meshes", "bowl", {.of_setup = forget_a_mesh}),
        instrument("ACornerOfABladeThatIsForgotten", "blade", "saddle",
                   {.of_setup = cut_off_a_corner}),
        instrument("ACornerOfAConvexToolThatIsForgotten", "convex_tool", "saddle",
                   {.of_setup = cut_off_a_corner}, Breach::too_near, 1, 40'000),
        instrument("AToolThatDoesNotGiveWay", "stuck", "saddle", {.of_step = freeze}),
        instrument("AMarginThatIsTenTolerancesTooSmall", "convex_tool", "saddle",
                   {.margin_less = 10.0}),
        instrument("AMotionThatOvershoots", "unlimited", "saddle", {.of_step = overshoot},
                   Breach::strayed, test::all_trials() ? 101 : 11, 2000)),
    by_name);

TEST_P(Sabotage, IsCaught) {
  const Sabotaged& row = GetParam();
  const Findings findings = campaign_on(row.mesh, row.campaign);
  const Tally& tally = findings.rows.at(0);
  EXPECT_GE(tally[row.breach], row.at_least);
  EXPECT_GE(tally.broken(), tally[row.breach]);
  EXPECT_GT(tally.first_breach, 0u);
  RecordProperty("first_breach", std::to_string(tally.first_breach));
  const CampaignResult result = result_of(row.campaign, findings);
  EXPECT_TRUE(result.is_broken);
  if (row.campaign.is_of_instruments()) return;
  EXPECT_EQ(result.record["total"]["breaches"][std::string(name(row.breach))], tally[row.breach]);
}

TEST(SabotagedStep, ABreachIsNotedWithAllThatIsNeededToRepeatIt) {
  const Findings findings = campaign_on("cube", campaign_of(20'000, make<careless>));
  ASSERT_FALSE(findings.breaches.empty());
  Scene scene("cube", make_shape("cube"), "wide_bvh");
  const auto vector = [](const Json& json) {
    const auto xyz = json.get<std::array<double, 3>>();
    return Vec3(xyz[0], xyz[1], xyz[2]);
  };
  for (const Json& breach : findings.breaches) {
    if (breach["joints"] > 0) continue;
    BrokenGuard guard(scene, careless);
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

TEST(SabotagedStep, StandingStillForNothingIsCounted) {
  const Findings findings =
      campaign_on("saddle", campaign_of("approach", 2000, {.of_step = freeze}));
  EXPECT_GT(findings.rows.at(0).movable, findings.rows.at(0).samples / 4);
}

TEST(SabotagedStep, WhereTheLinearisedMotionIsCertifiedTheJudgeSeesItTooClose) {
  const Findings findings = campaign_on(
      "gear",
      {.robot = "psm", .cycles = 4000, .speeds = {20.0}, .motion = CertifiedMotion::linearized});
  const Tally& row = findings.rows.at(0);
  EXPECT_GT(row[Breach::too_near], 0u);
  EXPECT_LT(row.least_beyond, -1e-3);
  EXPECT_EQ(row[Breach::limits_broken], 0u);
}

}  // namespace
}  // namespace keepout::app
