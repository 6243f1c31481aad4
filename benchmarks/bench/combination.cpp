// SPDX-License-Identifier: BSD-3-Clause
#include "bench/combination.h"

#include <algorithm>

#include "keepout/activation/registry.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/solvers/registry.h"
#include "shared/names.h"

namespace keepout::app {
namespace {

constexpr const char* reference_index = "wide_bvh";
constexpr const char* reference_solver = "active_set";
constexpr const char* certified = "certified";
constexpr const char* usual_index = "fcl_obbrss";
constexpr const char* usual_solver = "nlopt_slsqp";

using Names = std::vector<std::string>;
using Radii = std::vector<double>;

/// Appends every combination of these, each once, of parts that there are.
void add(std::vector<Combination>& all, const Names& index_names, const Names& rules,
         const Names& solvers, const Radii& radii) {
  const std::vector<std::optional<double>> any(radii.begin(), radii.end()), none(1);
  for (const std::string& index : index_names) {
    for (const std::string& rule : rules) {
      for (const std::string& solver : solvers) {
        if (!index_backends().has(index) || !activation_rules().has(rule) ||
            !solver_backends().has(solver)) {
          continue;
        }
        for (const std::optional<double>& radius : rule == certified ? none : any) {
          const Combination combination{index, rule, solver, radius};
          if (std::ranges::find(all, combination) == all.end()) all.push_back(combination);
        }
      }
    }
  }
}

/// By index, as the table has them.
std::vector<Combination> sorted(std::vector<Combination> all) {
  std::ranges::stable_sort(all, {}, [](const Combination& combination) {
    const auto& table = index_backends();
    return std::ranges::find(table, combination.index, &IndexBackend::name) - table.begin();
  });
  return all;
}

Names or_else(const Names& asked, const Names& otherwise) {
  return asked.empty() ? otherwise : asked;
}

std::vector<Combination> default_matrix(const Radii& radii) {
  Names fast_indices = index_names();
  std::erase(fast_indices, "brute_force");  // takes a thousand times as long
  std::vector<Combination> all;
  add(all, fast_indices, {"paper", certified}, {reference_solver}, radii);
  add(all, {reference_index}, {"all_faces"}, {reference_solver}, radii);
  add(all, {reference_index}, {"paper", certified}, solver_names(), radii);
  add(all, {usual_index}, {"paper"}, {usual_solver}, radii);
  return sorted(std::move(all));
}

}  // namespace

bool names_parts(const Selection& selection) {
  return !(selection.indices.empty() && selection.activations.empty() && selection.solvers.empty());
}

std::vector<Combination> combinations_of(const Selection& selection) {
  const Radii radii = selection.radii.empty() ? Radii{5.0, 1.0, 0.25} : selection.radii;
  if (!names_parts(selection)) return default_matrix(radii);
  std::vector<Combination> all;
  add(all, or_else(selection.indices, {reference_index}),
      or_else(selection.activations, {"paper", certified}),
      or_else(selection.solvers, {reference_solver}), radii);
  return sorted(std::move(all));
}

}  // namespace keepout::app
