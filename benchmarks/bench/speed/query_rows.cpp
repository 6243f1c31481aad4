// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "bench/speed/speed.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/fixtures/poses.h"
#include "keepout/geometry/closest_point.h"
#include "keepout/index/brute_force.h"
#include "shared/number_text.h"

namespace keepout::app {
namespace {

/// Returns the triangle's point nearest to p, by the regions of its plane.
///
/// Source: Ericson, "Real-Time Collision Detection", 2005, section 5.1.5.
Vec3 nearest_point(const Triangle& triangle, const Vec3& p) noexcept {
  const Vec3 &a = triangle[0], &b = triangle[1], &c = triangle[2];
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0.0 && d2 <= 0.0) return a;
  const Vec3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0.0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return a + d1 / (d1 - d3) * ab;
  const Vec3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0.0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  }
  const double share = 1.0 / (va + vb + vc);
  return a + vb * share * ab + vc * share * ac;
}

/// Returns true if a triangle touches a ball, as the engine's kernel decides.
bool kernel(const Triangle& triangle, const Ball& ball) noexcept {
  return closest_point(triangle, ball.center).distance <= ball.radius;
}

/// Like kernel(), but by the shortest code wherever its answer is sure. The kernel also classifies
/// features and controls rounding, at several times the cost.
bool lean_test(const Triangle& triangle, const Ball& ball) noexcept {
  const double squared = (nearest_point(triangle, ball.center) - ball.center).squaredNorm();
  const double limit = ball.radius * ball.radius;
  constexpr double doubt = 1e-6;  // of the limit: far above rounding, except for needles
  if (std::abs(squared - limit) > doubt * limit) return squared <= limit;
  return kernel(triangle, ball);  // NaN also gets here
}

/// Queries an index for the triangles within balls.
class Searcher {
 public:
  /// Both must outlive this.
  Searcher(const Mesh& mesh, const SpatialIndex& index)
      : mesh_(mesh), index_(index), candidates_(std::min(room, mesh.triangle_count())) {}

  void collect(const Ball& ball) noexcept {
    candidates_.clear();
    index_.collect(ball, candidates_);
  }

  /// Returns the candidates if the index is exact, otherwise those that pass the test.
  template <class Test>
  std::span<const TriangleId> answer(const Ball& ball, Test&& test) noexcept {
    collect(ball);
    if (index_.is_exact()) return candidates_.view();
    found_.clear();
    for (const TriangleId t : candidates_) {
      if (test(mesh_.triangle(t), ball)) found_.push(t);
    }
    return found_.view();
  }

  /// Like answer(), but sorted. Throws Error if the candidates exceed the capacity.
  template <class Test>
  std::vector<TriangleId> sorted_answer(const Ball& ball, Test&& test) {
    const std::span<const TriangleId> ids = answer(ball, test);
    if (candidates_.overflowed()) throw Error("a query found too many triangles");
    std::vector<TriangleId> sorted(ids.begin(), ids.end());
    std::sort(sorted.begin(), sorted.end());
    return sorted;
  }

 private:
  static constexpr std::size_t room = std::size_t{1} << 18;

  const Mesh& mesh_;
  const SpatialIndex& index_;
  TriangleBuffer candidates_;
  TriangleBuffer found_ = TriangleBuffer(candidates_.capacity());
};

/// Balls, and the answers of a correct index for comparison.
struct Question {
  double radius;
  std::vector<Ball> balls = {};
  std::vector<std::vector<TriangleId>> answers = {};
  double found_mean = 0.0;
};

/// Throws Error if the index disagrees with brute force at a sample of the places: a bug in
/// keepout.
Question question_of(const IndexedMesh& right, double radius, std::span<const Vec3> places) {
  Question question{.radius = radius};
  Searcher searcher(*right.mesh, *right.index);
  for (const Vec3& place : places) {
    question.balls.push_back({place, radius});
    question.answers.push_back(searcher.sorted_answer(question.balls.back(), kernel));
    question.found_mean +=
        static_cast<double>(question.answers.back().size()) / static_cast<double>(places.size());
  }
  constexpr std::size_t sample_count = 8;  // tens of milliseconds each
  const BruteForce brute_force(right.mesh);
  Searcher oracle(*right.mesh, brute_force);
  for (std::size_t i = 0; i < std::min(sample_count, places.size()); ++i) {
    if (oracle.sorted_answer(question.balls[i], kernel) != question.answers[i]) {
      throw Error("the index's triangles are not those of brute force: please report it");
    }
  }
  return question;
}

