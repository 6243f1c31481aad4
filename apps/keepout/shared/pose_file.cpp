// SPDX-License-Identifier: BSD-3-Clause
#include "shared/pose_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "keepout/error.h"
#include "shared/names.h"

namespace keepout::app {
namespace {

constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";  // of UTF-8, which spreadsheets write
constexpr std::string_view blanks = " \t\r";
constexpr std::string_view separators = " \t\r,";
constexpr std::size_t longest_line = (1 << 16) - 1;  // [bytes]

/// Returns the words of a line, separated by blanks, or by a comma with or without blanks around
/// it. Throws Error for an empty column.
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

/// Returns the number that a word contains. Throws Error if it is not a finite number.
double number_in(std::string_view word) {
  const std::string quoted = in_quotes(word);
  // from_chars does not accept a plus sign. Removing it from "+-1" would leave a valid number.
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::invalid_argument || end != word.data() + word.size()) {
    throw Error(quoted + " is not a number");
  }
  if (error == std::errc::result_out_of_range) {
    throw Error(quoted + " is beyond the range of a double (1e-308 to 1e308)");
  }
  if (!std::isfinite(value)) throw Error(quoted + " is not finite: finite numbers are needed");
  return value;
}

/// The format of the lines of a kind of file.
struct LineKind {
  std::size_t most_numbers;  // six, or seven if the last may be omitted
  std::string_view option;   // of the command line that names the file
  std::string_view name;     // of the kind of file
  std::string_view told;     // follows the message on a faulty line
};

std::vector<double> numbers_of(const std::vector<std::string_view>& words, const LineKind& kind) {
  std::vector<double> numbers;
  for (const std::string_view word : words) {
    if (numbers.size() == kind.most_numbers) {
      throw Error("has more than " + std::string(kind.most_numbers == 6 ? "six" : "seven") +
                  " numbers: " + in_quotes(word) + " is too many");
    }
    numbers.push_back(number_in(word));
  }
  if (numbers.size() < 6) throw Error("has fewer than six numbers");
  return numbers;
}

/// Passes the words and the number of each line to `take`, except for blank lines and comments.
/// Adds file and line to each Error that `take` throws.
template <class Take>
void read_lines(const std::filesystem::path& path, const LineKind& kind, const Take& take) {
  const auto told = [&](std::size_t number, const std::string& what) {
    return Error(path.string() + ":" + std::to_string(number) + ": " + what);
  };
  std::error_code ignored;
  std::ifstream file(path);
  if (!file || std::filesystem::is_directory(path, ignored)) {
    throw Error(path.string() + ": cannot be read; check the path given " +
                std::string(kind.option));
  }
  std::vector<char> line(longest_line + 1);
  std::size_t number = 1;
  for (; file.getline(line.data(), std::ssize(line)); ++number) {
    // gcount() includes the line end.
    const auto length = static_cast<std::size_t>(file.gcount()) - (file.eof() ? 0 : 1);
    std::string_view text(line.data(), length);
    if (number == 1 && text.starts_with(byte_order_mark)) text.remove_prefix(3);
    const std::size_t begin = text.find_first_not_of(blanks);
    if (begin == std::string_view::npos || text[begin] == '#') continue;
    try {
      take(words_in(text), number);
    } catch (const Error& error) {
      throw told(number, error.what() + std::string(kind.told));
    }
  }
  if (file.bad()) throw Error(path.string() + ": reading broke off; is the disk sound?");
  if (!file.eof()) {
    throw told(number, "is longer than " + std::to_string(longest_line) + " bytes; is this a " +
                           std::string(kind.name) + "?");
  }
}

bool begins_a_number(std::string_view word) {
  if (word.starts_with('"') || word.starts_with('\'')) word.remove_prefix(1);
  double ignored = 0.0;
  return word.starts_with('+') ||
         std::from_chars(word.data(), word.data() + word.size(), ignored).ec !=
             std::errc::invalid_argument;
}

Vec3 point_of(const std::vector<double>& n, std::size_t first) {
  return {n[first], n[first + 1], n[first + 2]};
}

}  // namespace

std::vector<PoseLine> read_poses(const std::filesystem::path& path) {
  const LineKind kind{6, "to --poses", "pose file",
                      "; each line is six numbers in mm, 'px py pz dx dy dz', or with "
                      "--closed-loop 'gx gy gz rx ry rz'"};
  std::vector<PoseLine> poses;
  read_lines(path, kind, [&](const auto& words, std::size_t) {
    const std::vector<double> n = numbers_of(words, kind);
    poses.push_back({point_of(n, 0), point_of(n, 3)});
  });
  if (poses.empty()) throw Error(path.string() + ": holds no pose; give one line for each step");
  return poses;
}

FiducialPairs read_fiducials(const std::filesystem::path& path) {
  const LineKind kind{7, "as FILE", "file of fiducials",
                      "; each line is 'measured x,y,z, model x,y,z' and, in all or none, a weight"};
  FiducialPairs pairs;
  bool may_be_header = true;
  read_lines(path, kind, [&](const auto& words, std::size_t line) {
    if (std::exchange(may_be_header, false) && std::ranges::none_of(words, begins_a_number)) return;
    const std::vector<double> n = numbers_of(words, kind);
    if (!pairs.lines.empty() && (n.size() == 7) == pairs.weights.empty()) {
      throw Error(n.size() == 7 ? "has a weight, and lines before it have none"
                                : "has no weight, and lines before it have one");
    }
    if (n.size() == 7) {
      if (!(n[6] > 0.0)) throw Error("has a weight that is not above 0");
      pairs.weights.push_back(n[6]);
    }
    pairs.measured.push_back(point_of(n, 0));
    pairs.model.push_back(point_of(n, 3));
    pairs.lines.push_back(line);
  });
  if (pairs.lines.empty()) {
    throw Error(path.string() + ": holds no fiducials; give one line for each pair");
  }
  return pairs;
}

}  // namespace keepout::app
