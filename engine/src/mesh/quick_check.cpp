// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <mutex>
#include <string_view>
#include <utility>

#include "../parallel.h"
#include "half_edges.h"
#include "keepout/mesh/diagnostics.h"

namespace keepout {
namespace {

// If all edges have two triangles of consistent winding, the sides run along each edge once in both
// directions. So the edges are distributed over cells by a hash. Each cell sums up the hashes of
// its edges, with the sign of the direction. The sum is 0 in a cell without a fault, and only by
// chance in a cell with one. Only the edges of cells with another sum are gathered and examined.
// That reads the triangles twice, and needs only the memory of the cells.

/// An edge: the lower vertex in the upper 32 bits, and the higher vertex in the lower 32 bits.
using Edge = std::uint64_t;

/// All bits set for a side from the lower vertex to the higher, and no bits for the other
/// direction.
using Upwards = std::uint64_t;

/// Not linear, so that edges of a regular grid do not cancel out. (The finalizer of splitmix64.)
constexpr std::uint64_t hash_of(Edge edge) noexcept {
  edge = (edge ^ (edge >> 30)) * 0xbf58476d1ce4e5b9u;
  edge = (edge ^ (edge >> 27)) * 0x94d049bb133111ebu;
  return edge ^ (edge >> 31);
}

/// Returns the number of cells: about twenty triangles each, and at most what fits in a core's own
/// cache.
std::size_t cell_count(std::size_t triangles) noexcept {
  return std::bit_ceil(std::clamp<std::size_t>(triangles / 20, 64, 65536));
}

/// Calls visit(own, edge, upwards) for each side of the triangles, on up to `threads` threads. Each
/// thread has its own copy of `empty`, and finally calls gather(own), one after another. The
/// direction of a side is as good as random, so no branch depends on it: mispredictions would take
/// most of the time.
template <class Own, class Visit, class Gather>
void share_sides(const Mesh& mesh, unsigned threads, const Own& empty, const Visit& visit,
                 const Gather& gather) {
  std::mutex mutex;
  const std::size_t share = std::max<std::size_t>(mesh.triangle_count() / threads + 1, share_size);
  share_ranges(mesh.triangle_count(), threads, share, [&](std::size_t begin, std::size_t end) {
    Own own = empty;
    for_each_side(mesh, begin, end, [&](TriangleId, int, std::uint64_t from, std::uint64_t to) {
      const Upwards upwards = std::uint64_t{0} - ((from - to) >> 63);
      const std::uint64_t swap = (from ^ to) & upwards;
      visit(own, (to ^ swap) << 32 | (from ^ swap), upwards);
    });
    const std::lock_guard lock(mutex);
    gather(own);
  });
}

/// Returns the sum of each cell.
std::vector<std::uint64_t> sums_of_cells(const Mesh& mesh, std::size_t cells, unsigned threads) {
  std::vector<std::uint64_t> sums(cells, 0);
  share_sides(
      mesh, threads, std::vector<std::uint64_t>(cells, 0),  // not `sums`, which gather changes
      [cells](std::vector<std::uint64_t>& own, Edge edge, Upwards upwards) {
        const std::uint64_t hash = hash_of(edge);
        own[hash & (cells - 1)] +=
            (hash ^ upwards) - upwards;  // -hash if all bits of `upwards` are set
      },
      [&](const std::vector<std::uint64_t>& own) {
        for (std::size_t i = 0; i < cells; ++i) sums[i] += own[i];
      });
  return sums;
}

/// A side of a triangle: its edge, and whether it runs upwards.
using Side = std::pair<Edge, Upwards>;

/// Returns the sides in the cells with a sum other than 0, in order.
std::vector<Side> suspects(const Mesh& mesh, const std::vector<std::uint64_t>& sums,
                           unsigned threads) {
  std::vector<bool> is_suspect(sums.size());
  for (std::size_t i = 0; i < sums.size(); ++i) is_suspect[i] = sums[i] != 0;
  std::vector<Side> all;
  share_sides(
      mesh, threads, std::vector<Side>(),
      [&](std::vector<Side>& own, Edge edge, Upwards upwards) {
        if (is_suspect[hash_of(edge) & (sums.size() - 1)]) own.emplace_back(edge, upwards);
      },
      [&](const std::vector<Side>& own) { all.insert(all.end(), own.begin(), own.end()); });
  std::sort(all.begin(), all.end());
  return all;
}

/// Formats a number with three digits: 0.24, 3600.
std::string short_number(double value) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), value < 1000.0 ? "%.3g" : "%.0f", value);
  return text.data();
}

