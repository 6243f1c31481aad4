// SPDX-License-Identifier: BSD-3-Clause
//
// Sends random messages to sessions, good and bad, in any order, and checks what the robot gets.
#include <Eigen/Geometry>
#include <limits>
#include <map>
#include <vector>

#include "control/guarded_shapes.h"
#include "guards.h"
#include "keepout/control/crtk_session.h"
#include "keepout/oracle/instrument_oracle.h"
#include "trials.h"

namespace keepout::test::hostile_session {
namespace {

constexpr double period = 0.001;
constexpr double most_newtons = 3.0;

Registration registration() {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topRightCorner<3, 1>() = Vec3(4, -5, 6);
  return Registration::mesh_from_robot(matrix, {.transform = LengthUnit::millimetre,
                                                .robot = LengthUnit::metre,
                                                .mesh = LengthUnit::millimetre});
}

CrtkOptions options() {
  return {.haptic = {.period = period, .spring = {.largest_force = most_newtons}},
          .motion_scale = 0.5,
          .farthest_lag = 40.0,
          .frame = "base"};
}

double hostile_number(Random& random) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  constexpr std::array numbers{test::nan, infinity, -infinity, 1e308, -1e300, 1e-320, 0.0, 5.0};
  return numbers[random.below(numbers.size())];
}

/// A loop with a robot, an operator and a network that all fail at random.
class HostileLoop {
 public:
  HostileLoop(CrtkSession session, const Pose& start, std::vector<double> joints,
              std::uint64_t seed)
      : session_(std::move(session)), start_(start), joints_(std::move(joints)), random_(seed) {}

  /// Sends some messages, and ticks. `judge`: returns the clearance of what the robot gets.
  template <class Judge>
  void run(int cycles, const Judge& judge) {
    for (int i = 0; i < cycles; ++i) {
      const std::optional<Pose> before = session_.setpoint_cp();
      const std::vector<double> joints_before = joints_now();
      const int messages = static_cast<int>(random_.below(4));
      for (int k = 0; k < messages; ++k) send();
      now_ += period;
      const CycleStatus status = session_.tick(now_);
      ++seen[status];
      limited += status == CycleStatus::guarded && session_.cycle().step == Status::limited ? 1 : 0;
      ASSERT_EQ(status, session_.cycle().status);
      ASSERT_FALSE(session_.reason().empty());
      ASSERT_TRUE(session_.servo_cf().force.allFinite());
      ASSERT_LE(session_.servo_cf().force.norm(), 0.5 * most_newtons * (1.0 + 1e-12));
      if (!session_.engaged()) {
        ASSERT_EQ(session_.servo_cf().force, Vec3::Zero());
        ASSERT_TRUE(session_.setpoint_jp().empty());
        continue;
      }
      ASSERT_TRUE(is_valid(*session_.setpoint_cp())) << i;
      if (before && status != CycleStatus::guarded && !has_engaged_) {
        ASSERT_EQ(session_.setpoint_cp()->position, before->position) << name(status);
        ASSERT_EQ(session_.setpoint_cp()->rotation, before->rotation);
        ASSERT_EQ(joints_now(), joints_before);
      }
      has_engaged_ = false;
      ASSERT_TRUE(judge(session_)) << i << ": " << name(status);
    }
  }

  std::map<CycleStatus, int> seen;  // how often
  int limited = 0;                  // cycles at the surface

 private:
  std::vector<double> joints_now() const {
    const auto sent = session_.setpoint_jp();
    return {sent.begin(), sent.end()};
  }

  bool happens(double probability) { return random_.uniform(0.0, 1.0) < probability; }

  /// Returns a stamp, mostly the next tick's.
  MessageHeader header() {
    MessageHeader header{now_ + period, "base"};
    if (happens(0.01)) header.stamp = hostile_number(random_);
    if (happens(0.01)) header.stamp -= 0.03;
    if (happens(0.01)) header.frame = "camera";
    if (happens(0.2)) header.frame = "";
    return header;
  }

  /// Returns a pose within 15 mm of where the robot started, mostly the last one, or nonsense.
  Pose pose() {
    if (happens(0.02)) {
      goal_.position = start_.position + 0.015 * random_.uniform(0.0, 1.0) * random_.direction();
      goal_.rotation =
          Eigen::AngleAxisd(random_.uniform(0.0, 0.5), random_.direction()) * start_.rotation;
    }
    Pose pose = goal_;
    if (happens(0.005)) pose.position[random_.below(3)] = hostile_number(random_);
    if (happens(0.005)) pose.rotation(1, 2) = hostile_number(random_);
    if (happens(0.002)) pose.rotation = -pose.rotation;
    return pose;
  }

