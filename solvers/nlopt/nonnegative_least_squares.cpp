// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "nonnegative_least_squares.h"

#include <Eigen/QR>
#include <algorithm>
#include <limits>

namespace keepout::nlopt {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// The passive columns, whose weights are free to be above zero, and their weights.
class PassiveSet {
 public:
  PassiveSet(const MatrixXd& columns, const VectorXd& target)
      : columns_(columns), target_(target), barred_(static_cast<std::size_t>(columns.cols())) {}

  /// Step 4: the column that reduces the residual most; -1 when none does by more than rounding.
  Index steepest(const VectorXd& residual) const {
    Index best = -1;
    double most = 4 * epsilon * target_.norm();
    for (Index c = 0; c < columns_.cols(); ++c) {
      if (barred_[static_cast<std::size_t>(c)] || contains(c)) continue;
      const double gain = columns_.col(c).dot(residual);
      if (gain > most) {
        most = gain;
        best = c;
      }
    }
    return best;
  }

  /// Steps 5 to 11: takes a column in, and lets those go whose weight would fall below zero on the
  /// way to the least squares. If that is the new one, or it depends on the others, rounding alone
  /// chose it, and it stays out.
  void take_in(Index column) {
    columns_in_.push_back(column);
    weights_.conservativeResize(weights_.size() + 1);
    weights_[weights_.size() - 1] = 0;
    for (;;) {
      const VectorXd free = least_squares();
      if (!free.allFinite() || (weights_[weights_.size() - 1] == 0 && !(free.tail(1)[0] > 0))) {
        drop(weights_.size() - 1);
        barred_[static_cast<std::size_t>(column)] = true;
        return;
      }
      if (free.minCoeff() > 0) {
        weights_ = free;
        barred_.assign(barred_.size(), false);
        return;
      }
      double share = 1;
      Index blocking = 0;
      for (Index i = 0; i < free.size(); ++i) {
        if (free[i] > 0) continue;
        const double until_zero = weights_[i] / (weights_[i] - free[i]);
        if (until_zero < share) {
          share = until_zero;
          blocking = i;
        }
      }
      weights_ += share * (free - weights_);
      weights_[blocking] = 0;
      for (Index i = weights_.size() - 1; i >= 0; --i) {
        if (!(weights_[i] > 0)) drop(i);
      }
      if (columns_in_.empty()) return;
    }
  }

  /// Nothing is left of the target.
  bool full() const { return weights_.size() == columns_.rows(); }

  VectorXd residual() const {
    VectorXd rest = target_;
    for (Index i = 0; i < weights_.size(); ++i) rest -= weights_[i] * columns_.col(at(i));
    return rest;
  }

  NonnegativeCombination combination() const {
    std::vector<Index> order(columns_in_);
    std::ranges::sort(order);
    VectorXd weights(weights_.size());
    for (Index i = 0; i < weights_.size(); ++i) {
      const auto place = std::ranges::lower_bound(order, at(i)) - order.begin();
      weights[place] = weights_[i];
    }
    return {std::move(order), std::move(weights), residual()};
  }

 private:
  Index at(Index i) const { return columns_in_[static_cast<std::size_t>(i)]; }
  bool contains(Index column) const {
    return std::ranges::find(columns_in_, column) != columns_in_.end();
  }

  void drop(Index i) {
    columns_in_.erase(columns_in_.begin() + i);
    const Index after = weights_.size() - i - 1;
    weights_.segment(i, after) = weights_.tail(after).eval();
    weights_.conservativeResize(weights_.size() - 1);
  }

  VectorXd least_squares() const {
    MatrixXd passive(columns_.rows(), weights_.size());
    for (Index i = 0; i < weights_.size(); ++i) passive.col(i) = columns_.col(at(i));
    return Eigen::HouseholderQR<MatrixXd>(passive).solve(target_);
  }

  const MatrixXd& columns_;
  const VectorXd& target_;
  std::vector<bool> barred_;  // rounding objects to them
  std::vector<Index> columns_in_;
  VectorXd weights_;
};

}  // namespace

NonnegativeCombination nonnegative_least_squares(const MatrixXd& columns, const VectorXd& target) {
  PassiveSet passive(columns, target);
  // Without rounding no set of columns comes twice; with it, a limit.
  const Index most_rounds = 20 * (columns.rows() + 5);
  for (Index round = 0; round < most_rounds && !passive.full(); ++round) {
    const Index column = passive.steepest(passive.residual());
    if (column < 0) break;
    passive.take_in(column);
  }
  return passive.combination();
}

}  // namespace keepout::nlopt
