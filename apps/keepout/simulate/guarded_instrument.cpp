// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "keepout/factory/make_motion_constraint.h"
#include "keepout/judges/robot_judge.h"
#include "keepout/monitor/monitors.h"
#include "keepout/solvers/active_set.h"
#include "operators/attacker.h"
#include "record/drawn_mesh.h"
#include "record/json_parts.h"
#include "shared/clip.h"
#include "shared/command_line.h"
#include "shared/names.h"
#include "shared/number_text.h"
#include "shared/robot_file.h"
#include "simulate/guide_audit.h"
#include "simulate/measured_instrument.h"
#include "simulate/simulated_tool.h"
#include "simulate/tracking_columns.h"
#include "verify/campaign.h"

namespace keepout::app {
namespace {

/// The guard of an instrument. `measured`: that of a simulated robot, which follows the setpoints
/// of the run before it.
enum class Mode : std::uint8_t { certified, linearized, tip_only, none, measured };
const std::vector<std::string> mode_names{"certified", "linearized", "tip only", "none"};

/// More bodies than this have no columns on a terminal, only in the record.
constexpr std::size_t most_printed_bodies = 3;

/// The modes with --physics: the certified step, and the robot that follows it.
constexpr std::array physical_modes{Mode::certified, Mode::measured};

std::string manner_name(Manner manner, bool is_file) {
  switch (manner) {
    case Manner::push:
      return is_file ? "pushing with the tool" : "pushing with the jaw";
    case Manner::lean:
      return is_file ? "leaning on the surface" : "leaning with the shaft";
    case Manner::rotate:
      break;
  }
  return is_file ? "rotating the tool" : "rotating the wrist";
}

/// Returns true if each body begins where the one before ends, and the first one in the port.
bool are_in_a_row(const Instrument& instrument) {
  LinkPoint end{0, Vec3::Zero()};
  for (const Body& body : instrument.bodies()) {
    const LinkPoint& begin = body.points.front();
    if (begin.link != end.link || begin.position != end.position) return false;
    end = body.points.back();
  }
  return true;
}

Columns<RunTally> mode_columns(std::span<const Body> bodies, bool has_guides) {
  Columns<RunTally> columns{
      {"mesh", &RunTally::mesh, "mesh", -12},
      {"speed", &RunTally::speed, "speed", 5},
      {"mode", &RunTally::guard, "mode", -10},
      {"cycles", &RunTally::cycles, "cycles", 7},
      {"refused", [](const RunTally& t) { return Json(t.with(Outcome::stopped)); }, "refused", 7},
      {"limits_broken", &RunTally::breaches, "limits", 6},
      {"below", [](const RunTally& t) { return Json(t.any.below); }, "close", 7},
      {"in_mesh", [](const RunTally& t) { return Json(t.any.in_mesh); }, "in mesh", 7}};
  if (has_guides) columns.push_back({"guides_left", &RunTally::guides_left, "guides", 7});
  const bool is_printed = bodies.size() <= most_printed_bodies;
  if (!is_printed) {
    columns.push_back({"", [](const RunTally& t) { return Json(t.any.deepest); }, "deepest", 7,
                       number_text<"%.2f">});
  }
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const std::string& body = bodies[b].name;
    const auto of_body = [b](auto figure) {
      return [=](const RunTally& t) { return Json(t.bodies[b].*figure); };
    };
    columns.push_back(
        {body + "_below", of_body(&BodyTally::below), body + " close", is_printed ? 11 : 0});
    columns.push_back(
        {body + "_in_mesh", of_body(&BodyTally::in_mesh), "in mesh", is_printed ? 7 : 0});
    columns.push_back({body + "_deepest_mm", of_body(&BodyTally::deepest), "deepest",
                       is_printed ? 7 : 0, number_text<"%.2f">});
  }
  return columns;
}

constexpr const char* columns_meaning =
    R"(close: cycles in which a body was closer than its certified clearance; an independent judge
examines five poses of each. in mesh: of these, cycles in which the body reached into the mesh;
deepest: the depth in mm; beside an open mesh at most the radius. refused: cycles without a proved motion; limits:
cycles that broke a joint limit; guides, if any: cycles that left a guide by more than guaranteed.
)";

/// Returns the depth of the deepest point of a segment inside a closed surface, accurate to 0.01
/// mm. Negative if no point of the segment is inside. [mm]
double deepest(const oracle::SafetyOracle& surface, const monitor::Segment& segment) {
  const auto depth_at = [&](double t) {
    const Vec3 point = segment.from + t * (segment.to - segment.from);
    const double distance = surface.distance(point);
    return surface.inside(point).value_or(false) ? distance : -distance;
  };
  const double length = (segment.to - segment.from).norm();
  double best = std::max(depth_at(0.0), depth_at(1.0));
  // Along the segment the depth changes at most as fast as the place. So a part holds no point that
  // is deeper than its middle by more than half of its length.
  std::vector<std::array<double, 2>> parts{{0.0, 1.0}};
  while (!parts.empty()) {
    const auto [from, to] = parts.back();
    parts.pop_back();
    const double middle = 0.5 * (from + to), depth = depth_at(middle);
    best = std::max(best, depth);
    if (depth + 0.5 * (to - from) * length <= best + 0.01) continue;
    parts.push_back({from, middle});
    parts.push_back({middle, to});
  }
  return best;
}

