// SPDX-License-Identifier: BSD-3-Clause
#include "bench/speed/guarded_mesh.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "bench/reference.h"
#include "bench/subject.h"
#include "keepout/error.h"
#include "keepout/factory/make_motion_constraint.h"
#include "keepout/fixtures/real_mesh.h"
#include "keepout/fixtures/resample_mesh.h"
#include "keepout/index/wide_bvh.h"
#include "number_text.h"

namespace keepout::app {
namespace {

/// Room for what is within 5 mm anywhere on the meshes here.
constexpr Capacity room{.triangles = std::size_t{1} << 17,
                        .planes = std::size_t{1} << 16,
                        .variables = 3,
                        .extra_rows = 0};

class QueriesOnly final : public SpatialIndex {
 public:
  explicit QueriesOnly(std::shared_ptr<const SpatialIndex> index) : index_(std::move(index)) {}

  void collect(const Ball& ball, TriangleBuffer& candidates) const noexcept override {
    index_->collect(ball, candidates);
  }
  std::size_t memory() const noexcept override { return index_->memory(); }

 private:
  std::shared_ptr<const SpatialIndex> index_;
};

Surface resampled_bunny(std::size_t triangles) {
  return surface_of(*make_mesh({std::string(resampled_mesh), triangles}));
}

/// Half of them one after the other, as a loop would ask; half from all over.
std::vector<Motion> sample_of(std::span<const Motion> motions) {
  constexpr std::size_t most_samples = 500;
  const std::size_t in_a_row = std::min(most_samples / 2, motions.size());
  std::vector<Motion> sample(motions.begin(), motions.begin() + in_a_row);
  for (std::size_t s = 0; s < in_a_row; ++s) {
    sample.push_back(motions[s * motions.size() / in_a_row]);
  }
  return sample;
}

}  // namespace

IndexedMesh with_index(std::shared_ptr<const Mesh> mesh) {
  auto index = std::make_shared<const WideBvh>(mesh);
  return {std::move(mesh), std::move(index)};
}

IndexedMesh queried(const IndexedMesh& on) {
  return {on.mesh, std::make_shared<const QueriesOnly>(on.index)};
}

Surface in_single_precision(Surface surface) {
  for (Vec3& vertex : surface.vertices) vertex = vertex.cast<float>().cast<double>().eval();
  return surface;
}

std::shared_ptr<const Mesh> bunny_of(std::size_t triangles) {
  return std::make_shared<const Mesh>(in_single_precision(resampled_bunny(triangles)));
}

std::filesystem::path large_bunny(std::size_t triangles) {
  const std::filesystem::path folder = fixture_cache() / "made";
  std::filesystem::path file = folder / ("bunny_" + std::to_string(triangles) + ".stl");
  if (std::filesystem::exists(file)) return file;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw Error(folder.string() + ": cannot be made: " + error.message());
  constexpr std::uint64_t seed = 2;
  write_subdivided(file, resampled_bunny(triangles / 4), seed);
  return file;
}

MotionConstraint certified(const IndexedMesh& on, double margin) {
  return make_motion_constraint(on.mesh, on.index,
                                {.activation = "certified",
                                 .radius = 5.0,
                                 .margin = margin,
                                 .inside = Inside::taken_as_is,
                                 .capacity = room});
}

MotionConstraint paper(const IndexedMesh& on, double radius, const std::string& solver) {
  return make_motion_constraint(
      on.mesh, on.index,
      {.activation = "paper", .solver = solver, .radius = radius, .margin = 0.0, .capacity = room});
}

std::string disagreement(MotionConstraint& one, MotionConstraint& other,
                         std::span<const Motion> motions, double accuracy) {
  const auto differ = [&](const Motion& motion) {
    const Answer a = one.step(motion), b = other.step(motion);
    if (accuracy == 0.0) return a != b;
    if (!is_ok(a.status) || !is_ok(b.status)) return false;  // a solver may give up
    return !((a.motion - b.motion).norm() <= accuracy * motion.desired.norm());
  };
  const std::vector<Motion> sample = sample_of(motions);
  const auto wrong = static_cast<std::size_t>(std::ranges::count_if(sample, differ));
  if (wrong == 0) return {};
  return "not timed: " + grouped(wrong) + " of " + counted(sample.size(), "step") +
         " are not the same";
}

}  // namespace keepout::app
