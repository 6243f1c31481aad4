// SPDX-License-Identifier: BSD-3-Clause
#include "verify/attack.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "keepout/activation/certified.h"
#include "keepout/solvers/registry.h"
#include "keepout/step/motion_constraint.h"
#include "operators/attacker.h"
#include "verify/robot/excess.h"

namespace keepout::app {
namespace {

using oracle::Breach;
using oracle::RobotVerdict;

constexpr std::size_t block = 500;      // cycles until the margin is raised or lowered
constexpr double raise = 0.5;           // [mm]
constexpr double blocked_below = 0.05;  // fraction of the commanded motion
constexpr double useful_above = 0.05;   // fraction of the largest reduction of the cost
constexpr double movable_above = 0.1;   // fraction of the commanded motion
constexpr double strayed_above = 1.05;  // multiple of the error without motion
// Searches on average one of this many blocked cycles, because a search costs like a thousand.
constexpr std::uint64_t sampled = 2000;
constexpr std::uint64_t sampled_where_drawn = 100;
constexpr int hopeless_after = 50;     // consecutive cycles without a proved motion
constexpr double skipped = 1.0 / 3.0;  // fraction of the placements of a moving mesh

bool is_raised(const Scenario& scenario, std::size_t cycle) noexcept {
  const bool is_odd = (cycle / block) % 2 == 1;
  return scenario.raises_margin && (scenario.begin == Begin::wedged ? !is_odd : is_odd);
}

/// The judge's distance of the flange from the commanded pose, after the step and without a motion.
/// Both distances are weighted like the task.
struct Missed {
  double moving, standing;
};

Missed missed(const RobotSetup& setup, const monitor::JudgedRobot& robot,
              std::span<const double> from, std::span<const double> to, const Twist& desired) {
  const auto before = monitor::place(robot, setup.start.base, from);
  const auto after = monitor::place(robot, setup.start.base, to);
  const Vec3& flange = setup.robot.flange.position;
  const Vec3 way = after.back().at(flange) - before.back().at(flange);
  const Mat3 turned = (after.back().axes * before.back().axes.transpose()).cast<double>();
  const Eigen::AngleAxisd turn(turned);
  const double weight = setup.options.orientation_weight;
  const Vec3 turn_off = weight * (turn.angle() * turn.axis() - desired.angular);
  return {std::hypot((way - desired.linear).norm(), turn_off.norm()),
          std::hypot(desired.linear.norm(), weight * desired.angular.norm())};
}

oracle::JudgedScene judged_scene(const RobotSetup& setup) {
  oracle::JudgedScene scene{.robot = setup.robot.judged(),
                            .base = setup.start.base,
                            .meshes = {},
                            .guides = setup.guides,
                            .has_band = setup.scenario->attacked == Attacked::instrument};
  for (const SetupMesh& mesh : setup.meshes) {
    scene.meshes.push_back({mesh.scene->tree(), mesh.margin, mesh.motion.first});
  }
  return scene;
}

/// One instrument from its start. The attempt ends early after 50 consecutive cycles without a
/// proved motion.
class RobotAttempt {
 public:
  RobotAttempt(const Campaign& campaign, RobotSetup setup, Random& random, Attack& attack)
      : campaign_(campaign),
        attack_(attack),
        tally_(attack.row),
        random_(random),
        setup_(std::move(setup)),
        judged_(setup_.robot.judged()),
        chain_(setup_.robot.make(setup_.start.base).chain()),
        subject_(campaign.make_subject(setup_)),
        judge_(judged_scene(setup_), chain_, setup_.start.positions, setup_.options,
               subject_->tolerance()),
        attacker_(*setup_.meshes[0].scene, random, setup_.speed),
        positions_(setup_.start.positions) {
    if (setup_.is_drawn) return;
    const Scene& scene = *setup_.meshes[0].scene;
    point_.emplace(scene.mesh(), scene.shared_index(), std::make_unique<CertifiedRule>(),
                   make_solver("active_set"),
                   StepOptions{.radius = 10.0 * setup_.speed,
                               .tool_radius = judged_.bodies.back().radius,
                               .margin = setup_.options.margin});
  }

