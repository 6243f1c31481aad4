// SPDX-License-Identifier: BSD-3-Clause
//
// Compares forward kinematics and Jacobians with those of KDL and of MuJoCo, which share no code
// with keepout.

#include <cstddef>
#include <cstdio>
#include <memory>
#include <numbers>

#include "chains.h"
#include "keepout/fixtures/robots.h"
#ifdef KEEPOUT_HAS_KDL
#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacsolver.hpp>
#endif
#ifdef KEEPOUT_HAS_MUJOCO
#include <mujoco/mujoco.h>
#endif

namespace keepout {
namespace {

constexpr double allowed = 1e-12;                  // [m], or without unit
const int configurations = test::trials(500'000);  // of each robot
constexpr double millimetre = 1e-3;

/// Returns joint positions with lengths in meters.
std::vector<double> in_metres(const Chain& chain, std::vector<double> q) {
  for (int k = 1; k <= chain.size(); ++k) {
    if (chain.joint(k).kind == JointKind::prismatic)
      q[static_cast<std::size_t>(k - 1)] *= millimetre;
  }
  return q;
}

/// The largest differences that were found.
struct Differences {
  double place = 0.0;     // [m]
  double rotation = 0.0;  // of any entry
  double jacobian = 0.0;  // of any entry, [m/rad] or without unit

  static void raise(double& largest, double found) {
    // A comparison with NaN is false, so NaN is recorded.
    if (!(found <= largest)) largest = found;
  }
  void judge(const std::string& what) const {
    std::printf("%s: largest difference of a place %.3g m, rotation %.3g, Jacobian %.3g, of %d\n",
                what.c_str(), place, rotation, jacobian, configurations);
    EXPECT_LE(place, allowed);
    EXPECT_LE(rotation, allowed);
    EXPECT_LE(jacobian, allowed);
    EXPECT_GT(place + rotation, 0.0) << "they do not reckon alike to the last bit";
  }
};

using Column = Eigen::Matrix<double, 6, 1>;

/// Returns column k of the Jacobian of the flange, in meters.
Column column(const ChainState& state, int k) {
  Column column;
  const double unit = state.turns(k) ? millimetre : 1.0;
  column << unit * state.linear(k, state.size(), state.flange().position),
      state.angular(k, state.size());
  return column;
}

#ifdef KEEPOUT_HAS_KDL
/// A DH row after Craig: alpha and theta in right angles, lengths in meters.
struct Row {
  double a, alpha, d, theta;
  KDL::Joint::JointType type = KDL::Joint::RotZ;
};

constexpr Row psm_table[] = {
    {0, 1, 0, 1},     {0, -1, 0, -1}, {0, 1, -.4318, 0, KDL::Joint::TransZ},
    {0, 0, .4162, 0}, {0, -1, 0, -1}, {.0091, -1, 0, -1}};
constexpr Row arm_table[] = {{0, 0, .34, 0}, {0, -1, 0, 0}, {0, 1, .4, 0},  {0, 1, 0, 0},
                             {0, -1, .4, 0}, {0, -1, 0, 0}, {0, 1, .126, 0}};

KDL::Chain kdl_chain(std::span<const Row> table, const KDL::Frame& tip) {
  constexpr double right = std::numbers::pi / 2.0;
  KDL::Chain chain;
  chain.addSegment(
      KDL::Segment{KDL::Joint(KDL::Joint::None),
                   KDL::Frame::DH_Craig1989(table[0].a, right * table[0].alpha, 0, 0)});
  for (std::size_t i = 0; i < table.size(); ++i) {
    const KDL::Frame next =
        i + 1 == table.size()
            ? tip
            : KDL::Frame::DH_Craig1989(table[i + 1].a, right * table[i + 1].alpha, 0, 0);
    chain.addSegment(
        KDL::Segment{KDL::Joint(table[i].type),
                     KDL::Frame::DH_Craig1989(0, 0, table[i].d, right * table[i].theta) * next});
  }
  return chain;
}

void compare_with_kdl(const Chain& ours, const KDL::Chain& theirs, const std::string& name) {
  KDL::ChainFkSolverPos_recursive forward(theirs);
  KDL::ChainJntToJacSolver jacobian(theirs);
  KDL::JntArray positions(theirs.getNrOfJoints());
  KDL::Jacobian columns(theirs.getNrOfJoints());
  Random random(21);
  Differences found;
  ChainState state;
  for (int i = 0; i < configurations; ++i) {
    const std::vector<double> q = test::configuration(ours, random);
    ours.forward_kinematics(q, state);
    const std::vector<double> metres = in_metres(ours, q);
    std::copy(metres.begin(), metres.end(), positions.data.data());
    KDL::Frame frame;
    ASSERT_EQ(forward.JntToCart(positions, frame), 0);
    ASSERT_EQ(jacobian.JntToJac(positions, columns), 0);
    const Pose flange = state.flange();
    const Vec3 place(frame.p.x(), frame.p.y(), frame.p.z());
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> rotation(frame.M.data);
    Differences::raise(found.place, (millimetre * flange.position - place).norm());
    Differences::raise(found.rotation, (flange.rotation - rotation).cwiseAbs().maxCoeff());
    for (int k = 1; k <= ours.size(); ++k) {
      const Column difference = column(state, k) - columns.data.col(k - 1);
      Differences::raise(found.jacobian, difference.cwiseAbs().maxCoeff());
    }
  }
  found.judge(name + "_against_kdl");
}
#endif

TEST(KinematicsPeers, TheFlangeIsWhereKdlSaysAndMovesSo) {
#ifdef KEEPOUT_HAS_KDL
  const KDL::Frame jaws(KDL::Rotation(0, -1, 0, 0, 0, 1, -1, 0, 0), KDL::Vector(0, .0102, 0));
  const KDL::Frame cutter(KDL::Vector(0, 0, .308));
  compare_with_kdl(psm().chain(), kdl_chain(psm_table, jaws), "psm");
  compare_with_kdl(seven_joint_arm().chain(), kdl_chain(arm_table, cutter), "seven_joint_arm");
#else
  GTEST_SKIP() << "liborocos-kdl-dev was not there";
#endif
}

#ifdef KEEPOUT_HAS_MUJOCO
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Compares the poses of all links, and the Jacobian of the flange. MuJoCo merges the flange into
/// the last link.
void compare_with_mujoco(const Chain& ours, const std::string& name, const char* format = ".urdf") {
  char message[1000] = "";
  const std::string file = std::string(KEEPOUT_ROBOTS) + "/" + name + format;
  const std::unique_ptr<mjModel, decltype(&mj_deleteModel)> model(
      mj_loadXML(file.c_str(), nullptr, message, sizeof message), mj_deleteModel);
  ASSERT_NE(model, nullptr) << message;
  const std::unique_ptr<mjData, decltype(&mj_deleteData)> data(mj_makeData(model.get()),
                                                               mj_deleteData);
  const int n = ours.size();
  ASSERT_EQ(model->nv, n);
  ASSERT_EQ(model->nbody, n + 1) << "the world, and one for each joint";
  Random random(22);
  Differences found;
  ChainState state;
  RowMajor linear(3, n);
  RowMajor angular(3, n);
  for (int i = 0; i < configurations; ++i) {
    const std::vector<double> q = test::configuration(ours, random);
    ours.forward_kinematics(q, state);
    const std::vector<double> metres = in_metres(ours, q);
    std::copy(metres.begin(), metres.end(), data->qpos);
    mj_kinematics(model.get(), data.get());
    mj_comPos(model.get(), data.get());
    for (int k = 1; k <= n; ++k) {
      const Pose link = state.link(k);
      const Eigen::Map<const Vec3> place(data->xpos + std::ptrdiff_t{3} * k);
      const Eigen::Map<const RowMajor> rotation(data->xmat + std::ptrdiff_t{9} * k, 3, 3);
      Differences::raise(found.place, (millimetre * link.position - place).norm());
      Differences::raise(found.rotation, (link.rotation - rotation).cwiseAbs().maxCoeff());
    }
    const Vec3 flange = millimetre * state.flange().position;
    mj_jac(model.get(), data.get(), linear.data(), angular.data(), flange.data(), n);
    for (int k = 1; k <= n; ++k) {
      Column theirs;
      theirs << linear.col(k - 1), angular.col(k - 1);
      Differences::raise(found.jacobian, (column(state, k) - theirs).cwiseAbs().maxCoeff());
    }
  }
  found.judge(name + "_against_mujoco");
}
#endif

TEST(KinematicsPeers, EachLinkIsWhereMuJoCoPutsThatOfTheUrdfAndMovesSo) {
#ifdef KEEPOUT_HAS_MUJOCO
  compare_with_mujoco(psm().chain(), "psm");
  compare_with_mujoco(psm().chain(), "psm_dynamics", ".xml");  // of --physics
  compare_with_mujoco(seven_joint_arm().chain(), "seven_joint_arm");
#else
  GTEST_SKIP() << "libmujoco-dev was not there";
#endif
}

}  // namespace
}  // namespace keepout
