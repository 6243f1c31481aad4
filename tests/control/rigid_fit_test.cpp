// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/control/rigid_fit.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cstdio>
#include <numeric>

#include "keepout/control/registration.h"
#include "keepout/control/target_error.h"
#include "meshes.h"
#include "messages.h"
#include "trials.h"

namespace keepout::test::rigid_fit {
namespace {

using Points = std::vector<Vec3>;

// Points on a head, in millimeters: five that are not in a plane, and four that are.
const Points on_a_head{{0, 95, 20}, {70, 40, 35}, {-72, 38, 30}, {60, -60, 80}, {-10, -20, 130}};
const Points in_a_plane{{0, 0, 50}, {90, 0, 50}, {80, 70, 50}, {-10, 60, 50}};

Pose some_pose(Random& random) {
  return {400.0 * random.direction(),
          Eigen::AngleAxisd(3.0 * normal(random), random.direction()).toRotationMatrix()};
}

Vec3 noise(Random& random, double deviation) {
  const double x = normal(random), y = normal(random), z = normal(random);
  return deviation * Vec3(x, y, z);
}

/// Returns the measurements of a robot: the points of a model that is at the inverse of the pose.
Points seen_from(const Pose& pose, const Points& model) {
  Points measured;
  for (const Vec3& p : model) measured.push_back(pose.rotation.transpose() * (p - pose.position));
  return measured;
}

double sum_of_squares(const Pose& pose, const Points& measured, const Points& model,
                      const std::vector<double>& weights) {
  double sum = 0.0;
  for (std::size_t i = 0; i < model.size(); ++i) {
    sum += weights[i] * (pose * measured[i] - model[i]).squaredNorm();
  }
  return sum;
}

TEST(RigidFit, FindsTheTruePoseToRounding) {
  Random random(1);
  for (const Points& model :
       {on_a_head, in_a_plane, Points(on_a_head.begin() + 1, on_a_head.end() - 1)}) {
    for (int i = 0; i < test::trials(300); ++i) {
      const Pose truth = some_pose(random);
      const RigidFit fit = fit_rigid(seen_from(truth, model), model);
      EXPECT_LT((fit.mesh_from_robot.rotation - truth.rotation).norm(), 1e-12);
      EXPECT_LT((fit.mesh_from_robot.position - truth.position).norm(), 1e-12 * 500.0);
      EXPECT_NEAR(fit.mesh_from_robot.rotation.determinant(), 1.0, 1e-12);
      EXPECT_LT(fit.fre, 1e-12 * 500.0);
      EXPECT_NEAR(fit.scale, 1.0, 1e-12);
      EXPECT_EQ(fit.doubt, "");
      const auto registration =
          Registration::mesh_from_robot(fit.matrix(), {.transform = LengthUnit::millimetre,
                                                       .robot = LengthUnit::metre,
                                                       .mesh = LengthUnit::millimetre});
      const Vec3 point(10, 20, 30);
      EXPECT_LT((registration.point_to_mesh(0.001 * point) - truth * point).norm(), 1e-12 * 500.0);
    }
  }
}

TEST(RigidFit, NoOtherPoseHasASmallerWeightedSumOfSquares) {
  Random random(3);
  for (const Points& model : {on_a_head, in_a_plane}) {
    for (int i = 0; i < test::trials(100); ++i) {
      Points measured = seen_from(some_pose(random), model);
      for (Vec3& p : measured) p += noise(random, 2.0);
      std::vector<double> weights(model.size());
      for (double& w : weights) w = random.uniform(0.1, 5.0);
      const RigidFit fit = fit_rigid(measured, model, weights);
      const Pose& best = fit.mesh_from_robot;
      const double least = sum_of_squares(best, measured, model, weights);
      for (int k = 0; k < 20; ++k) {
        const Mat3 turn = Eigen::AngleAxisd(1e-3, random.direction()).toRotationMatrix();
        const Pose other{best.position + 0.1 * random.direction(), turn * best.rotation};
        EXPECT_GT(sum_of_squares(other, measured, model, weights), least);
      }
      const double all = std::accumulate(weights.begin(), weights.end(), 0.0);
      EXPECT_NEAR(fit.fre, std::sqrt(least / all), 1e-12 * 100.0);
    }
  }
}

TEST(RigidFit, OnlyTheRatiosOfWeightsCountAndWholeOnesAreRepeatedPairs) {
  Random random(4);
  Points measured = seen_from(some_pose(random), on_a_head);
  for (Vec3& p : measured) p += noise(random, 2.0);
  const RigidFit thrice = fit_rigid(measured, on_a_head, std::vector<double>{1, 3, 1, 1, 1});
  const RigidFit same =
      fit_rigid(measured, on_a_head, std::vector{1e300, 3e300, 1e300, 1e300, 1e300});
  EXPECT_LT((thrice.matrix() - same.matrix()).norm(), 1e-10);
  Points model = on_a_head;
  for (int k = 0; k < 2; ++k) {
    measured.push_back(measured[1]);
    model.push_back(model[1]);
  }
  const RigidFit repeated = fit_rigid(measured, model);
  EXPECT_LT((thrice.matrix() - repeated.matrix()).norm(), 1e-10);
  EXPECT_NEAR(thrice.fre, repeated.fre, 1e-12);
}

TEST(RigidFit, AMirroredModelIsFittedByARotationAndDoubted) {
  Points mirrored = on_a_head;
  for (Vec3& p : mirrored) p.x() = -p.x();
  const RigidFit fit = fit_rigid(mirrored, on_a_head);
  EXPECT_NEAR(fit.mesh_from_robot.rotation.determinant(), 1.0, 1e-12);
  EXPECT_CONTAINS(fit.doubt, "reflection");
  Points flat = in_a_plane;  // half a turn maps them onto the model
  for (Vec3& p : flat) p.x() = -p.x();
  EXPECT_LT(fit_rigid(flat, in_a_plane).fre, 1e-12);
}

TEST(RigidFit, AnErrorThatIsTooSmallForTheResidualsIsDoubted) {
  Random random(3);
  int doubted = 0;
  for (int i = 0; i < 2000; ++i) {
    Points measured, model;
    for (int k = 0; k < 8; ++k) {
      measured.push_back(50.0 * random.direction());
      model.push_back(measured.back() + noise(random, 0.3 / std::sqrt(3.0)));
    }
    RigidFit fit = fit_rigid(measured, model);
    doubted += fit.doubt_of(0.3).empty() ? 0 : 1;
    model[2].x() += 4.0;
    fit = fit_rigid(measured, model);
    EXPECT_EQ(fit.doubt, "");
    EXPECT_CONTAINS(fit.doubt_of(0.3), "in 999 of 1,000 registrations");
  }
  EXPECT_LE(doubted, 10);  // 2 are expected
}

TEST(RigidFit, AWrongUnitAndAWrongOrderAreDoubtedAndNotRefused) {
  Points in_metres = on_a_head;
  for (Vec3& p : in_metres) p *= 0.001;
  const RigidFit metres = fit_rigid(in_metres, on_a_head);
  EXPECT_NEAR(metres.scale, 1000.0, 1e-9);
  EXPECT_CONTAINS(metres.doubt, "1e+03 times as wide");
  Points swapped = on_a_head;
  std::swap(swapped[0], swapped[3]);
  const RigidFit order = fit_rigid(swapped, on_a_head);
  EXPECT_CONTAINS(order.doubt, "same order");
  EXPECT_GT(order.fre, 10.0);
}

void expect_refused(const auto& work, const std::string& words) {
  EXPECT_CONTAINS(error_of(work), words);
}

void expect_refused(const Points& measured, const Points& model, const std::vector<double>& weights,
                    const std::string& words) {
  expect_refused([&] { fit_rigid(measured, model, weights); }, words);
}

TEST(RigidFit, SaysWhatIsWrongWithItsPoints) {
  const Points& good = on_a_head;
  const Points two(good.begin(), good.begin() + 2);
  expect_refused(two, two, {}, "needs at least three pairs of points");
  expect_refused({}, {}, {}, "there are 0");
  expect_refused(good, two, {}, "5 measured points, but 2 of the model");
  expect_refused(good, good, {1, 1}, "2 weights for 5 pairs");
  for (const double bad : {0.0, -1.0, std::nan(""), test::infinity}) {
    expect_refused(good, good, {1, 1, bad, 1, 1}, "weights[2] must be above 0 and finite");
  }
  Points broken = good;
  broken[3].y() = std::nan("");
  expect_refused(broken, good, {}, "measured[3] has a coordinate that is not finite");
  expect_refused(good, broken, {}, "model[3] has a coordinate");
  broken[3].y() = 1e200;
  expect_refused(good, broken, {}, "or beyond 1e15");
  const Points same(5, Vec3(100, 200, 300.1));
  expect_refused(same, good, {}, "the measured points coincide");
  expect_refused(good, same, {}, "the model's points coincide");
  const Points line{{1, 2, 3}, {11, 22, 33.02}, {21, 42, 63}, {31, 62, 93}, {41, 82, 123}};
  expect_refused(line, good, {}, "the measured points lie on a line");
  expect_refused(good, line, {}, "the model's points lie on a line");
  const Points triangle(good.begin(), good.begin() + 3);
  expect_refused(triangle, triangle, {1, 1, 1e-9}, "lie on a line, as they are weighted");
  const Points undecided{{1, 0, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 1, 0}};
  const Points around{{1, 0, 0}, {-1, 0, 0}, {0, 0, 1}, {0, 0, 1}};
  expect_refused(undecided, around, {}, "no rotation fits better");
}

TEST(TargetError, SaysWhatIsWrongWithItsArguments) {
  const RigidFit fit = fit_rigid(on_a_head, on_a_head);
  const double nan = std::nan("");
  const Points one{{0, 0, 0}};
  expect_refused([&] { target_error(fit, {0, nan, 0}); }, "target is not finite");
  for (const double bad : {0.0, -1.0, nan}) {
    expect_refused([&] { target_error(fit, {0, 0, 0}, bad); }, "fle must be above 0");
  }
  expect_refused([&] { registration_margin(fit, {}); }, "no targets");
  for (const double bad : {0.0, 1.0, nan}) {
    expect_refused([&] { registration_margin(fit, one, bad); }, "confidence must be above 0");
  }
}

TEST(TargetError, IsTheOneOfFitzpatrickWestAndMaurer) {
  const RigidFit fit = fit_rigid(on_a_head, on_a_head);
  const auto count = static_cast<double>(on_a_head.size());
  Mat3 scatter = Mat3::Zero();
  for (const Vec3& p : on_a_head) scatter += (p - fit.center) * (p - fit.center).transpose();
  const Mat3 axes = Eigen::SelfAdjointEigenSolver<Mat3>(scatter).eigenvectors();
  for (const Vec3& target : {Vec3(0, 0, 0), Vec3(30, -80, 12), Vec3(200, 10, -90)}) {
    double sum = 0.0;
    for (int k = 0; k < 3; ++k) {
      double f2 = 0.0;
      for (const Vec3& p : on_a_head) {
        f2 += (p - fit.center).cross(axes.col(k)).squaredNorm() / count;
      }
      sum += (target - fit.center).cross(axes.col(k)).squaredNorm() / f2;
    }
    EXPECT_NEAR(target_error(fit, target, 0.7).rms(), 0.7 * std::sqrt((1 + sum / 3) / count),
                1e-12);
  }
}

TEST(TargetError, TheMarginsQuantilesAreThoseOfTheTables) {
  // At the center all standard deviations are FLE / sqrt(3 N).
  RigidFit fit = fit_rigid(on_a_head, on_a_head);
  const Points at_center{fit.center};
  const Points twice{fit.center, fit.center};
  const double deviation = 1.0 / std::sqrt(15.0);
  const auto margin = [&](const Points& targets, double confidence) {
    return registration_margin(fit, targets, confidence, 1.0) / deviation;
  };
  EXPECT_NEAR(margin(at_center, 0.99), std::sqrt(11.3449), 1e-5);  // chi^2 of 3
  EXPECT_NEAR(margin(at_center, 0.5), std::sqrt(2.36597), 1e-5);
  EXPECT_NEAR(margin(twice, 0.99), std::sqrt(16.8119), 1e-5);  // chi^2 of 6
  fit.fre = std::sqrt(3.0 / 5.0);                              // the estimated FLE is 1
  EXPECT_NEAR(registration_margin(fit, at_center) / deviation, std::sqrt(3 * 6.99192), 1e-4);
  EXPECT_NEAR(registration_margin(fit, twice) / deviation, std::sqrt(6 * 5.80177), 1e-4);
  fit.residuals.resize(3);  // as of three pairs
  fit.fre = std::sqrt(1.0 / 3.0);
  EXPECT_NEAR(registration_margin(fit, at_center) * 3.0, std::sqrt(3 * 29.4567), 1e-3);
}

/// One place, or several at once: the predicted margins, and the results of many registrations.
struct Judged {
  Points places;
  double known;      // margin for 0.99 with the true FLE [mm]
  double estimated;  // margin with an estimated FLE, for an FRE of 1; proportional to the FRE
  Mat3 covariance = Mat3::Zero();  // of the true errors, at a single place
  int held_known = 0, held_estimated = 0;

