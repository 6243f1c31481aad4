// SPDX-License-Identifier: BSD-3-Clause
#include "point_method.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace keepout::active_set {
namespace {

// So few planes are looked through as they lie in memory.
constexpr std::size_t few = 16;

// A step into what is left of a row that makes a smaller angle with the active ones is not tried.
constexpr double slim = 1e-7;

// Of an active row, relative to its norm and the reach. Far below what counts as violated.
constexpr double exact_enough = 32 * epsilon;

constexpr int most_iterations = 60;

constexpr double unbounded = std::numeric_limits<double>::infinity();

Vec3 cross(const Vec3& a, const Vec3& b) noexcept {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double square(double x) noexcept { return x * x; }

/// Planes as they are given.
struct GivenPlanes {
  std::span<const HalfSpace> planes;

  Violated most_violated(const Vec3& u) const noexcept {
    Violated worst;
    for (std::size_t i = 0; i < planes.size(); ++i) {
      const double by = missing(planes[i].normal.data(), planes[i].offset, u.data());
      const bool more = by > worst.by;  // chosen without a branch, which would be a guess
      worst.plane = more ? static_cast<int>(i) : worst.plane;
      worst.by = more ? by : worst.by;
    }
    return worst;
  }
};

struct ListedPlanes {
  const UnitPlanes& planes;

  Violated most_violated(const Vec3& u) const noexcept { return planes.most_violated(u.data()); }
};

bool in_range(const Vec3& desired) noexcept {
  return std::abs(desired[0]) <= largest && std::abs(desired[1]) <= largest &&
         std::abs(desired[2]) <= largest;
}

bool is_usual(const HalfSpace& plane) noexcept {
  return is_unit(dot(plane.normal, plane.normal)) && std::abs(plane.offset) <= largest;
}

bool are_usual(std::span<const HalfSpace> planes) noexcept {
  bool usual = true;
  for (const HalfSpace& plane : planes) usual &= is_usual(plane);
  return usual;
}

}  // namespace

bool PointMethod::solve(const StepProblem& problem) noexcept {
  desired_ = Eigen::Map<const Vec3>(problem.desired.data());
  iterations_ = 0;
  active_ = 0;
  if (!in_range(desired_)) return false;
  const bool planes_only = static_cast<std::size_t>(problem.rows.rows()) == problem.planes.size();
  if (planes_only && problem.planes.size() <= few) {
    return are_usual(problem.planes) && run(problem, GivenPlanes{problem.planes});
  }
  return list_rows(problem) && run(problem, ListedPlanes{unit_});
}

/// Lists all rows as unit planes. Rows that are unit vectors are not scaled, so that they are
/// chosen as planes are.
bool PointMethod::list_rows(const StepProblem& problem) noexcept {
  unit_.clear();
  bool usual = true;
  for (const HalfSpace& plane : problem.planes) {
    usual &= is_usual(plane);
    unit_.push(plane.normal.data(), plane.offset);
  }
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
      usual &= norm2 >= square(smallest) && norm2 <= square(largest);
    }
    usual &= std::abs(bound) <= largest;
  }
  unit_.close();
  return usual;
}

template <class Scan>
bool PointMethod::run(const StepProblem& problem, const Scan& scan) noexcept {
  u_ = desired_;
  asked_ = dot(desired_, desired_);
  while (iterations_ < most_iterations) {
    const Violated worst = scan.most_violated(u_);
    const double reach2 = std::max(asked_, dot(u_, u_));
    if (!(worst.by > 0 && square(worst.by) > square(feasibility) * reach2)) return true;
    take_in(problem, worst.plane);
    if (!enter()) return false;
  }
  return false;
}

/// Puts a row in the place of the one that is to enter.
void PointMethod::take_in(const StepProblem& problem, int row) noexcept {
  Face& face = face_[at(active_)];
  if (at(row) < problem.planes.size()) {
    face.normal = problem.planes[at(row)].normal;
    face.bound = problem.planes[at(row)].offset;
  } else {
    face.normal = Eigen::Map<const Vec3>(problem.rows.data() + 3 * std::ptrdiff_t{row});
    face.bound = problem.bounds[row];
  }
  face.square = dot(face.normal, face.normal);
  face.mu = 0;
  face.row = row;
}

