// SPDX-License-Identifier: BSD-3-Clause
// A step that stands still although a motion could be proved costs no safety, but it is of no use.
// Beside each blocked cycle on hostile meshes, a random search looks for a motion.

#include <cstdint>
#include <functional>

#include "chains.h"
#include "keepout/index/wide_bvh.h"
#include "keepout/robot/instrument_constraint.h"
#include "keepout/solvers/active_set.h"
#include "meshes.h"

namespace keepout {
namespace {

constexpr double mesh_size = 20.0;      // of a mesh, from its middle [mm]
constexpr double step_length = 0.5;     // asked of the flange in a cycle [mm]
constexpr double blocked_below = 0.05;  // of what is asked
constexpr double movable_above = 0.1;   // of what is asked
constexpr int search_trials = 300;

Surface soup(Random& random) {
  Surface surface;
  for (std::size_t t = 0, count = 20 + random.below(380); t < count; ++t) {
    const Vec3 place = mesh_size * std::cbrt(random.uniform()) * random.direction();
    const double edge = std::pow(10.0, random.uniform(-0.5, 1.0));
    const auto first = static_cast<VertexId>(surface.vertices.size());
    for (int i = 0; i < 3; ++i) surface.vertices.push_back(place + edge * random.direction());
    surface.triangles.push_back({first, first + 1, first + 2});
  }
  return surface;
}

/// Appends a height over a disk: rings of triangles around a vertex.
void add_disk(Surface& surface, std::size_t rings, std::size_t columns,
              const std::function<double(double, double)>& height) {
  const auto first = static_cast<VertexId>(surface.vertices.size());
  surface.vertices.emplace_back(0.0, 0.0, height(0.0, 0.0));
  for (std::size_t i = 0; i < rings * columns; ++i) {
    const double out =
        mesh_size * static_cast<double>(1 + i / columns) / static_cast<double>(rings);
    const double angle =
        2.0 * std::numbers::pi * static_cast<double>(i % columns) / static_cast<double>(columns);
    const double x = out * std::cos(angle);
    const double y = out * std::sin(angle);
    surface.vertices.emplace_back(x, y, height(x, y));
  }
  const auto vertex = [&](std::size_t ring, std::size_t column) {
    const std::size_t number = ring == 0 ? 0 : 1 + (ring - 1) * columns + column % columns;
    return first + static_cast<VertexId>(number);
  };
  for (std::size_t ring = 1; ring <= rings; ++ring) {
    for (std::size_t c = 0; c < columns; ++c) {
      surface.triangles.push_back({vertex(ring - 1, c), vertex(ring, c), vertex(ring, c + 1)});
      if (ring == 1) continue;
      surface.triangles.push_back(
          {vertex(ring - 1, c), vertex(ring, c + 1), vertex(ring - 1, c + 1)});
    }
  }
}

Surface fan(Random& random) {
  Surface surface;
  const double slope = random.uniform(0.1, 2.0);
  bool is_ridge = false;
  add_disk(surface, 1, 2 * (3 + random.below(60)), [&](double x, double y) {
    is_ridge = !is_ridge;
    return std::hypot(x, y) * slope * (is_ridge ? 1.0 : -random.uniform());
  });
  return surface;
}

Surface sheets(Random& random) {
  Surface surface;
  for (std::size_t s = 0, count = 2 + random.below(3); s < count; ++s) {
    add_disk(surface, 1 + random.below(4), 8 + random.below(6),
             [&](double, double) { return 1e-9 * static_cast<double>(s); });
  }
  return surface;
}

Surface cone(Random& random) {
  Surface surface;
  const double slope = std::pow(10.0, random.uniform(-1.0, 0.5));
  add_disk(surface, 1, 8 + random.below(392),
           [&](double x, double y) { return -slope * std::hypot(x, y); });
  return surface;
}

/// A bowl, or a saddle.
Surface quadric(Random& random, double sign) {
  Surface surface;
  const double depth = random.uniform(0.2, 1.2) / mesh_size;
  add_disk(surface, 4 + random.below(8), 16,
           [&](double x, double y) { return depth * (x * x + sign * y * y); });
  return surface;
}

double draw_radius(Random& random) {
  return random.uniform() < 0.25 ? 0.0 : random.uniform(0.05, 3.0);
}

/// Three to seven joints, with one to three bodies: balls, capsules and blades.
Instrument draw_instrument(Random& random, const Vec3& flange_at, std::vector<double>& q) {
  const int joints = 3 + static_cast<int>(random.below(5));
  const auto chain_at = [&, seed = random.bits()](const Vec3& base) {
    Random own(seed);
    std::vector<Joint> all;
    for (int k = 0; k < joints; ++k) {
      all.push_back({.origin = {own.uniform(0.0, 60.0) * own.direction()},
                     .axis = own.direction(),
                     .limits = {.lower = -3.0, .upper = 3.0, .velocity = 1.0}});
    }
    return Chain(std::move(all), {base}, {own.uniform(0.0, 15.0) * own.direction()});
  };
  const Chain at_origin = chain_at(Vec3::Zero());
  q = test::configuration(at_origin, random);
  const ChainState state = test::state_of(at_origin, q);
  const Chain chain = chain_at(flange_at - state.flange().position);
  std::vector<Body> bodies;
  for (std::size_t b = 0, count = 1 + random.below(3); b < count; ++b) {
    const int link = b == 0 ? joints : 1 + static_cast<int>(random.below(joints));
    const Vec3 place =
        b == 0 ? chain.flange().position : 15.0 * random.uniform() * random.direction();
    Body body{.name = "body", .points = {{link, place}}, .radius = draw_radius(random)};
    const double kind = random.uniform();
    const std::size_t more = kind < 0.25 ? 0 : kind < 0.6 ? 1 : 2 + random.below(6);
    for (std::size_t i = 0; i < more; ++i) {
      body.points.push_back({link, place + 10.0 * random.uniform() * random.direction()});
    }
    bodies.push_back(std::move(body));
  }
  return {chain, std::move(bodies)};
}

struct Cycles {
  int cycles = 0;
  int blocked = 0;
  int movable = 0;
};

/// One instrument beside a mesh, pressed on it.
class Scene {
 public:
  Scene(Surface surface, Random& random) : random_(random) {
    mesh_ = mesh_of(std::move(surface));
    index_ = std::make_shared<WideBvh>(mesh_);
    const Vec3 near_surface = place_on_mesh() + random.uniform(0.3, 5.0) * random.direction();
    const Instrument instrument = draw_instrument(random, near_surface, q_);
    guard_ = make_guard(instrument);
    prover_ = make_guard(instrument);
    target_ = place_on_mesh();
  }