/// Returns the cycles of a stroke in one mode, and the number of the worst cycle.
Json run_json(const std::string& mode, const std::vector<Cycle>& cycles,
              const Instrument& instrument) {
  Json places = Json::array(), begins = Json::array(), clearances = Json::array();
  const std::size_t bodies = instrument.bodies().size();
  const auto add = [bodies](Json& list, const std::array<Vec3, Cycle::most_bodies>& ends) {
    Json& at = list.emplace_back(Json::array());
    for (const Vec3& place : std::span(ends).first(bodies)) {
      at.push_back(json_of(Vec3((1e3 * place).array().round() / 1e3)));
    }
  };
  const bool has_begins = !are_in_a_row(instrument);
  for (const Cycle& cycle : cycles) {
    add(places, cycle.places);
    if (has_begins) add(begins, cycle.begins);
    Json& least = clearances.emplace_back(Json::array());
    for (const double mm : std::span(cycle.clearances).first(bodies)) {
      least.push_back(or_null(std::round(1e6 * mm) / 1e6));
    }
  }
  const auto worst = std::ranges::min_element(cycles, {}, &Cycle::least);
  Json run{{"mode", mode}, {"worst", worst - cycles.begin()}, {"places", std::move(places)}};
  if (has_begins) run["begins"] = std::move(begins);
  run["clearance_mm"] = std::move(clearances);
  return run;
}

class GuardedInstrument final : public SimulatedTool {
 public:
  explicit GuardedInstrument(const SimulateOptions& options)
      : options_(options),
        robot_(chosen_robot(options.robot, options.bodies)),
        margin_(options.constraint.options.margin),
        guides_(guides_of(options.guides, Guided::instrument)) {
    if (options.has_physics) measured_.emplace(options.robot, robot_.judged());
  }

  std::shared_ptr<const Mesh> open(const std::filesystem::path& path,
                                   const StopSignal& stop) override {
    const std::string name = path.stem().string();
    auto opened = unless_stopped(stop, [=, load = options_.load, index = options_.constraint.index,
                                        margin = margin_, robot = robot_] {
      const std::shared_ptr<const Mesh> mesh = load_named_mesh(path, load).mesh;
      require_area(path.string(), *mesh);
      return std::make_unique<RobotScene>(RobotScene{{name, mesh, index}, margin, robot});
    });
    if (!opened) return nullptr;
    on_ = *std::move(opened);
    const std::shared_ptr<const Mesh> mesh = on_->scene.mesh();
    Json& drawn = meshes_.emplace_back(drawn_mesh(name, *mesh));
    drawn["surface"] = on_->scene.has_sides() ? "closed" : "open";
    drawn["strokes"] = Json::array();
    told_.fill(-1.0);
    return mesh;
  }

  std::vector<std::string> guards() const override {
    return measured_ ? physical_mode_names : mode_names;
  }

  Stroke draw(std::uint64_t number, double speed) override {
    return instrument_stroke(*on_, options_.strokes, number, speed);
  }

  /// All modes use the same step with different meshes. It has no mesh if only the tip is guarded,
  /// or if there is no guard. Without a mesh it is damped least squares within the joint limits.
  StrokeStart start(const Stroke& stroke, std::size_t guard) override {
    const Mode mode = measured_ ? physical_modes[guard] : static_cast<Mode>(guard);
    is_measured_ = mode == Mode::measured;
    const Scene& scene = on_->scene;
    const Instrument instrument = on_->robot.make(stroke.start.base);
    InstrumentOptions step = options_of({.margin = margin_}, instrument.chain(), stroke.speed);
    if (measured_) step.period = cycle_seconds;  // the servos run in real time
    if (mode == Mode::linearized) step.certified = CertifiedMotion::linearized;
    joints_.emplace(instrument, std::make_unique<ActiveSet>(), step);
    if (mode != Mode::none) joints_->set_guides(guides_);
    tip_.reset();
    if (mode == Mode::tip_only) {  // a ball at the end of the jaw
      tip_ = make_motion_constraint(scene.mesh(), scene.shared_index(),
                                    {.options = {.radius = 10.0 * stroke.speed,
                                                 .tool_radius = instrument.bodies().back().radius,
                                                 .margin = margin_}});
      if (options_.constraint.monitor) {
        tip_->set_monitor(monitor::make_tip_monitor(scene.tree()));
      }
    } else if (mode != Mode::none) {
      add_mesh(*joints_);
    }
    speed_ = stroke.speed;
    q_ = stroke.start.positions;
    cycle_ = 0;
    if (is_measured_) {
      q_.assign(measured_->first().begin(), measured_->first().end());
    } else if (measured_) {
      InstrumentConstraint in_session(instrument, std::make_unique<ActiveSet>(), step);
      add_mesh(in_session);
      measured_->start(std::move(in_session), q_, stroke.speed * fastest_way / cycle_seconds);
    }
    judge_.emplace(oracle::JudgedScene{.robot = on_->robot.judged(),
                                       .base = stroke.start.base,
                                       .meshes = {{scene.tree()}},
                                       .guides = judged_guides(guides_)},
                   joints_->instrument().chain(), q_, step, joints_->tolerance());
    // All starts are farther away than the margin.
    return {.required = margin_ - step.band - 3.0 * joints_->tolerance()};
  }