/// Raises the multiplier of a violated row until the row holds, letting go of active rows whose
/// multiplier reaches zero on the way.
bool PointMethod::enter() noexcept {
  for (;;) {
    Face& entering = face_[at(active_)];
    const double violation =
        std::max(missing(entering.normal.data(), entering.bound, u_.data()), 0.0);
    const Split parts = split();
    const double full = parts.rest > 0 ? violation / parts.rest : unbounded;
    double partial = unbounded;
    int blocking = Violated::none;
    for (int i = 0; i < active_; ++i) {
      const Face& face = face_[at(i)];
      const double weight = parts.weight[at(i)];
      const bool counts = square(weight) * face.square > square(dependence) * entering.square;
      if (!(weight > 0 && counts && face.mu < partial * weight)) continue;
      partial = face.mu / weight;
      blocking = i;
    }
    const double t = std::min(full, partial);
    if (!(t < unbounded) || ++iterations_ > most_iterations) return false;
    const bool holds = full <= partial;
    if (holds && !(parts.rest > square(slim) * entering.square)) return false;
    for (int i = 0; i < active_; ++i) {
      double& mu = face_[at(i)].mu;
      mu = std::max(mu - t * parts.weight[at(i)], 0.0);
    }
    entering.mu += t;
    if (holds) {
      ++active_;
      return settle();
    }
    drop(blocking);
    place(active_ + 1);
  }
}

PointMethod::Split PointMethod::split() const noexcept {
  const Vec3& w = face_[at(active_)].normal;
  const Vec3& a = face_[0].normal;
  const Vec3& b = face_[1].normal;
  const Vec3& c = face_[2].normal;
  Split parts;
  switch (active_) {
    case 0:
      parts.rest = face_[0].square;
      break;
    case 1: {
      parts.weight[0] = dot(a, w) / face_[0].square;
      const Vec3 rest = w - parts.weight[0] * a;
      parts.rest = dot(rest, rest);
      break;
    }
    case 2: {
      const Vec3 edge = cross(a, b);
      const double scale = 1.0 / dot(edge, edge);
      parts.weight[0] = scale * dot(cross(w, b), edge);
      parts.weight[1] = scale * dot(cross(a, w), edge);
      parts.rest = scale * square(dot(edge, w));
      break;
    }
    default: {
      const Vec3 bc = cross(b, c);
      const double scale = 1.0 / dot(a, bc);
      parts.weight[0] = scale * dot(w, bc);
      parts.weight[1] = scale * dot(w, cross(c, a));
      parts.weight[2] = scale * dot(w, cross(a, b));
      break;
    }
  }
  return parts;
}

/// Corrects the multipliers until the active rows hold with equality, to rounding.
bool PointMethod::settle() noexcept {
  for (int pass = 0; pass < 4; ++pass) {
    place(active_);
    const double reach2 = std::max(asked_, dot(u_, u_));
    std::array<double, 3> slack{};
    bool exact = true;
    for (int i = 0; i < active_; ++i) {
      const Face& face = face_[at(i)];
      slack[at(i)] = missing(face.normal.data(), face.bound, u_.data());
      exact &= square(slack[at(i)]) <= square(exact_enough) * face.square * reach2;
    }
    if (exact) return true;
    correct(slack);
  }
  return false;
}

/// Adds to the multipliers what moves u by the slacks, one for each active row.
void PointMethod::correct(const std::array<double, 3>& slack) noexcept {
  const Vec3& a = face_[0].normal;
  const Vec3& b = face_[1].normal;
  const Vec3& c = face_[2].normal;
  std::array<double, 3> more{};
  switch (active_) {
    case 1:
      more[0] = slack[0] / face_[0].square;
      break;
    case 2: {
      const double slope = dot(a, b) / face_[0].square;
      const Vec3 rest = b - slope * a;
      more[1] = (slack[1] - slope * slack[0]) / dot(rest, rest);
      more[0] = slack[0] / face_[0].square - slope * more[1];
      break;
    }
    default: {
      const Vec3 bc = cross(b, c), ca = cross(c, a), ab = cross(a, b);
      const double scale = 1.0 / dot(a, bc);
      const Vec3 way = scale * (slack[0] * bc + slack[1] * ca + slack[2] * ab);
      more = {scale * dot(bc, way), scale * dot(ca, way), scale * dot(ab, way)};
      break;
    }
  }
  for (int i = 0; i < active_; ++i) {
    face_[at(i)].mu = std::max(face_[at(i)].mu + more[at(i)], 0.0);
  }
}

/// u = d + sum mu_i a_i
void PointMethod::place(int faces) noexcept {
  u_ = desired_;
  for (int i = 0; i < faces; ++i) u_ += face_[at(i)].mu * face_[at(i)].normal;
}

/// Lets an active row go; the one that is to enter moves up with the others.
void PointMethod::drop(int position) noexcept {
  for (int i = position; i < active_; ++i) face_[at(i)] = face_[at(i + 1)];
  --active_;
}

}  // namespace keepout::active_set