  /// Returns false if the instrument begins too close.
  bool is_clear() { return prover_->prove(q_, std::vector<double>(q_.size(), 0.0)).is_clear(); }

  void run(int cycles, Cycles& tally) {
    for (int i = 0; i < cycles; ++i) {
      if (i % 12 == 0) target_ = place_on_mesh();
      const Vec3 wanted = (target_ - flange(q_)).normalized() + 0.3 * random_.direction();
      const Vec3 desired = step_length * wanted.normalized();
      const InstrumentStep step = guard_->step(q_, Twist{.linear = desired});
      ++tally.cycles;
      std::vector<double> dq(q_.size(), 0.0);
      if (step.ok()) dq.assign(step.increment.begin(), step.increment.end());
      if (step.status == Status::touching || step.status == Status::inside) return;
      if (step.status != Status::recovering && progress(dq, desired) < blocked_below) {
        ++tally.blocked;
        tally.movable += search(desired) >= movable_above ? 1 : 0;
      }
      for (std::size_t k = 0; k < q_.size(); ++k) q_[k] += dq[k];
    }
  }

 private:
  std::unique_ptr<InstrumentConstraint> make_guard(const Instrument& instrument) {
    return std::make_unique<InstrumentConstraint>(
        mesh_, index_, instrument, std::make_unique<ActiveSet>(),
        InstrumentOptions{.period = 0.1, .orientation_weight = 0.0});
  }

