// SPDX-License-Identifier: BSD-3-Clause
#include "pose_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/error.h"
#include "names.h"

namespace keepout::app {
namespace {

constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";  // of UTF-8, as spreadsheets write
constexpr std::string_view blanks = " \t\r";
constexpr std::string_view separators = " \t\r,";
constexpr std::size_t longest_line = (1 << 16) - 1;  // [bytes]

/// The words of a line, parted by blanks, or by a comma with or without blanks around it. Throws
/// Error for an empty column.
std::vector<std::string_view> words_in(std::string_view line) {
  std::vector<std::string_view> words;
  bool is_after_comma = true;
  while (true) {
    line.remove_prefix(std::min(line.find_first_not_of(blanks), line.size()));
    if (line.empty()) return words;
    if (line.starts_with(',')) {
      if (is_after_comma) throw Error("has an empty column: no number before a comma");
      is_after_comma = true;
      line.remove_prefix(1);
    } else {
      is_after_comma = false;
      words.push_back(line.substr(0, line.find_first_of(separators)));
      line.remove_prefix(words.back().size());
    }
  }
}

/// Throws Error for a word that is no finite number.
double number_in(std::string_view word) {
  const std::string quoted = in_quotes(word);
  // from_chars knows no plus sign, but would take the minus after one.
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::invalid_argument || end != word.data() + word.size()) {
    throw Error(quoted + " is not a number");
  }
  if (error == std::errc::result_out_of_range) {
    throw Error(quoted + " is beyond the range of a double (1e-308 to 1e308)");
  }
  if (!std::isfinite(value))
    throw Error(quoted + " is not finite: a pose needs six finite numbers");
  return value;
}

PoseLine pose_of(const std::vector<std::string_view>& words) {
  std::array<double, 6> n;
  for (std::size_t i = 0; i < std::min(words.size(), n.size()); ++i) n[i] = number_in(words[i]);
  if (words.size() < n.size()) throw Error("has fewer than six numbers");
  if (words.size() > n.size()) {
    throw Error("has more than six numbers: " + in_quotes(words[6]) + " is too many");
  }
  return {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
}

}  // namespace

std::vector<PoseLine> read_poses(const std::filesystem::path& path) {
  std::error_code ignored;
  std::ifstream file(path);
  if (!file || std::filesystem::is_directory(path, ignored)) {
    throw Error(path.string() + ": cannot be read; check the path given to --poses");
  }
  std::vector<PoseLine> poses;
  std::vector<char> line(longest_line + 1);
  std::size_t number = 1;
  for (; file.getline(line.data(), std::ssize(line)); ++number) {
    // A line end has been counted as well.
    const auto length = static_cast<std::size_t>(file.gcount()) - (file.eof() ? 0 : 1);
    std::string_view text(line.data(), length);
    if (number == 1 && text.starts_with(byte_order_mark)) text.remove_prefix(3);
    const std::size_t begin = text.find_first_not_of(blanks);
    if (begin == std::string_view::npos || text[begin] == '#') continue;
    try {
      poses.push_back(pose_of(words_in(text)));
    } catch (const Error& error) {
      throw Error(path.string() + ":" + std::to_string(number) + ": " + error.what() +
                  "; each line is six numbers in mm, 'px py pz dx dy dz', or with --closed-loop "
                  "'gx gy gz rx ry rz'");
    }
  }
  if (file.bad()) throw Error(path.string() + ": reading broke off; is the disk sound?");
  if (!file.eof()) {
    throw Error(path.string() + ":" + std::to_string(number) + ": is longer than " +
                std::to_string(longest_line) + " bytes; is this a pose file?");
  }
  if (poses.empty()) throw Error(path.string() + ": holds no pose; give one line for each step");
  return poses;
}

}  // namespace keepout::app
