// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/combination.h"

#include <algorithm>

#include "bench/parts.h"
#include "keepout/activation/registry.h"

namespace keepout::app {
namespace {

constexpr const char* reference_index = "wide_bvh";
constexpr const char* reference_solver = "active_set";
constexpr const char* certified = "certified";
constexpr const char* usual_index = "fcl_obbrss";
constexpr const char* usual_solver = "nlopt_slsqp";

using Names = std::vector<std::string>;
using Radii = std::vector<double>;

template <class Table>
bool has(const Table& table, const std::string& name) {
  return std::ranges::any_of(table, [&](const auto& entry) { return entry.name == name; });
}

/// A list of combinations in which each stands once.
class Matrix {
 public:
  void add(const Names& indices, const Names& activations, const Names& solvers,
           const Radii& radii) {
    for (const std::string& index : indices) {
      for (const std::string& activation : activations) {
        for (const std::string& solver : solvers) {
          if (activation == certified) {
            add({index, activation, solver, std::nullopt});
            continue;
          }
          for (const double radius : radii) add({index, activation, solver, radius});
        }
      }
    }
  }

  std::vector<Combination> sorted() && {
    std::stable_sort(all_.begin(), all_.end(), [](const Combination& a, const Combination& b) {
      return place_of(a.index) < place_of(b.index);
    });
    return std::move(all_);
  }

 private:
  void add(const Combination& combination) {
    const bool is_there = std::find(all_.begin(), all_.end(), combination) != all_.end();
    const bool exists = has(indices(), combination.index) &&
                        has(activation_rules(), combination.activation) &&
                        has(solver_backends(), combination.solver);
    if (!is_there && exists) all_.push_back(combination);
  }

  static std::ptrdiff_t place_of(const std::string& index) {
    const auto& table = indices();
    return std::ranges::find(table, index, &IndexBackend::name) - table.begin();
  }

  std::vector<Combination> all_;
};

Names or_else(const Names& asked, const Names& otherwise) {
  return asked.empty() ? otherwise : asked;
}

/// All but the oracle, which takes a thousand times as long.
Names fast_indices() {
  Names names;
  for (const IndexBackend& index : indices()) {
    if (index.name != "brute_force") names.emplace_back(index.name);
  }
  return names;
}

Names all_solvers() {
  Names names;
  for (const SolverBackend& solver : solver_backends()) names.emplace_back(solver.name);
  return names;
}

std::vector<Combination> default_matrix(const Radii& radii) {
  Matrix matrix;
  matrix.add(fast_indices(), {"paper", certified}, {reference_solver}, radii);
  matrix.add({reference_index}, {"all_faces"}, {reference_solver}, radii);
  matrix.add({reference_index}, {"paper", certified}, all_solvers(), radii);
  matrix.add({usual_index}, {"paper"}, {usual_solver}, radii);
  return std::move(matrix).sorted();
}

}  // namespace

bool names_parts(const Selection& selection) {
  return !(selection.indices.empty() && selection.activations.empty() && selection.solvers.empty());
}

std::vector<Combination> combinations_of(const Selection& selection) {
  const Radii radii = selection.radii.empty() ? Radii{5.0, 1.0, 0.25} : selection.radii;
  if (!names_parts(selection)) return default_matrix(radii);
  Matrix matrix;
  matrix.add(or_else(selection.indices, {reference_index}),
             or_else(selection.activations, {"paper", certified}),
             or_else(selection.solvers, {reference_solver}), radii);
  return std::move(matrix).sorted();
}

std::vector<Combination> quick_combinations() { return default_matrix({5.0, 1.0}); }

}  // namespace keepout::app
