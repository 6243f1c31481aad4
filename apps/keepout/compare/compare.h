// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>

#include "compare/comparison.h"
#include "keepout/mesh/mesh.h"

namespace keepout::app {

/// How thoroughly to compare.
struct CompareExtent {
  std::size_t poses = 60;        // for the indices, under each rule
  std::size_t problems = 2'000;  // for the solvers
  std::size_t pairs = 500;       // of tool and triangle, of each kind, for the narrow phases
  std::uint64_t seed = 1;
};

struct CompareOptions {
  std::string mesh = "skull";  // a real fixture or a file
  CompareExtent extent;
  std::optional<std::filesystem::path> json;  // to be written
};

/// Everything that can take another's place, on the same input.
Comparison compare_parts(const std::string& mesh_name, const std::shared_ptr<const Mesh>& mesh,
                         const CompareExtent& extent);

/// Compares, and prints tables. Throws Error. Nonzero, for the exit status, when parts disagree by
/// more than they may.
int compare(const CompareOptions& options, std::ostream& out);

}  // namespace keepout::app
