// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pose_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string>
#include <string_view>

#include "keepout/error.h"

namespace keepout::app {
namespace {

constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";  // of UTF-8, as spreadsheets write
constexpr std::string_view blanks = " \t\r";
constexpr std::string_view separators = " \t\r,";

class LineReader {
 public:
  LineReader(const std::filesystem::path& path, std::size_t number, std::string_view line)
      : path_(path), number_(number), rest_(line) {}

  bool is_blank_or_comment() {
    skip_blanks();
    return rest_.empty() || rest_.front() == '#';
  }

  Vec3 point() { return {number(), number(), number()}; }

  void expect_end() {
    if (const std::string_view word = next_word(); !word.empty()) {
      fail("has more than six numbers: '" + std::string(word) + "' is too many");
    }
  }

 private:
  void skip_blanks() {
    rest_.remove_prefix(std::min(rest_.find_first_not_of(blanks), rest_.size()));
  }

  /// The next word, past the comma that may stand before it; empty at the end of the line.
  std::string_view next_word() {
    skip_blanks();
    if (!at_start_ && rest_.starts_with(',')) {
      rest_.remove_prefix(1);
      skip_blanks();
    }
    if (rest_.starts_with(',')) fail("has an empty column: no number before a comma");
    at_start_ = false;
    const std::string_view word = rest_.substr(0, rest_.find_first_of(separators));
    rest_.remove_prefix(word.size());
    return word;
  }

  double number() {
    const std::string_view word = next_word();
    if (word.empty()) fail("has fewer than six numbers");
    // from_chars knows no plus sign, but would take the minus after one.
    const bool has_plus = word.starts_with('+') && !word.starts_with("+-");
    const std::string_view digits = has_plus ? word.substr(1) : word;
    double value = 0.0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error == std::errc::invalid_argument || end != digits.data() + digits.size()) {
      fail("'" + std::string(word) + "' is not a number");
    }
    if (error == std::errc::result_out_of_range) {
      fail("'" + std::string(word) + "' is beyond the range of a double (1e-308 to 1e308)");
    }
    if (!std::isfinite(value)) {
      fail("'" + std::string(word) + "' is not finite: a pose needs six finite numbers");
    }
    return value;
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(path_.string() + ":" + std::to_string(number_) + ": " + what +
                "; each line is six numbers in mm, 'px py pz dx dy dz', or with --closed-loop "
                "'gx gy gz rx ry rz'");
  }

  const std::filesystem::path& path_;
  std::size_t number_;
  std::string_view rest_;
  bool at_start_ = true;
};

}  // namespace

std::vector<PoseLine> read_poses(const std::filesystem::path& path) {
  std::error_code ignored;
  std::ifstream file(path);
  if (!file || std::filesystem::is_directory(path, ignored)) {
    throw Error(path.string() + ": cannot be read; check the path given to --poses");
  }
  std::vector<PoseLine> poses;
  std::string line;
  for (std::size_t number = 1; std::getline(file, line); ++number) {
    const bool marked = number == 1 && line.starts_with(byte_order_mark);
    LineReader reader(path, number, std::string_view(line).substr(marked ? 3 : 0));
    if (reader.is_blank_or_comment()) continue;
    PoseLine pose;
    pose.first = reader.point();
    pose.second = reader.point();
    reader.expect_end();
    poses.push_back(pose);
  }
  if (file.bad()) throw Error(path.string() + ": reading broke off; is the disk sound?");
  if (poses.empty()) throw Error(path.string() + ": holds no pose; give one line for each step");
  return poses;
}

}  // namespace keepout::app
