// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "mesh_file.h"
#include "polygons.h"

namespace keepout {

/// The cells of PolyData that have an area.
enum class VtkCellKind { polygons, strips };

/// Extracts the faces from the cells of PolyData.
class VtkCells {
 public:
  /// Adds cells. `corners`: of all cells, one after another. `ends`: the end of each cell in
  /// `corners`. Each corner is one of `vertices`, which are numbered from `first` on in the mesh.
  /// Fails with place.fail() if the numbers are inconsistent.
  template <class Place>
  void add(VtkCellKind kind, std::span<const std::uint64_t> ends,
           std::span<const std::uint64_t> corners, std::uint64_t first, std::uint64_t vertices,
           const Place& place) {
    std::uint64_t begin = 0;
    for (const std::uint64_t end : ends) {
      if (end < begin || end > corners.size()) {
        place.fail("a cell reaches from corner " + std::to_string(begin) + " to " +
                   std::to_string(end) + " of " + std::to_string(corners.size()) +
                   "; the file is damaged");
      }
      const auto size = static_cast<std::size_t>(end - begin);
      add_cell(kind, corners.subspan(static_cast<std::size_t>(begin), size), first, vertices,
               place);
      begin = end;
    }
    if (begin != corners.size()) {
      place.fail("there are " + std::to_string(corners.size()) + " corners, but the cells have " +
                 std::to_string(begin) + "; the file is damaged");
    }
  }

  /// Counts vertices and lines, which are not read.
  void leave_out(std::uint64_t cells) noexcept { left_out_ += cells; }

  /// Like Polygons::cut_into(), once all vertices are in the mesh. Warns of cells that were left
  /// out.
  void cut_into(MeshFile& mesh, const MeshSource& source) const {
    polygons_.cut_into(mesh, source);
    if (left_out_ > 0) {
      mesh.warnings.push_back(std::to_string(left_out_) + " lines or points are left out");
    }
  }

 private:
  template <class Place>
  void add_cell(VtkCellKind kind, std::span<const std::uint64_t> cell, std::uint64_t first,
                std::uint64_t vertices, const Place& place) {
    const auto add_corner = [&](std::uint64_t corner) {
      polygons_.add_corner(corner, vertices, first, place);
    };
    if (kind == VtkCellKind::polygons || cell.size() < 3) {
      for (const std::uint64_t corner : cell) add_corner(corner);
      polygons_.end_polygon();
      return;
    }
    // In every second triangle of a strip the first two corners are swapped, so that all are wound
    // alike.
    for (std::size_t i = 0; i + 2 < cell.size(); ++i) {
      add_corner(cell[i + i % 2]);
      add_corner(cell[i + 1 - i % 2]);
      add_corner(cell[i + 2]);
      polygons_.end_polygon();
    }
  }

  Polygons polygons_;
  std::uint64_t left_out_ = 0;
};

}  // namespace keepout