  Cycle follow(const Pose& goal) override {
    if (is_measured_) {
      const auto positions = measured_->positions(cycle_);
      q_.assign(positions.begin(), positions.end());
      Cycle cycle = judged(Outcome::moved_freely);
      std::ranges::copy(measured_->errors(cycle_++), cycle.errors.begin());
      return cycle;
    }
    if (measured_) {
      const HapticCycle moved = measured_->follow(goal);
      q_.assign(measured_->setpoint().begin(), measured_->setpoint().end());
      return judged(outcome_of(moved.ok(), moved.step));
    }
    ChainState state;
    joints_->instrument().chain().forward_kinematics(q_, state);
    const Pose at = state.flange();
    const Eigen::AngleAxisd turn(Mat3(goal.rotation * at.rotation.transpose()));
    Twist asked{.linear = clipped(goal.position - at.position, speed_ * fastest_way),
                .angular = clipped(turn.angle() * turn.axis(), speed_ * fastest_turn)};
    if (tip_) asked.linear = tip_->step({.tip = at.position, .desired = asked.linear}).motion;
    const InstrumentStep step = joints_->step(q_, asked);
    for (std::size_t k = 0; step.ok() && k < q_.size(); ++k) q_[k] += step.increment[k];
    Cycle cycle = judged(outcome_of(step.ok(), step.status));
    cycle.guides_inside = guides_inside(step.guides);
    return cycle;
  }

  /// Judges the motion of the instrument to its positions.
  Cycle judged(Outcome outcome) {
    Cycle cycle;
    cycle.outcome = outcome;
    const oracle::RobotVerdict verdict = judge_->judge(q_);
    cycle.is_breach = verdict.limits_broken || verdict.is_undecided;
    cycle.is_guide_left = verdict.is_guide_left;
    for (std::size_t b = 0; b < robot_.bodies.size(); ++b) {
      const monitor::Segment axis = judge_->axis(b);
      cycle.begins[b] = axis.from;
      cycle.places[b] = axis.to;
      cycle.clearances[b] = std::min(judge_->least()[b], clearance_inside(b, axis));
    }
    return cycle;
  }

  /// Keeps one stroke of each manner: the one in which guarded bodies missed the margin most,
  /// summed over all modes.
  void keep(FollowedStroke followed) override {
    const Stroke& stroke = followed.stroke;
    const auto manner = static_cast<std::size_t>(stroke.manner);
    Json json{{"manner", manner_name(stroke.manner, is_robot_file(options_.robot))},
              {"speed", stroke.speed},
              {"number", stroke.number},
              {"port", json_of(stroke.start.base.position)},
              {"runs", Json::array()}};
    double told = 0.0;  // shortfall of all guarded modes [mm]
    const std::vector<std::string> modes = guards();
    for (std::size_t mode = 0; mode < modes.size(); ++mode) {
      const std::vector<Cycle>& cycles = followed.runs[mode];
      const double least = std::ranges::min_element(cycles, {}, &Cycle::least)->least();
      if (modes[mode] != "none") told += std::max(0.0, margin_ - least);
      json["runs"].push_back(run_json(modes[mode], cycles, joints_->instrument()));
    }
    if (told <= told_[manner]) return;
    told_[manner] = told;
    meshes_.back()["strokes"][manner] = std::move(json);
  }