  std::vector<double> joints(double spread) {
    std::vector<double> q = joints_;
    for (std::size_t k = 0; k < q.size(); ++k) {
      q[k] += spread * (k == 2 ? 0.05 : 1.0) * random_.uniform(-1.0, 1.0);
    }
    if (q.empty() || happens(0.005)) q.resize(random_.below(9));
    if (!q.empty() && happens(0.005)) q[random_.below(q.size())] = hostile_number(random_);
    return q;
  }

  void send() {
    switch (random_.below(24)) {
      case 0:
        if (happens(0.02)) session_.on_operating_state(OperatingState::fault, true);
        return;
      case 1:
        session_.on_operating_state(OperatingState::enabled, !happens(0.01));
        return;
      case 2:
        if (happens(0.02)) session_.on_contest(true);
        return;
      case 3:
        session_.on_contest(false);
        return;
      case 4:
        if (happens(0.02)) session_.release();
        return;
      case 5:
      case 6:
        if (session_.engaged() && !happens(0.02)) return;
        // The robot itself is clear when it is engaged.
        session_.on_setpoint_cp({start_.position, start_.rotation}, header());
        session_.on_setpoint_js(joints_, header());
        session_.engage(happens(0.01) ? hostile_number(random_) : now_);
        has_engaged_ = true;
        return;
      case 7:
        if (happens(0.02)) session_.refuse(CycleStatus::invalid_pose);
        return;
      case 8:
        if (!joints_.empty() || happens(0.05)) session_.on_servo_jp(joints(0.3), header());
        return;
      case 9:
        if (!joints_.empty() || happens(0.05)) session_.on_servo_jv(joints(2.0), header());
        return;
      case 10:
        if (happens(0.02)) session_.set_registration(registration());
        return;
      case 11:
        session_.on_measured_cp(pose(), header());
        session_.on_measured_js(joints(0.1), header());
        return;
      default:
        if (session_.engaged()) {
          session_.on_measured_cp(*session_.setpoint_cp(), {now_ + period});
          if (!joints_.empty()) session_.on_measured_js(session_.setpoint_jp(), {now_ + period});
        }
        session_.on_servo_cp(pose(), header());
        return;
    }
  }

  CrtkSession session_;
  Pose start_;
  Pose goal_ = start_;
  std::vector<double> joints_;
  Random random_;
  double now_ = 1.0;  // [s]
  bool has_engaged_ = false;
};

/// Fails unless the loop was at the surface often, and has seen each outcome that messages cause.
void expect_every_outcome(HostileLoop& loop) {
  EXPECT_GT(loop.limited, 200);
  for (const auto status :
       {CycleStatus::guarded, CycleStatus::not_engaged, CycleStatus::stale,
        CycleStatus::invalid_pose, CycleStatus::not_ready, CycleStatus::unmeasured,
        CycleStatus::other_frame, CycleStatus::contested, CycleStatus::wrong_command}) {
    EXPECT_GT(loop.seen[status], 0) << name(status);
  }
}

TEST(HostileSession, OfATipKeepsItOutWhateverArrives) {
  HostileLoop loop(CrtkSession(guard_of(cube()), registration(), options()),
                   {registration().point_to_robot({3, 4, top + 5.0}), Mat3::Identity()}, {}, 1);
  loop.run(test::trials(20'000), [](const CrtkSession& session) {
    const Vec3 tip = registration().point_to_mesh(session.setpoint_cp()->position);
    // The cube is [-50, 50]^3.
    const double distance = (tip.cwiseAbs().array() - top).max(0.0).matrix().norm();
    return distance >= kept - 1e-9;
  });
  expect_every_outcome(loop);
}

TEST(HostileSession, OfAnInstrumentKeepsEveryBodyOutWhateverArrives) {
  const auto mesh = mesh_of(make_cube(20.0));
  const Instrument instrument = psm(port_over(Vec3::Zero(), 120.0));
  const std::vector<double> start{0, 0, 0.05, 0, 0, 0};  // [m] in joint 3
  const Pose flange =
      test::state_of(instrument.chain(), std::vector<double>{0, 0, 50, 0, 0, 0}).flange();
  const Pose base = instrument.chain().base();
  oracle::InstrumentOracle judge(
      std::make_shared<monitor::TriangleTree>(mesh), monitor::judged_psm(),
      {registration().point_to_mesh(0.001 * base.position), base.rotation});
  HostileLoop loop(
      CrtkSession(guard_of(mesh, instrument, {.period = period}), registration(), options()),
      {0.001 * flange.position, flange.rotation}, start, 2);
  loop.run(test::trials(10'000), [&](const CrtkSession& session) {
    std::vector<double> q(session.setpoint_jp().begin(), session.setpoint_jp().end());
    q[2] *= 1000.0;
    judge.move_to(q);
    return judge.clearance(1e3) >= 0.198 - 1e-8;
  });
  expect_every_outcome(loop);
}

}  // namespace
}  // namespace keepout::test::hostile_session
