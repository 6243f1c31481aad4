// SPDX-License-Identifier: BSD-3-Clause
#include "point_method.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace keepout::active_set {
namespace {

// Up to this number, planes are scanned as they are, without listing their coordinates.
constexpr std::size_t most_scanned = 16;

// A row at a smaller angle to the span of the active rows does not enter.
constexpr double least_angle = 1e-7;

// Error of an active row, relative to its norm and the reach. It is far below a violation.
constexpr double exact_enough = 32 * epsilon;

constexpr int most_iterations = 60;

constexpr double unbounded = std::numeric_limits<double>::infinity();

double square(double x) noexcept { return x * x; }

Violated most_violated(std::span<const HalfSpace> planes, const Vec3& u) noexcept {
  Violated worst;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const double by = missing(planes[i].normal.data(), planes[i].offset, u.data());
    const bool more = by > worst.by;  // chosen without a branch, because it is hard to predict
    worst.row = more ? static_cast<int>(i) : worst.row;
    worst.by = more ? by : worst.by;
  }
  return worst;
}

bool in_range(const Vec3& desired) noexcept {
  return std::abs(desired[0]) <= largest && std::abs(desired[1]) <= largest &&
         std::abs(desired[2]) <= largest;
}

bool are_units_in_range(std::span<const HalfSpace> planes) noexcept {
  bool usable = true;
  for (const HalfSpace& plane : planes) usable &= is_unit_in_range(plane);
  return usable;
}

}  // namespace

bool PointMethod::solve(const StepProblem& problem) noexcept {
  desired_ = Eigen::Map<const Vec3>(problem.desired.data());
  iterations_ = 0;
  active_ = 0;
  if (!in_range(desired_)) return false;
  const bool planes_only = static_cast<std::size_t>(problem.rows.rows()) == problem.planes.size();
  if (planes_only && problem.planes.size() <= most_scanned) {
    const auto scan = [&](const Vec3& u) { return most_violated(problem.planes, u); };
    return are_units_in_range(problem.planes) && run(problem, scan);
  }
  const auto scan = [&](const Vec3& u) { return unit_.most_violated(u.data()); };
  return list_rows(problem) && run(problem, scan);
}

/// Lists all rows as unit planes. Unit rows are not scaled, so that they are chosen like planes.
bool PointMethod::list_rows(const StepProblem& problem) noexcept {
  bool usable = unit_.assign(problem.planes);
  for (Eigen::Index i = static_cast<Eigen::Index>(problem.planes.size()); i < problem.rows.rows();
       ++i) {
    const double* row = problem.rows.data() + 3 * i;
    const double bound = problem.bounds[i];
    const double norm2 = dot(row, row);
    if (is_unit(norm2)) {
      unit_.push(row, bound);
    } else {
      const double scale = 1.0 / std::sqrt(norm2);
      const double scaled[3] = {scale * row[0], scale * row[1], scale * row[2]};
      unit_.push(scaled, scale * bound);
      usable &= norm2 >= square(smallest) && norm2 <= square(largest);
    }
    usable &= std::abs(bound) <= largest;
  }
  unit_.close();
  return usable;
}

template <class Scan>
bool PointMethod::run(const StepProblem& problem, const Scan& scan) noexcept {
  u_ = desired_;
  asked2_ = dot(desired_, desired_);
  while (iterations_ < most_iterations) {
    const Violated worst = scan(u_);
    const double reach2 = std::max(asked2_, dot(u_, u_));
    if (!(worst.by > 0 && square(worst.by) > square(feasibility) * reach2)) return true;
    take_in(problem, worst.row);
    if (!enter()) return false;
  }
  return false;
}

/// Writes a row to the place of the entering row.
void PointMethod::take_in(const StepProblem& problem, int row) noexcept {
  ActiveRow& active = active_rows_[at(active_)];
  if (at(row) < problem.planes.size()) {
    active.normal = problem.planes[at(row)].normal;
    active.bound = problem.planes[at(row)].offset;
  } else {
    active.normal = Eigen::Map<const Vec3>(problem.rows.data() + 3 * std::ptrdiff_t{row});
    active.bound = problem.bounds[row];
  }
  active.square = dot(active.normal, active.normal);
  active.mu = 0;
  active.row = row;
}

