// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "answer_check.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <utility>

#include "nonnegative_least_squares.h"

namespace keepout::nlopt {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

class Check {
 public:
  Check(VectorXd u, const StepProblem& problem, const Task& task, const NearestPoint& posed,
        double accuracy)
      : problem_(problem),
        task_(task),
        posed_(posed),
        accuracy_(accuracy),
        u_(std::move(u)),
        moved_(VectorXd::Zero(u_.size())),
        norms_(problem.rows.rowwise().norm()) {}

  /// The rows that hold an exact answer are as near as rounding, those of a rough one farther; the
  /// fewer are asked, the less do rows interfere that are all but parallel.
  CheckedAnswer judge() {
    const VectorXd given = u_;
    CheckedAnswer answer;
    for (double near = 1e-14; near < 2 * accuracy_; near *= 100) {
      u_ = given;
      moved_.setZero();
      answer.finding = put_right(std::min(near, accuracy_));
      if (answer.finding == NloptFinding::optimal) return optimum();
    }
    return answer;
  }

 private:
  struct Violation {
    Index row = 0;
    double size = 0;  // in units of u
  };

  std::uint32_t row(Index i) const { return posed_.rows[static_cast<std::size_t>(i)]; }

  /// Of one of the posed rows, in task space; taken in u, where nothing has been lost yet.
  double slack(Index i) const {
    return (problem_.rows.row(row(i)).dot(u_) - problem_.bounds[row(i)]) / posed_.lengths[i];
  }

  /// Where u is in task space, and which weights on the rows near it balance the cost there.
  void measure(double near_share) {
    VectorXd descent(u_.size());
    task_.descent(u_, descent);
    from_target_.resize(u_.size());
    task_.row_to_task(descent.data(), from_target_);
    from_target_ = -from_target_;
    const auto n = static_cast<double>(u_.size());
    task_reach_ = std::max((task_.target().head(u_.size()) + from_target_).norm(),
                           task_.desired() / std::sqrt(n));
    reach_ = std::max(u_.norm(), task_.desired() / task_.size());

    std::vector<Index> near;
    for (Index i = 0; i < posed_.normals.rows(); ++i) {
      if (slack(i) <= near_share * task_reach_) near.push_back(i);
    }
    const MatrixXd normals = posed_.normals(near, Eigen::all).transpose();
    NonnegativeCombination push = nonnegative_least_squares(normals, from_target_);
    support_.clear();
    for (const Index c : push.columns) support_.push_back(near[static_cast<std::size_t>(c)]);
    weights_ = std::move(push.weights);
    unbalanced_ = std::move(push.residual);
  }

  CheckedAnswer optimum() const {
    CheckedAnswer answer{NloptFinding::optimal, u_, {}, {}};
    for (std::size_t i = 0; i < support_.size(); ++i) {
      answer.active.push_back(row(support_[i]));
      answer.multipliers.push_back(2 * weights_[static_cast<Index>(i)] /
                                   posed_.lengths[support_[i]]);
    }
    return answer;
  }

  /// Puts u on the rows that hold it and clear of the others, if it is not: NLopt stops short of
  /// them, or beyond, by its tolerance. Moves it by last digits only, or the proof fails.
  NloptFinding put_right(double near) {
    constexpr int most_passes = 4;
    for (int pass = 0; u_.allFinite(); ++pass) {
      measure(near);
      const bool feasible =
          satisfied(pass < most_passes ? active_set::feasibility : active_set::acceptable);
      if (feasible && proven()) return NloptFinding::optimal;
      if (pass == most_passes) {
        return feasible ? NloptFinding::not_optimal : NloptFinding::not_feasible;
      }
      touch_support();
      clear_rows();
    }
    return NloptFinding::not_finite;
  }

  bool satisfied(double tolerance) const { return worst_violation().size <= tolerance * reach_; }

  /// The shortest way, in task space, onto the rows that push.
  void touch_support() {
    if (support_.empty()) return;
    const auto count = static_cast<Index>(support_.size());
    const MatrixXd normals = posed_.normals(support_, Eigen::all).transpose();
    const Eigen::HouseholderQR<MatrixXd> qr(normals);
    VectorXd missing(count);
    for (Index i = 0; i < count; ++i) missing[i] = -slack(support_[static_cast<std::size_t>(i)]);
    const auto upper = qr.matrixQR().topRows(count).triangularView<Eigen::Upper>();
    VectorXd way = VectorXd::Zero(u_.size());
    way.head(count) = upper.transpose().solve(missing);
    way.applyOnTheLeft(qr.householderQ());
    move(way);
  }

  /// Projects u onto the row that it violates most, again and again.
  void clear_rows() {
    constexpr int most_projections = 32;
    for (int i = 0; i < most_projections; ++i) {
      const Violation worst = worst_violation();
      if (worst.size <= active_set::feasibility * reach_) return;
      VectorXd way(u_.size());
      task_.row_to_task(problem_.rows.row(worst.row).data(), way);
      move(way * (worst.size * norms_[worst.row] / way.squaredNorm()));
    }
  }

  void move(VectorXd way) {
    moved_ += way;
    task_.point_from_task(way);
    u_ += way;
  }

  /// Of all rows of the problem, those that NLopt was not shown as well.
  Violation worst_violation() const {
    Violation worst;
    for (Index i = 0; i < problem_.rows.rows(); ++i) {
      if (norms_[i] == 0) continue;
      const double size = (problem_.bounds[i] - problem_.rows.row(i).dot(u_)) / norms_[i];
      if (size > worst.size) worst = {i, size};
    }
    return worst;
  }

  bool proven() const {
    double square = unbalanced_.squaredNorm();
    for (std::size_t i = 0; i < support_.size(); ++i) {
      const double off = slack(support_[i]);
      square += 2 * weights_[static_cast<Index>(i)] * std::max(off, 0.0);
      // As KktResidual measures it, in units of u.
      if (!(std::abs(off) * posed_.lengths[support_[i]] <=
            accuracy_ * norms_[row(support_[i])] * reach_)) {
        return false;
      }
    }
    const double allowed = accuracy_ * task_reach_;
    return std::sqrt(square) <= allowed && moved_.norm() <= allowed;
  }

  const StepProblem& problem_;
  const Task& task_;
  const NearestPoint& posed_;
  double accuracy_;
  VectorXd u_;
  VectorXd moved_;              // by us, in task space
  VectorXd norms_;              // of all rows
  VectorXd from_target_;        // R u - c
  double task_reach_ = 0;       // |R u|, or what was asked for
  double reach_ = 0;            // the same in u
  std::vector<Index> support_;  // posed rows that push
  VectorXd weights_;
  VectorXd unbalanced_;
};

}  // namespace

CheckedAnswer check_answer(VectorXd u, const StepProblem& problem, const Task& task,
                           const NearestPoint& posed, double accuracy) {
  return Check(std::move(u), problem, task, posed, accuracy).judge();
}

}  // namespace keepout::nlopt