std::vector<Vec3> places_near(const Mesh& mesh, std::size_t count, Random random) {
  constexpr double farthest_off = 2.0;  // from the surface [mm]
  std::vector<Vec3> places = surface_points(mesh, count, 0.0, random);
  for (Vec3& place : places) place += random.uniform(0.0, farthest_off) * random.direction();
  return places;
}

/// Times one index, and adds the figures to the table of all indices. For an exact index the answer
/// is the candidates.
QueryFigures measure(SpeedRun& run, const std::string& name, const IndexedMesh& on,
                     const Question& question, int passes) {
  QueryFigures figures{.index = name, .radius = question.radius, .found_mean = question.found_mean};
  Searcher searcher(*on.mesh, *on.index);
  for (std::size_t i = 0; i < question.balls.size(); ++i) {
    for (const auto test : {kernel, lean_test}) {
      if (searcher.sorted_answer(question.balls[i], test) == question.answers[i]) continue;
      figures.answer.refusal = figures.lean_answer.refusal =
          "not timed: its triangles are not those of wide_bvh";
      run.wrong.push_back(name + ", sphere queries of " + trimmed(question.radius) + " mm");
      return figures;
    }
  }
  const auto time_each = [&](std::string side, auto&& ask) {
    return timed(std::move(side), question.balls.size(), passes,
                 [&](std::size_t i) { ask(question.balls[i]); });
  };
  figures.candidates = time_each(name, [&](const Ball& ball) { searcher.collect(ball); });
  figures.answer = figures.lean_answer = figures.candidates;
  if (!on.index->is_exact()) {
    figures.answer = time_each(name, [&](const Ball& ball) { searcher.answer(ball, kernel); });
    figures.lean_answer = time_each(name + ", lean exact test",
                                    [&](const Ball& ball) { searcher.answer(ball, lean_test); });
  }
  run.queries.push_back(figures);
  return figures;
}

}  // namespace

void hold_to_brute_force(const IndexedMesh& on, Random random) {
  question_of(on, 2.0, surface_points(*on.mesh, 8, 1.0, random));
}

void measure_sphere_queries(SpeedRun& run) {
  const IndexedMesh& on = run.bunny;
  constexpr std::array radii{5.0, 1.0};
  const int passes = run.effort.passes;
  const std::vector<Vec3> places = places_near(*on.mesh, run.effort.queries, run.random());
  std::vector<Question> questions;
  std::vector<QueryFigures> ours;
  for (const double radius : radii) {
    run.show("sphere queries, r = " + trimmed(radius) + " mm");
    questions.push_back(question_of(on, radius, places));
    ours.push_back(measure(run, "wide_bvh", on, questions.back(), passes));
  }
  for (const IndexBackend& backend : index_backends()) {
    if (backend.name == "brute_force" || backend.name == "wide_bvh") continue;
    const std::string name(backend.name);
    run.show("sphere queries, " + name);
    IndexedMesh other{on.mesh, nullptr};
    try {
      other.index = backend.make(on.mesh);
    } catch (const Error&) {
      continue;  // it cannot hold such a mesh
    }
    const auto rival = std::ranges::find(rivals, backend.name, &Rival::index);
    const bool is_rival = rival != rivals.end();
    for (std::size_t r = 0; r < radii.size(); ++r) {
      const QueryFigures theirs = measure(run, name, other, questions[r], is_rival ? passes : 1);
      if (!is_rival) continue;
      SpeedRow row = ratio("sphere query r = " + trimmed(radii[r]) + " mm, random",
                           std::string(rival->name) + " / wide_bvh",
                           at_least(radii[r] == 5.0 ? rival->query_at_5_mm : rival->query_at_1_mm),
                           theirs.lean_answer, ours[r].answer);
      if (theirs.answer.refusal.empty()) row.sides.push_back(theirs.answer);
      run.add(std::move(row));
    }
  }
}

}  // namespace keepout::app