/// Raises the multiplier of a violated row until the row is satisfied. Drops active rows whose
/// multiplier reaches zero meanwhile.
bool PointMethod::enter() noexcept {
  for (;;) {
    ActiveRow& entering = active_rows_[at(active_)];
    const double violation =
        std::max(missing(entering.normal.data(), entering.bound, u_.data()), 0.0);
    const Split parts = split();
    // With three active rows rest2 is 0: they span the space, so one of them must go.
    const double full = parts.rest2 > 0 ? violation / parts.rest2 : unbounded;
    double partial = unbounded;
    int blocking = no_row;
    for (int i = 0; i < active_; ++i) {
      const ActiveRow& active = active_rows_[at(i)];
      const double weight = parts.weight[at(i)];
      const bool counts = square(weight) * active.square > square(dependence) * entering.square;
      if (!(weight > 0 && counts && active.mu < partial * weight)) continue;
      partial = active.mu / weight;
      blocking = i;
    }
    const double t = std::min(full, partial);
    if (!(t < unbounded) || ++iterations_ > most_iterations) return false;
    const bool holds = full <= partial;
    if (holds && !(parts.rest2 > square(least_angle) * entering.square)) return false;
    for (int i = 0; i < active_; ++i) {
      double& mu = active_rows_[at(i)].mu;
      mu = std::max(mu - t * parts.weight[at(i)], 0.0);
    }
    entering.mu += t;
    if (holds) {
      ++active_;
      return settle();
    }
    drop(blocking);
    update_u(active_ + 1);
  }
}

PointMethod::Split PointMethod::split() const noexcept {
  const Vec3& w = active_rows_[at(active_)].normal;
  const Vec3& a = active_rows_[0].normal;
  const Vec3& b = active_rows_[1].normal;
  const Vec3& c = active_rows_[2].normal;
  Split parts;
  switch (active_) {
    case 0:
      parts.rest2 = active_rows_[0].square;
      break;
    case 1: {
      parts.weight[0] = dot(a, w) / active_rows_[0].square;
      const Vec3 rest = w - parts.weight[0] * a;
      parts.rest2 = dot(rest, rest);
      break;
    }
    case 2: {
      const Vec3 edge = a.cross(b);
      const double scale = 1.0 / dot(edge, edge);
      parts.weight[0] = scale * dot(w.cross(b), edge);
      parts.weight[1] = scale * dot(a.cross(w), edge);
      parts.rest2 = scale * square(dot(edge, w));
      break;
    }
    default: {
      const Vec3 bc = b.cross(c);
      const double scale = 1.0 / dot(a, bc);
      parts.weight[0] = scale * dot(w, bc);
      parts.weight[1] = scale * dot(w, c.cross(a));
      parts.weight[2] = scale * dot(w, a.cross(b));
      break;
    }
  }
  return parts;
}

/// Corrects the multipliers until the active rows hold with equality, up to rounding.
bool PointMethod::settle() noexcept {
  for (int pass = 0; pass < 4; ++pass) {
    update_u(active_);
    const double reach2 = std::max(asked2_, dot(u_, u_));
    std::array<double, 3> slack{};
    bool exact = true;
    for (int i = 0; i < active_; ++i) {
      const ActiveRow& active = active_rows_[at(i)];
      slack[at(i)] = missing(active.normal.data(), active.bound, u_.data());
      exact &= square(slack[at(i)]) <= square(exact_enough) * active.square * reach2;
    }
    if (exact) return true;
    correct(slack);
  }
  return false;
}

/// Changes the multipliers so that u moves by the slacks, one for each active row.
void PointMethod::correct(const std::array<double, 3>& slack) noexcept {
  const Vec3& a = active_rows_[0].normal;
  const Vec3& b = active_rows_[1].normal;
  const Vec3& c = active_rows_[2].normal;
  std::array<double, 3> more{};
  switch (active_) {
    case 1:
      more[0] = slack[0] / active_rows_[0].square;
      break;
    case 2: {
      const double slope = dot(a, b) / active_rows_[0].square;
      const Vec3 rest = b - slope * a;
      more[1] = (slack[1] - slope * slack[0]) / dot(rest, rest);
      more[0] = slack[0] / active_rows_[0].square - slope * more[1];
      break;
    }
    default: {
      const Vec3 bc = b.cross(c), ca = c.cross(a), ab = a.cross(b);
      const double scale = 1.0 / dot(a, bc);
      const Vec3 way = scale * (slack[0] * bc + slack[1] * ca + slack[2] * ab);
      more = {scale * dot(bc, way), scale * dot(ca, way), scale * dot(ab, way)};
      break;
    }
  }
  for (int i = 0; i < active_; ++i) {
    active_rows_[at(i)].mu = std::max(active_rows_[at(i)].mu + more[at(i)], 0.0);
  }
}

/// Computes u = d + sum mu_i a_i.
void PointMethod::update_u(int rows) noexcept {
  u_ = desired_;
  for (int i = 0; i < rows; ++i) u_ += active_rows_[at(i)].mu * active_rows_[at(i)].normal;
}

/// Drops an active row. The rows after it move up, and so does the entering row.
void PointMethod::drop(int position) noexcept {
  for (int i = position; i < active_; ++i) active_rows_[at(i)] = active_rows_[at(i + 1)];
  --active_;
}

}  // namespace keepout::active_set