  /// Runs a cycle. Returns false if the attempt ends here.
  bool cycle(std::uint64_t number) {
    if (number % block == 0) set_margin(number);
    if (setup_.scenario->moves) place_meshes(number);
    failures_ = make_cycle() ? 0 : failures_ + 1;
    if (waited_) {
      ++*waited_;
      if (judge_.is_recovered()) {
        ++tally_.recovered;
        tally_.recovery_cycles += *waited_;
        waited_.reset();
      }
    }
    return failures_ < hopeless_after;
  }

 private:
  void set_margin(std::size_t cycle) {
    InstrumentOptions options = setup_.options;
    if (is_raised(*setup_.scenario, cycle)) options.margin += raise;
    if (options.margin != margin_) {
      subject_->set_options(options);
      judge_.follow(options);
    }
    margin_ = options.margin;
    waited_.reset();  // a recovery that takes longer than a block is not counted
    const bool is_new = cycle == 0 || is_raised(*setup_.scenario, cycle);
    if (is_new && !judge_.is_recovered()) {
      ++tally_.recoveries;
      waited_ = 0;
    }
  }

  /// Places the meshes with the velocities that lead to their poses a cycle later. Omits one in
  /// three placements, so that the mesh continues as before and later catches up, maybe at several
  /// times its speed. An approaching mesh is always placed: the joints can only match its own
  /// speed.
  void place_meshes(std::uint64_t cycle) {
    for (std::size_t m = 0; m < setup_.meshes.size(); ++m) {
      const MeshMotion& motion = setup_.meshes[m].motion;
      const auto skips = [&] { return !motion.comes_on && random_.uniform() < skipped; };
      if (cycle > 0 && (motion.is_still() || skips())) continue;
      const Pose now = judge_.pose(m);
      const Pose then = motion.at(static_cast<double>(cycle) + 1.0);
      const double period = setup_.options.period;
      const Eigen::AngleAxisd turn(Mat3(then.rotation * now.rotation.transpose()));
      const Twist velocity{.linear = (then.position - now.position) / period,
                           .angular = turn.angle() / period * turn.axis()};
      subject_->place(m, now, velocity);
      judge_.place(m, now, velocity);
    }
  }

  /// Returns the commanded motion of the flange. The operator attacks the first mesh.
  Twist wanted(const Vec3& flange) {
    const Pose& mesh = judge_.pose(0);
    Twist twist = attacker_.next(mesh.rotation.transpose() * (flange - mesh.position));
    twist.linear = mesh.rotation * twist.linear;
    twist.angular = mesh.rotation * twist.angular;
    return twist;
  }

  /// Returns true if the step returned a motion that may be executed, which may be zero.
  bool make_cycle() {
    ChainState state;
    chain_.forward_kinematics(positions_, state);
    const Twist desired = wanted(state.flange().position);
    const BenchClock::time_point start = BenchClock::now();
    const InstrumentStep step = subject_->step(positions_, desired);
    const double time = microseconds_since(start);
    attack_.step_times.add(time);
    (step.rows > 0 ? attack_.contact_times : attack_.free_times).add(time);
    if (point_) {
      const BenchClock::time_point after = BenchClock::now();
      point_->step({.tip = state.flange().position, .desired = desired.linear});
      attack_.point_times.add(microseconds_since(after));
    }
    RobotTask::Increment made = RobotTask::Increment::Zero(chain_.size());
    std::vector<double> next = positions_;
    for (std::size_t k = 0; step.ok() && k < next.size(); ++k) {
      made[static_cast<Eigen::Index>(k)] = step.increment[k];
      next[k] += step.increment[k];
    }
    count_blocked(step, made, desired);
    note(step, judge_.judge(next, step, setup_.must_keep));
    if (step.status == Status::free && setup_.scenario->attacked == Attacked::instrument) {
      const Missed off = missed(setup_, judged_, positions_, next, desired);
      const double allowed = strayed_above * off.standing + subject_->tolerance();
      if (off.moving > allowed) tally_.count(Breach::strayed);
    }
    positions_ = next;
    return step.ok();
  }