  Vec3 place_on_mesh() {
    const Triangle triangle =
        mesh_->triangle(static_cast<TriangleId>(random_.below(mesh_->triangle_count())));
    const double a = random_.uniform();
    const double b = random_.uniform(0.0, 1.0 - a);
    return (1.0 - a - b) * triangle[0] + a * triangle[1] + b * triangle[2];
  }

  Vec3 flange(const std::vector<double>& q) const {
    const ChainState state = test::state_of(guard_->instrument().chain(), q);
    return state.flange().position;
  }

  Vec3 moved_by(const std::vector<double>& dq) const {
    std::vector<double> there = q_;
    for (std::size_t k = 0; k < there.size(); ++k) there[k] += dq[k];
    return flange(there) - flange(q_);
  }

  double progress(const std::vector<double>& dq, const Vec3& desired) const {
    return moved_by(dq).dot(desired) / desired.squaredNorm();
  }

  /// Returns the progress of the best motion found by a random search of proved trials.
  double search(const Vec3& desired) {
    const Chain& chain = guard_->instrument().chain();
    const double most = guard_->options().period;  // velocity limits are 1 rad/s
    std::vector<double> best(q_.size(), 0.0);
    double least = desired.norm();
    double scale = 0.05;
    for (int i = 0; i < search_trials && progress(best, desired) < movable_above; ++i) {
      std::vector<double> trial = best;
      bool is_allowed = true;
      for (std::size_t k = 0; k < trial.size(); ++k) {
        trial[k] = std::clamp(trial[k] + scale * random_.uniform(-1.0, 1.0), -most, most);
        const JointLimits& limits = chain.joint(static_cast<int>(k) + 1).limits;
        is_allowed = is_allowed && std::abs(q_[k] + trial[k]) <= limits.upper;
      }
      const double missed = (moved_by(trial) - desired).norm();
      const bool is_better = is_allowed && missed < least && prover_->prove(q_, trial).is_clear();
      if (is_better) {
        best = trial;
        least = missed;
      }
      scale *= is_better ? 2.0 : 0.93;
      if (scale < 1e-5) scale = 0.05;
    }
    return progress(best, desired);
  }

  Random& random_;
  std::shared_ptr<const Mesh> mesh_;
  std::shared_ptr<const SpatialIndex> index_;
  std::unique_ptr<InstrumentConstraint> guard_;
  std::unique_ptr<InstrumentConstraint> prover_;
  std::vector<double> q_;
  Vec3 target_;
};

TEST(Liveness, BlockedCyclesOnHostileMeshesAreBlocked) {
  using Make = std::function<Surface(Random&)>;
  int blocked = 0;
  int movable = 0;
  for (const Make& make : {Make(soup), Make(fan), Make(sheets), Make(cone),
                           Make([](Random& random) { return quadric(random, 1.0); }),
                           Make([](Random& random) { return quadric(random, -1.0); })}) {
    Cycles tally;
    for (const std::uint64_t seed : {1u, 70000u}) {
      Random random(seed);
      const int enough = tally.cycles + test::trials(6000);
      while (tally.cycles < enough) {
        Scene scene(make(random), random);
        if (scene.is_clear()) scene.run(5 + static_cast<int>(random.below(61)), tally);
      }
    }
    blocked += tally.blocked;
    movable += tally.movable;
  }
  EXPECT_GT(blocked, test::trials(2000));
  EXPECT_LE(movable, blocked / 50);
}

}  // namespace
}  // namespace keepout
