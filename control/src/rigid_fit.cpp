// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/control/rigid_fit.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "keepout/error.h"
#include "keepout/option_table.h"

namespace keepout {
namespace {

// As fractions of the points' spread.
constexpr double narrowest = 1e-3;         // a tracker cannot measure a turn about a narrower set
constexpr double widest_residual = 0.1;    // the largest for fiducials in the right order
constexpr double largest_scale_off = 0.1;  // the largest for fiducials in the right unit

[[noreturn]] void refuse(const std::string& what) { throw Error(what); }

std::string numbered(const char* name, std::size_t i) {
  return std::string(name) + "[" + std::to_string(i) + "]";
}

void check_points(std::span<const Vec3> points, const char* name) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite() || points[i].cwiseAbs().maxCoeff() > longest_length) {
      refuse(numbered(name, i) + " has a coordinate that is not finite, or beyond 1e15");
    }
  }
}

/// Returns the weights, scaled to a mean of 1. Throws Error for a weight that is not above 0 and
/// finite.
std::vector<double> normalised(std::span<const double> weights, std::size_t count) {
  if (weights.empty()) return std::vector<double>(count, 1.0);
  if (weights.size() != count) {
    refuse(std::to_string(weights.size()) + " weights for " + std::to_string(count) +
           " pairs; give one for each, or none");
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!(weights[i] > 0.0 && std::isfinite(weights[i]))) {
      refuse(numbered("weights", i) + " must be above 0 and finite, not " + text_of(weights[i]) +
             "; leave out a pair that must not count");
    }
  }
  const double largest = std::ranges::max(weights);  // divides first, so that no sum overflows
  double sum = 0.0;
  for (const double w : weights) sum += w / largest;
  std::vector<double> relative;
  for (const double w : weights) relative.push_back(w / largest / sum * static_cast<double>(count));
  return relative;
}

/// Weighted points about their mean.
struct Cloud {
  Vec3 mean = Vec3::Zero();
  Mat3 scatter = Mat3::Zero();  // weighted mean of p p^T, p from the mean [length^2]

  /// Throws Error for points that coincide or lie on a line.
  Cloud(std::span<const Vec3> points, std::span<const double> weights, const char* whose) {
    const auto count = static_cast<double>(points.size());
    double farthest = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      mean += weights[i] / count * points[i];
      farthest = std::max(farthest, points[i].cwiseAbs().maxCoeff());
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 p = points[i] - mean;
      scatter += weights[i] / count * p * p.transpose();
    }
    const Vec3 squares = Eigen::SelfAdjointEigenSolver<Mat3>(scatter, Eigen::EigenvaluesOnly)
                             .eigenvalues();  // the smallest first
    const double long_way = std::sqrt(std::max(squares[2], 0.0));
    if (long_way <= 1e-12 * farthest) {
      refuse(std::string("the ") + whose + " points coincide; give points far apart");
    }
    if (std::sqrt(std::max(squares[1], 0.0)) <= narrowest * long_way) {
      refuse(std::string("the ") + whose +
             " points lie on a line, as they are weighted, and a turn about it changes nothing; "
             "add a point well off the line");
    }
  }
  double spread() const noexcept { return std::sqrt(scatter.trace()); }
};

std::string text_of(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

/// Returns the reason to doubt a fit, or an empty text. `mirrored_fre`: the FRE if a reflection
/// were allowed.
std::string doubt_of(const RigidFit& fit, double mirrored_fre, double spread) {
  if (std::abs(fit.scale - 1.0) > largest_scale_off) {
    return "the model's points are spread " + text_of(fit.scale) +
           " times as wide as the measured ones: are both in the unit of the mesh (1000 mm are a "
           "meter), and the pairs right?";
  }
  if (fit.fre <= widest_residual * spread) return {};
  if (mirrored_fre < 0.1 * fit.fre) {
    return "a reflection would fit far better: does an axis have the wrong sign? From LPS to RAS "
           "two axes change signs, not one";
  }
  return "the residuals are " + text_of(fit.fre / spread) +
         " of how wide the points are spread: are the pairs in the same order on both sides?";
}

}  // namespace

Eigen::Matrix4d RigidFit::matrix() const noexcept {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = mesh_from_robot.rotation;
  matrix.topRightCorner<3, 1>() = mesh_from_robot.position;
  return matrix;
}

double RigidFit::estimated_fle() const noexcept {
  const auto count = static_cast<double>(residuals.size());
  return fre * std::sqrt(count / (count - 2.0));
}

std::string RigidFit::doubt_of(double fle) const {
  if (!(fle > 0.0 && std::isfinite(fle))) {
    throw Error("doubt_of: fle must be above 0 and finite, not " + text_of(fle));
  }
  const auto count = static_cast<double>(residuals.size());
  const double freedom = 3.0 * count - 6.0;
  // The quantile of 99.9 % (Wilson, Hilferty 1931).
  const double part = 2.0 / (9.0 * freedom);
  const double quantile = freedom * std::pow(1.0 - part + 3.0902 * std::sqrt(part), 3);
  const double largest = fle * std::sqrt(quantile / (3.0 * count));
  if (fre <= largest) return {};
  return "the FRE is " + text_of(fre) + ", but with an FLE of " + text_of(fle) + " it is at most " +
         text_of(largest) + " in 999 of 1,000 registrations: is a pair wrong, or the FLE larger?";
}

RigidFit fit_rigid(std::span<const Vec3> measured, std::span<const Vec3> model,
                   std::span<const double> weights) {
  const std::size_t count = measured.size();
  if (model.size() != count) {
    refuse(std::to_string(count) + " measured points, but " + std::to_string(model.size()) +
           " of the model; each needs the other of its pair");
  }
  if (count < 3) {
    refuse(
        "a registration needs at least three pairs of points, not in a line, and five or more "
        "show how good it is; there are " +
        std::to_string(count));
  }
  check_points(measured, "measured");
  check_points(model, "model");
  const std::vector<double> w = normalised(weights, count);
  const Cloud from(measured, w, "measured");
  const Cloud to(model, w, "model's");

  Mat3 cross = Mat3::Zero();
  for (std::size_t i = 0; i < count; ++i) {
    cross += w[i] / static_cast<double>(count) * (model[i] - to.mean) *
             (measured[i] - from.mean).transpose();
  }
  const Eigen::JacobiSVD<Mat3> svd(cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Vec3 s = svd.singularValues();
  const double sign = svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0 ? -1.0 : 1.0;
  if (s[1] + sign * s[2] <= 1e-9 * from.spread() * to.spread()) {
    refuse("no rotation fits better than all others; are the pairs in the same order?");
  }

  RigidFit fit;
  Pose& pose = fit.mesh_from_robot;
  pose.rotation = svd.matrixU() * Vec3(1.0, 1.0, sign).asDiagonal() * svd.matrixV().transpose();
  pose.position = to.mean - pose.rotation * from.mean;
  fit.scale = to.spread() / from.spread();
  fit.center = to.mean;
  const Mat3 inertia = to.scatter.trace() * Mat3::Identity() - to.scatter;
  fit.looseness = inertia.inverse() / static_cast<double>(count);
  double mean_square = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    fit.residuals.push_back((pose * measured[i] - model[i]).norm());
    mean_square += w[i] / static_cast<double>(count) * fit.residuals[i] * fit.residuals[i];
  }
  fit.fre = std::sqrt(mean_square);
  const double gain = sign < 0.0 ? 4.0 * s[2] : 0.0;
  fit.doubt = doubt_of(fit, std::sqrt(std::max(mean_square - gain, 0.0)), to.spread());
  return fit;
}

}  // namespace keepout
