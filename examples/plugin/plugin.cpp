// SPDX-License-Identifier: BSD-3-Clause
// A plugin: an index and a solver of your own, for `keepout bench --plugin` and `compare --plugin`.
#include "grid.h"
#include "hildreth.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/module.h"
#include "keepout/solvers/registry.h"

KEEPOUT_MODULE();

namespace {

constexpr keepout::IndexBackend indices[] = {
    {.name = "my_grid",
     .description = "uniform grids, one for each class of sizes",
     .make =
         [](std::shared_ptr<const keepout::Mesh> mesh) -> std::unique_ptr<keepout::SpatialIndex> {
       return std::make_unique<Grid>(std::move(mesh));
     },
     .most_triangles = std::size_t{1} << 31,
     .library = nullptr}};

constexpr keepout::SolverBackend solvers[] = {
    {.name = "hildreth",
     .description = "coordinate ascent on the dual (Hildreth 1957)",
     .make = []() -> std::unique_ptr<keepout::Solver> { return std::make_unique<Hildreth>(); },
     .allocation = keepout::Allocation::never,
     .accuracy = 1e-6,
     .library = nullptr}};

}  // namespace

const std::span<const keepout::IndexBackend> keepout_indices = indices;
const std::span<const keepout::SolverBackend> keepout_solvers = solvers;
