// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/harness.h"

#include <unistd.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

namespace keepout::fuzz {
namespace {

/// A directory that is removed when the process ends.
class ScratchFolder {
 public:
  ScratchFolder()
      : path_(std::filesystem::temp_directory_path() /
              ("keepout_fuzz_" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(path_);
  }
  ~ScratchFolder() {
    std::error_code none;
    std::filesystem::remove_all(path_, none);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace

void require(bool condition, std::string_view promise) {
  if (!condition) throw Finding(std::string(promise));
}

std::vector<Harness> harnesses() {
  std::vector<Harness> all;
  for (const auto& part : {mesh_harnesses(), text_harnesses(), json_harnesses(),
                           protocol_harnesses(), tip_harnesses(), instrument_harnesses()}) {
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

std::filesystem::path scratch_file(std::string_view name, Bytes bytes) {
  static const ScratchFolder folder;
  const std::filesystem::path file = folder.path() / name;
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), std::ssize(bytes));
  return file;
}

std::string_view text_of(Bytes bytes) noexcept {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::uint8_t Source::byte() noexcept {
  if (left_.empty()) return 0;
  const std::uint8_t first = left_.front();
  left_ = left_.subspan(1);
  return first;
}

double Source::fraction() noexcept {
  const int high = byte();
  return (256 * high + byte()) / 65535.0;
}

double Source::magnitude(double low, double high) noexcept {
  return std::pow(10.0, between(low, high));
}

Vec3 Source::point(double half_width) noexcept {
  Vec3 point;
  for (double& x : point) {
    x = between(-half_width, half_width);
    if (once_in(2)) x = std::round(x);
  }
  return point;
}

Vec3 Source::direction() noexcept {
  const Vec3 axis = Vec3::Unit(static_cast<Eigen::Index>(below(3)));
  const Vec3 any = point(1.0);
  return once_in(3) || any.norm() < 1e-3 ? axis : any.normalized();
}

double Source::any_number() noexcept {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  constexpr std::array special{
      0.0, -0.0, 1.0, infinity, -infinity, std::numeric_limits<double>::quiet_NaN(), 1e30, -1e300};
  if (once_in(2)) return special[below(special.size())];
  std::uint64_t bits = 0;
  for (int i = 0; i < 8; ++i) bits = bits << 8 | byte();
  return std::bit_cast<double>(bits);
}

}  // namespace keepout::fuzz
