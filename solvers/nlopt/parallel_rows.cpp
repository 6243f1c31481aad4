// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "parallel_rows.h"

#include <algorithm>
#include <cmath>

namespace keepout::nlopt {
namespace {

/// Unit rows that differ by less are one: what one allows and the other does not is then less than
/// a row may be violated by.
constexpr double parallel = 1e-13;

struct Direction {
  double key;  // along a direction in which no two rows agree unless they mean to
  std::uint32_t row;
};

/// The rows of a problem made unit rows.
class UnitRows {
 public:
  explicit UnitRows(const StepProblem& problem) : problem_(problem), norms_(problem.rows.rows()) {
    for (Eigen::Index i = 0; i < norms_.size(); ++i) norms_[i] = problem.rows.row(i).norm();
  }

  /// Sorted by the key; rows of zeros left out.
  std::vector<Direction> directions() const {
    std::vector<Direction> sorted;
    for (Eigen::Index i = 0; i < norms_.size(); ++i) {
      if (norms_[i] == 0) continue;
      double key = 0;
      for (Eigen::Index j = 0; j < problem_.rows.cols(); ++j) {
        key += std::sin(1.0 + static_cast<double>(j * j)) * problem_.rows(i, j);
      }
      sorted.push_back({key / norms_[i], static_cast<std::uint32_t>(i)});
    }
    std::ranges::sort(sorted, [](const Direction& a, const Direction& b) {
      return a.key < b.key || (a.key == b.key && a.row < b.row);
    });
    return sorted;
  }

  bool agree(std::uint32_t a, std::uint32_t b) const {
    for (Eigen::Index j = 0; j < problem_.rows.cols(); ++j) {
      const double difference = problem_.rows(a, j) / norms_[a] - problem_.rows(b, j) / norms_[b];
      if (!(std::abs(difference) <= parallel)) return false;
    }
    return true;
  }

  bool tighter(std::uint32_t a, std::uint32_t b) const {
    const double of_a = problem_.bounds[a] / norms_[a];
    const double of_b = problem_.bounds[b] / norms_[b];
    return of_a > of_b || (of_a == of_b && a < b);
  }

 private:
  const StepProblem& problem_;
  Eigen::VectorXd norms_;
};

}  // namespace

std::vector<std::uint32_t> without_parallels(const StepProblem& problem) {
  const UnitRows rows(problem);
  std::vector<Direction> kept;  // with the key of the first of its bundle
  const double reach = parallel * static_cast<double>(problem.rows.cols());
  for (const Direction& next : rows.directions()) {
    const auto twin = std::find_if(kept.rbegin(), kept.rend(), [&](const Direction& other) {
      return !(other.key >= next.key - reach) || rows.agree(other.row, next.row);
    });
    if (twin == kept.rend() || !rows.agree(twin->row, next.row)) {
      kept.push_back(next);
    } else if (rows.tighter(next.row, twin->row)) {
      twin->row = next.row;
    }
  }
  std::vector<std::uint32_t> indices;
  indices.reserve(kept.size());
  for (const Direction& direction : kept) indices.push_back(direction.row);
  std::ranges::sort(indices);
  return indices;
}

}  // namespace keepout::nlopt
