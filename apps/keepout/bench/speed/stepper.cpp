// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/speed/stepper.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "keepout/activation/registry.h"
#include "keepout/solvers/registry.h"
#include "keepout/step/step.h"
#include "number_text.h"

namespace keepout::app {
namespace {

/// Room for what is within 5 mm anywhere on the meshes here.
constexpr Capacity room{.triangles = std::size_t{1} << 17,
                        .planes = std::size_t{1} << 16,
                        .variables = 3,
                        .extra_rows = 0};

constexpr std::size_t most_samples = 500;

/// Half of them one after the other, as a loop would ask; half from all over.
std::vector<Motion> sample_of(std::span<const Motion> motions) {
  const std::size_t in_a_row = std::min(most_samples / 2, motions.size());
  std::vector<Motion> sample(motions.begin(), motions.begin() + in_a_row);
  for (std::size_t s = 0; s < in_a_row; ++s) {
    sample.push_back(motions[s * motions.size() / in_a_row]);
  }
  return sample;
}

template <class IsSame>
std::string compared(Stepper& one, Stepper& other, std::span<const Motion> motions,
                     IsSame&& is_same) {
  const std::vector<Motion> sample = sample_of(motions);
  const auto wrong = static_cast<std::size_t>(std::ranges::count_if(
      sample, [&](const Motion& m) { return !is_same(one.ask(m), other.ask(m), m); }));
  if (wrong == 0) return {};
  return "not timed: " + grouped(wrong) + " of " + counted(sample.size(), "step") +
         " are not the same";
}

}  // namespace

Stepper::Stepper(std::shared_ptr<const Mesh> mesh, const SpatialIndex& index, std::string_view rule,
                 std::string_view solver, const StepOptions& options, Form form)
    : mesh_(std::move(mesh)),
      index_(index),
      plain_(make_activation(rule, mesh_)),
      searching_(form == Form::searching ? plain_->searching(index_) : nullptr),
      rule_(searching_ ? searching_.get() : plain_.get()),
      solver_(make_solver(solver)),
      options_(options),
      work_(room) {
  rule_->reserve(work_.candidates.capacity());
  solver_->reserve(3, static_cast<int>(work_.planes.capacity()));
}

Answer Stepper::ask(const Motion& motion) noexcept {
  const Step result = step(*mesh_, index_, *rule_, *solver_, motion, options_, work_);
  return {result.status, result.motion};
}

Stepper certified(const IndexedMesh& on, double margin, Form form) {
  return Stepper(on.mesh, *on.index, "certified", "active_set", {.radius = 5.0, .margin = margin},
                 form);
}

Stepper paper(const IndexedMesh& on, double radius, Form form) {
  return Stepper(on.mesh, *on.index, "paper", "active_set", {.radius = radius}, form);
}

std::string disagreement(Stepper& one, Stepper& other, std::span<const Motion> motions) {
  return compared(one, other, motions,
                  [](const Answer& a, const Answer& b, const Motion&) { return a == b; });
}

std::string disagreement(Stepper& one, Stepper& other, std::span<const Motion> motions,
                         double accuracy) {
  return compared(one, other, motions, [&](const Answer& a, const Answer& b, const Motion& motion) {
    if (!is_ok(a.status) || !is_ok(b.status)) return true;  // a solver may give up
    return (a.motion - b.motion).norm() <= accuracy * motion.desired.norm();
  });
}

}  // namespace keepout::app