  Judged(const RigidFit& unit, const Points& at, double fle)
      : places(at),
        known(registration_margin(unit, at, 0.99, fle)),
        estimated(registration_margin(unit, at)) {}
};

void expect_as_predicted(const char* name, const Points& model, const std::vector<double>& weights,
                         double fle) {
  const Points targets{fit_rigid(model, model, weights).center, {20, -30, 20}, {120, -90, -40}};
  RigidFit unit = fit_rigid(model, model, weights);
  unit.fre = 1.0;
  std::vector<Judged> judged;
  for (const Vec3& target : targets) judged.emplace_back(unit, Points{target}, fle);
  judged.emplace_back(unit, targets, fle);
  const auto pairs = static_cast<double>(model.size());
  const double mean_weight = std::accumulate(weights.begin(), weights.end(), 0.0) / pairs;
  const int count = test::trials(10'000);
  double mean_squared_fre = 0.0;
  Random random(7);
  for (int draw = 0; draw < count; ++draw) {
    const Pose truth = some_pose(random);
    Points measured = seen_from(truth, model);
    for (std::size_t i = 0; i < measured.size(); ++i) {
      measured[i] += noise(random, fle * std::sqrt(mean_weight / weights[i] / 3.0));
    }
    const RigidFit fit = fit_rigid(measured, model, weights);
    mean_squared_fre += fit.fre * fit.fre / count;
    for (Judged& j : judged) {
      Points places = j.places;
      const double share = random.uniform();
      places.push_back(share * places.front() + (1.0 - share) * places.back());
      double farthest = 0.0;
      for (const Vec3& place : places) {
        const Vec3 error = fit.mesh_from_robot * seen_from(truth, {place}).front() - place;
        farthest = std::max(farthest, error.norm());
        if (&place == &places.front()) j.covariance += error * error.transpose() / count;
      }
      j.held_known += farthest <= j.known ? 1 : 0;
      j.held_estimated += farthest <= fit.fre * j.estimated ? 1 : 0;
    }
  }
  const double within = 5.0 * std::sqrt(2.0 / count);  // five deviations of a mean of squares
  EXPECT_NEAR(mean_squared_fre / (fle * fle * (1.0 - 2.0 / pairs)), 1.0, within);
  std::printf("%s: %d pairs, FLE %g mm, %d draws\n", name, static_cast<int>(pairs), fle, count);
  for (const Judged& j : judged) {
    const bool is_one = j.places.size() == 1;
    const TargetError predicted = target_error(unit, j.places.front(), fle);
    const double off = (j.covariance - predicted.covariance).norm() / predicted.covariance.norm();
    const double rms = std::sqrt(j.covariance.trace());
    EXPECT_NEAR(predicted.rms() / rms, 1.0, 0.03);
    EXPECT_LT(off, 2.0 * within);
    // At the center the errors are isotropic, and the margin is tight.
    const bool is_tight = is_one && j.places.front() == unit.center;
    const double least = count * 0.99 - (is_tight ? 4.0 * std::sqrt(count * 0.0099) : 0.0);
    EXPECT_GE(j.held_known, least);
    EXPECT_GE(j.held_estimated, least);
    std::printf(
        "  %s%.0f mm off: TRE %.4f mm, true %.4f; covariance %.1f %% off; margin %.3f mm, "
        "held in %.4f, with estimated FLE in %.4f\n",
        is_one ? "" : "all, the first ", (j.places.front() - unit.center).norm(), predicted.rms(),
        rms, 100.0 * off, j.known, 1.0 * j.held_known / count, 1.0 * j.held_estimated / count);
  }
}

TEST(TargetError, IsThatOfManyDraws) {
  const Points three(on_a_head.begin(), on_a_head.begin() + 3);
  expect_as_predicted("head", on_a_head, std::vector(5, 1.0), 0.5);
  expect_as_predicted("plane", in_a_plane, std::vector(4, 1.0), 0.5);
  expect_as_predicted("three", three, std::vector(3, 1.0), 0.5);
  expect_as_predicted("weights", on_a_head, {1, 4, 0.25, 2, 9}, 0.5);
}

}  // namespace
}  // namespace keepout::test::rigid_fit