  void note(const InstrumentStep& step, const RobotVerdict& verdict) {
    ++tally_.cycles;
    ++tally_.statuses[static_cast<std::size_t>(step.status)];
    if (verdict.is_below) tally_.count(Breach::too_near);
    if (verdict.is_below && verdict.least < 0.0) {
      ++tally_.in_mesh;
      tally_.deepest = std::max(tally_.deepest, -verdict.least);
    }
    tally_.undecided += verdict.is_undecided ? 1 : 0;
    if (verdict.limits_broken) tally_.count(Breach::limits_broken);
    if (verdict.is_guide_left) tally_.count(Breach::guide_left);
    tally_.least_beyond = std::min(tally_.least_beyond, verdict.beyond);
    tally_.least_in_tau = std::min(tally_.least_in_tau, verdict.beyond / subject_->tolerance());
    tally_.least_guide_in_tau = std::min(tally_.least_guide_in_tau, verdict.guide_room);
    const auto rounds = static_cast<std::uint64_t>(step.rounds);
    tally_.rounds += rounds;
    tally_.most_rounds = std::max(tally_.most_rounds, rounds);
    tally_.rows += step.rows;
    tally_.most_work_units =
        std::max<std::uint64_t>(tally_.most_work_units, subject_->work_units());
  }

  /// Counts cycles that execute almost nothing of the commanded motion, and searches some of them
  /// for a better motion. Skips recoveries, which do not follow the command. Does not search beside
  /// a moving mesh, where no motion may be forbidden.
  void count_blocked(const InstrumentStep& step, const RobotTask::Increment& made,
                     const Twist& desired) {
    if (step.status == Status::recovering) return;
    InstrumentOptions options = setup_.options;
    options.margin = margin_;
    const RobotTask task(chain_, positions_, desired, options);
    const RobotTask::Increment none = RobotTask::Increment::Zero(made.size());
    tally_.worse += task.cost(made) > 1.05 * task.cost(none) ? 1 : 0;
    if (!(task.share(made) < blocked_below)) return;
    const std::uint64_t usual = setup_.is_drawn ? sampled_where_drawn : sampled;
    const std::uint64_t every = campaign_.searched > 0 ? campaign_.searched : usual;
    ++tally_.blocked;
    if (setup_.scenario->moves || random_.below(every) != 0) return;
    const Search found =
        search(task, positions_, {made.data(), positions_.size()}, judge_, random_);
    ++tally_.samples;
    // A multiple of 2^-30: the sum of several million is exact, whatever their order.
    tally_.excess += std::ldexp(std::round(std::ldexp(found.saved, 30)), -30);
    tally_.useful += found.saved > useful_above ? 1 : 0;
    tally_.movable += found.share >= movable_above ? 1 : 0;
  }

  const Campaign& campaign_;
  Attack& attack_;
  Tally& tally_;
  Random& random_;
  RobotSetup setup_;
  monitor::JudgedRobot judged_;
  Chain chain_;
  std::unique_ptr<RobotSubject> subject_;
  std::optional<MotionConstraint> point_;  // a ball at the tip alone, timed for comparison
  oracle::RobotJudge judge_;
  Attacker attacker_;
  std::vector<double> positions_;
  double margin_ = 0.0;                  // current [mm]
  std::optional<std::uint64_t> waited_;  // since the start of a recovery [cycles]
  int failures_ = 0;                     // consecutive cycles without a motion
};

class RobotAttack final : public Attack {
 public:
  RobotAttack(const Campaign& campaign, std::shared_ptr<const RobotUnderTest> robot,
              const Arena& arena, const Campaign::RowKind& kind,
              std::shared_ptr<std::shared_ptr<Scene>> loaded)
      : Attack({.mesh = arena.mesh,
                .scenario = std::string(kind.scenario->name),
                .speed = kind.speed}),
        campaign_(campaign),
        arena_(arena),
        scenario_(*kind.scenario),
        robot_(std::move(robot)),
        is_drawn_(!arena.load || robot_ == nullptr || scenario_.carrier == Carrier::slides),
        length_(is_drawn_ ? cycles_of_a_drawn_trajectory : cycles_of_a_trajectory),
        trajectories_(trajectory_count(campaign.cycles, length_)),
        next_(campaign.shard.index - 1),
        loaded_(std::move(loaded)) {}

