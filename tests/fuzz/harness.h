// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/error.h"
#include "keepout/geometry/shapes.h"

namespace keepout::fuzz {

// A harness passes untrusted bytes to one part of keepout. The program keepout_fuzz lets libFuzzer
// choose the bytes; the test fuzz_corpus_test takes them from the files in corpus/.

using Bytes = std::span<const std::uint8_t>;

/// Thrown if a result contradicts what the documentation promises.
struct Finding : std::logic_error {
  using std::logic_error::logic_error;
};

/// Throws Finding unless the condition holds.
void require(bool condition, std::string_view promise);

struct Harness {
  std::string_view name;     // also of the folder of its corpus
  std::string_view sources;  // tested files and folders, for the report of coverage
  /// Throws anything if it finds a fault. Returns normally for bytes that the part rejects as
  /// documented.
  void (*run)(Bytes bytes);
};

// The harnesses of each source file.
std::span<const Harness> mesh_harnesses() noexcept;
std::span<const Harness> text_harnesses() noexcept;
std::span<const Harness> json_harnesses() noexcept;
std::span<const Harness> protocol_harnesses() noexcept;
std::span<const Harness> tip_harnesses() noexcept;
std::span<const Harness> instrument_harnesses() noexcept;

/// Returns all harnesses.
std::vector<Harness> harnesses();

/// Calls `read`, and ignores Error: the documented rejection of an input.
template <class Read>
void ignore_errors(const Read& read) {
  try {
    read();
  } catch (const Error&) {
  }
}

/// Writes the bytes to a file in a temporary directory of this process, and returns its path.
std::filesystem::path scratch_file(std::string_view name, Bytes bytes);

/// Returns the bytes as text.
std::string_view text_of(Bytes bytes) noexcept;

/// Makes decisions and numbers of bytes. Without further bytes, all of them are 0.
class Source {
 public:
  explicit Source(Bytes bytes) noexcept : left_(bytes) {}

  bool is_empty() const noexcept { return left_.empty(); }
  Bytes rest() const noexcept { return left_; }

  std::uint8_t byte() noexcept;
  /// Returns a number below `end`, which is at most 256.
  std::size_t below(std::size_t end) noexcept { return byte() % end; }
  /// Returns true once in `times`.
  bool once_in(std::size_t times) noexcept { return below(times) == times - 1; }
  /// Returns a number from 0 to 1, in steps of 1 / 65,535.
  double fraction() noexcept;
  /// Returns a number from `low` to `high`.
  double between(double low, double high) noexcept { return low + (high - low) * fraction(); }
  /// Returns 10 to a power from `low` to `high`.
  double magnitude(double low, double high) noexcept;
  /// Returns a point in a cube around the origin; half of the coordinates are whole numbers.
  Vec3 point(double half_width) noexcept;
  /// Returns a unit vector.
  Vec3 direction() noexcept;
  /// Returns any double, also NaN and infinity.
  double any_number() noexcept;

 private:
  Bytes left_;
};

}  // namespace keepout::fuzz
