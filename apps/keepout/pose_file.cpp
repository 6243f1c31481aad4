// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pose_file.h"

#include <charconv>
#include <cmath>
#include <fstream>
#include <string>
#include <string_view>

#include "keepout/error.h"

namespace keepout::app {
namespace {

constexpr std::string_view separators = " \t\r,";

/// Takes the next word off the front of `line`; empty at its end.
std::string_view next_word(std::string_view& line) {
  const std::size_t begin = line.find_first_not_of(separators);
  if (begin == std::string_view::npos) return {};
  line.remove_prefix(begin);
  const std::string_view word = line.substr(0, line.find_first_of(separators));
  line.remove_prefix(word.size());
  return word;
}

class LineReader {
 public:
  LineReader(const std::filesystem::path& path, std::size_t number, std::string_view line)
      : path_(path), number_(number), rest_(line) {}

  bool is_blank_or_comment() const {
    std::string_view rest = rest_;
    const std::string_view word = next_word(rest);
    return word.empty() || word.front() == '#';
  }

  Vec3 point() { return {number(), number(), number()}; }

  void expect_end() {
    if (const std::string_view word = next_word(rest_); !word.empty()) {
      fail("has more than six numbers: '" + std::string(word) + "' is too many");
    }
  }

 private:
  double number() {
    const std::string_view word = next_word(rest_);
    if (word.empty()) fail("has fewer than six numbers");
    const std::string_view digits = word.starts_with('+') ? word.substr(1) : word;
    double value = 0.0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc{} || end != digits.data() + digits.size()) {
      fail("'" + std::string(word) + "' is not a number");
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
    LineReader reader(path, number, line);
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