  SimulationResult result(const std::vector<RunTally>& runs) override {
    std::size_t cycles = 0, broken = 0;  // of the certified mode
    bool has_moved = false;
    std::vector<std::string> still;  // runs in which the instrument did not move
    for (const RunTally& run : runs) {
      if (run.stood_still()) {
        still.push_back("'" + run.guard + "' on " + run.mesh + " at speed " + trimmed(run.speed));
      }
      if (run.guard != guards().front()) continue;
      cycles += run.cycles;
      has_moved |= !run.stood_still();
      broken += run.any.below + run.breaches + run.guides_left;
    }
    // The last mesh may have no finished stroke.
    if (meshes_.back()["strokes"].empty()) meshes_.erase(meshes_.size() - 1);
    const bool has_guides = !guides_.empty();
    const std::vector<std::string> untested = untested_guides(runs, options_.guides);
    const std::string in_guides = has_guides ? ", and in its guides" : "";
    const std::string all_bodies = is_robot_file(options_.robot)
                                       ? "all bodies (" + listed(names(robot_.bodies)) + ")"
                                       : "shaft, wrist and jaw";
    Columns<RunTally> columns = mode_columns(robot_.bodies, has_guides);
    if (measured_) {
      columns = tracking_columns(std::move(columns), robot_.bodies, joints_->options());
    }
    Json record = new_record(
        {.kind = "simulate_robot",
         .command = options_.command,
         .subject = "A simulated operator drove the instrument of a robot, " + options_.robot +
                    ", against anatomy: the same strokes in each mode",
         .headline =
             std::string("The certified step ") +
             (broken == 0 ? "kept " + all_bodies + " off the anatomy" + in_guides + " in all "
                          : "broke its promise in some of ") +
             counted(cycles, "cycle") + "." +
             (still.empty() ? ""
                            : " The instrument stood still in all cycles of " + listed(still) +
                                  ": nothing was tested there.") +
             (measured_ ? sentence_on_tracking(runs, joints_->options().band) : "") +
             sentence_on_untested(untested),
         .machine = this_machine(),
         .settings = {
             {"robot", options_.robot},
             {"strokes", grouped(options_.strokes.count)},
             {"cycles per stroke",
              options_.strokes.cycles == 0 ? "once in and back" : grouped(options_.strokes.cycles)},
             {"margin", trimmed(margin_) + " mm"},
             {"seed", std::to_string(options_.strokes.seed)},
             {"index", options_.constraint.index}}});
    if (options_.constraint.monitor) record["settings"]["monitor"] = "confirms each motion";
    if (has_guides) record["settings"]["guides"] = listed(options_.guides);
    if (!options_.bodies.empty()) record["settings"]["bodies"] = options_.bodies.string();
    if (!options_.notice.empty()) record["account"].push_back(options_.notice);
    record["certified_mm"] = margin_ - joints_->options().band;
    for (const Body& body : robot_.bodies) {
      record["bodies"].push_back({{"name", body.name}, {"radius_mm", body.radius}});
    }
    record["rows"] = json_of(columns, runs);
    record["meshes"] = std::move(meshes_);
    return {.record = std::move(record),
            .columns = columns,
            .legend = measured_ ? tracking_meaning : columns_meaning,
            .is_broken = broken > 0,
            .is_untested = !has_moved || (has_guides && untested.size() == guides_.size())};
  }

 private:
  void add_mesh(InstrumentConstraint& step) const {
    step.add_mesh(on_->scene.mesh(), on_->scene.shared_index());
    if (!options_.constraint.monitor) return;
    step.set_monitor(monitor::make_instrument_monitor(step.instrument(), {on_->scene.tree()}));
  }

  /// Returns the negative depth of a body whose axis is inside the surface, in part or as a whole.
  /// Infinite if the axis is outside, or the surface has no inside. [mm]
  double clearance_inside(std::size_t body, const monitor::Segment& axis) const {
    const double radius = joints_->instrument().bodies()[body].radius;
    const oracle::SafetyOracle& surface = on_->scene.oracle();
    const bool is_cut = judge_->least()[body] <= -radius;
    if (!is_cut && !surface.inside(axis.to).value_or(false)) return Cycle::far;
    const double depth = deepest(surface, axis);
    return depth < 0.0 ? Cycle::far : -(radius + depth);
  }

  const SimulateOptions& options_;
  RobotUnderTest robot_;
  double margin_;  // [mm]
  std::vector<Guide> guides_;
  std::unique_ptr<RobotScene> on_;
  Json meshes_ = Json::array();
  std::array<double, manners.size()> told_ = {};  // of the strokes of the last mesh [mm]
  std::optional<InstrumentConstraint> joints_;
  std::optional<MotionConstraint> tip_;         // guards the tip alone
  std::optional<MeasuredInstrument> measured_;  // with --physics
  bool is_measured_ = false;                    // the run follows the measured instrument
  std::size_t cycle_ = 0;                       // of that run
  std::optional<oracle::RobotJudge> judge_;
  std::vector<double> q_;  // joint positions
  double speed_ = 1.0;
};

}  // namespace

std::unique_ptr<SimulatedTool> make_guarded_instrument(const SimulateOptions& options) {
  return std::make_unique<GuardedInstrument>(options);
}

}  // namespace keepout::app