/// Returns a doubt about the unit, from the size of the mesh; empty for the sizes of organs.
std::string doubt_of_unit(const Mesh& mesh, double scale) {
  const double extent = mesh.bounds().size().maxCoeff();
  if (extent >= MeshFindings::meters_below && extent <= MeshFindings::micrometers_above) return {};
  if (extent == 0.0) {
    return "all vertices coincide" +
           (scale == 1.0 ? std::string() : " after they were scaled by " + short_number(scale)) +
           ", so there is no surface: export the mesh again";
  }
  const std::string size = "the mesh is " + short_number(extent) + " mm across";
  if (scale != 1.0) {
    return size + " after it was scaled by " + short_number(scale) +
           ", and no anatomy is: check the unit or the scale that was given";
  }
  std::string text = size + " if its unit is mm";
  std::string example = "m";
  std::string_view joint = "; in ";
  for (const UnitGuess& guess : other_units(extent)) {
    if (joint == "; in ") example = guess.unit;
    text.append(joint).append(guess.unit).append(" it would be ");
    text += short_number(extent * guess.millimetres) + " mm across";
    joint = ", and in ";
  }
  return text + ": scale it to mm, or give the unit of the file, for example --unit " + example +
         " or unit=\"" + example + "\", unless all your lengths are in its unit";
}

/// Returns true if the triangles of a closed surface face inward: its signed volume is below 0.
bool faces_inward(const Mesh& mesh, unsigned threads) {
  const Vec3 origin = mesh.bounds().center();
  double volume = 0.0;
  std::mutex mutex;
  share_ranges(mesh.triangle_count(), threads, [&](std::size_t begin, std::size_t end) {
    double own = 0.0;
    for (std::size_t i = begin; i < end; ++i) {
      const Triangle t = mesh.triangle(static_cast<TriangleId>(i));
      own += (t[0] - origin).dot((t[1] - origin).cross(t[2] - origin)) / 6.0;
    }
    const std::lock_guard lock(mutex);
    volume += own;
  });
  return volume < -1e-9 * std::pow(mesh.bounds().size().maxCoeff(), 3);
}

}  // namespace

EdgeFaults find_edge_faults(const Mesh& mesh, unsigned threads) {
  threads = thread_count(threads);
  EdgeFaults faults;
  const auto sums = sums_of_cells(mesh, cell_count(mesh.triangle_count()), threads);
  if (std::all_of(sums.begin(), sums.end(), [](std::uint64_t sum) { return sum == 0; })) {
    return faults;
  }
  const std::vector<Side> sides = suspects(mesh, sums, threads);
  for (auto side = sides.begin(); side != sides.end();) {
    const auto next =
        std::find_if(side, sides.end(), [&](const Side& s) { return s.first != side->first; });
    if (next - side == 1) faults.boundary = true;
    if (next - side == 2 && side[0] == side[1]) faults.inconsistent = true;
    side = next;
  }
  return faults;
}

std::span<const UnitGuess> length_units() noexcept {
  static constexpr std::array<UnitGuess, 5> units{
      {{"m", 1000.0}, {"cm", 10.0}, {"mm", 1.0}, {"um", 0.001}, {"in", 25.4}}};
  return units;
}

std::vector<UnitGuess> other_units(double extent) {
  // Sizes of organs and bones, and the least size at which millimeters are certain. [mm]
  constexpr double smallest = 20.0, largest = 600.0, usual = 30.0;
  std::vector<UnitGuess> guesses;
  if (extent >= usual && extent <= MeshFindings::micrometers_above) return guesses;
  for (const UnitGuess& guess : length_units()) {
    const double size = extent * guess.millimetres;
    const bool is_another = guess.millimetres != 1.0;
    if (is_another && size >= smallest && size <= largest) guesses.push_back(guess);
  }
  return guesses;
}

std::vector<std::string> quick_check(const Mesh& mesh, unsigned threads, double scale) {
  std::vector<std::string> warnings;
  std::string doubt = doubt_of_unit(mesh, scale);
  if (!doubt.empty()) warnings.push_back(std::move(doubt));
  const EdgeFaults faults = find_edge_faults(mesh, threads);
  if (faults.boundary) {
    warnings.emplace_back("the surface is open: nothing is guarded where triangles are missing");
  }
  if (faults.inconsistent) {
    warnings.emplace_back(
        "the surface is wound inconsistently: some neighbors disagree about which of their sides "
        "is free");
  }
  if (!faults.boundary && !faults.inconsistent && faces_inward(mesh, thread_count(threads))) {
    warnings.emplace_back(
        "the surface is closed and faces inward: the room that it encloses is free, and the rest "
        "is solid. If it bounds a solid, flip it: --flip or flip=True");
  }
  return warnings;
}

}  // namespace keepout