  std::uint64_t begin() override {
    attempt_.reset();
    if (arena_.load && !*loaded_) {
      std::vector<Scene> scenes = arena_.load();
      if (scenes.empty()) return 0;
      *loaded_ = std::make_shared<Scene>(std::move(scenes.front()));
    }
    if (*loaded_) row.triangles = (*loaded_)->mesh()->triangle_count();
    // A row whose first trajectory has no start ends, in every shard.
    if (!is_begun_ && !is_done()) {
      random_ = random_of(0);
      if (!draw()) {
        const std::uint64_t count = campaign_.shard.count;
        row.startless = (trajectories_ - next_ + count - 1) / count;
        next_ = trajectories_;
      }
    }
    is_begun_ = true;
    if (is_done()) return 0;
    trajectory_ = next_;
    next_ += campaign_.shard.count;
    random_ = random_of(trajectory_);
    return std::min(length_, campaign_.cycles - trajectory_ * length_);
  }

  bool cycle(std::uint64_t number) override {
    row.now = trajectory_ * length_ + number + 1;
    if (!attempt_) {
      std::optional<RobotSetup> setup = draw();
      if (!setup) {
        ++row.startless;
        return false;
      }
      ++row.starts;
      row.period = std::max(row.period, setup->options.period);
      attempt_.emplace(campaign_, std::move(*setup), random_, *this);
      start_ = number;
    }
    if (!attempt_->cycle(number - start_)) attempt_.reset();
    return true;
  }

  bool is_done() const override { return next_ >= trajectories_; }

 private:
  /// Returns the random numbers of a trajectory, which are independent of all others.
  Random random_of(std::uint64_t trajectory) const {
    const auto number = static_cast<std::uint64_t>(&scenario_ - scenarios().data());
    Random of_seed(campaign_.seed + 1000 * number);
    return Random(of_seed.bits() ^ trajectory);
  }

  /// Draws a setup. Returns nothing if several draws find no start.
  std::optional<RobotSetup> draw() {
    const auto draw_mesh = [&](Random& random) {
      return *loaded_ ? *loaded_ : arena_.draw(random);
    };
    const auto options = [&](const Chain& chain) {
      return options_of(campaign_, chain, row.speed);
    };
    std::optional<RobotSetup> setup;
    for (int left = is_drawn_ ? 20 : 1; !setup && left > 0; --left) {  // another draw may have one
      setup = draw_setup(scenario_, robot_.get(), row.speed, random_, draw_mesh, options);
    }
    if (setup) setup->is_drawn = is_drawn_;
    return setup;
  }

  const Campaign& campaign_;
  const Arena& arena_;
  const Scenario& scenario_;
  std::shared_ptr<const RobotUnderTest> robot_;  // null: drawn for each start
  bool is_drawn_;                                // mesh or robot change with each setup
  std::uint64_t length_;                         // of a trajectory [cycles]
  std::uint64_t trajectories_;                   // of all shards
  std::uint64_t next_;                           // the number of the next one
  std::shared_ptr<std::shared_ptr<Scene>>
      loaded_;  // shared by all rows of the mesh; null until the first one
  bool is_begun_ = false;
  std::uint64_t trajectory_ = 0;  // the current one
  std::uint64_t start_ = 0;       // of the attempt, in the trajectory [cycles]
  Random random_{0};
  std::optional<RobotAttempt> attempt_;
};

}  // namespace

InstrumentOptions options_of(const Campaign& campaign, const Chain& chain, double speed) {
  InstrumentOptions options{.margin = campaign.margin,
                            .band = std::min(0.002, 0.05 * campaign.margin),
                            .certified = campaign.motion};
  if (campaign.rate > 0.0) {
    options.period = 1.0 / campaign.rate;
    return options;
  }
  for (int k = 1; k <= chain.size(); ++k) {
    const double needed = chain.joint(k).kind == JointKind::revolute ? 0.1 : 2.5;
    options.period = std::max(options.period, speed * needed / chain.joint(k).limits.velocity);
  }
  return options;
}

Attacks attacks_on_instruments(const Campaign& campaign, std::span<const Arena> arenas) {
  std::shared_ptr<const RobotUnderTest> robot;
  if (!campaign.robot.empty()) {
    robot = std::make_shared<RobotUnderTest>(chosen_robot(campaign.robot, campaign.bodies));
  }
  Attacks attacks;
  for (const Arena& arena : arenas) {
    const auto loaded = std::make_shared<std::shared_ptr<Scene>>();
    for (const Campaign::RowKind& kind : campaign.row_kinds()) {
      attacks.push_back(std::make_unique<RobotAttack>(campaign, robot, arena, kind, loaded));
    }
  }
  return attacks;
}

}  // namespace keepout::app
