// SPDX-License-Identifier: BSD-3-Clause
// Source of the format: "VTK File Formats", Kitware. METADATA and the arrays of version 5 are as
// VTK 9 writes them.
#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "binary_number.h"
#include "text_lines.h"
#include "vtk_cells.h"

namespace keepout {
namespace {

using NamedType = std::pair<std::string_view, NumberType>;

/// Types by name. VTK writes ids of vtkIdType as int. The size of long depends on the machine that
/// wrote it; 64 bits are assumed.
constexpr std::array<NamedType, 14> types{{{"char", {1, true, true}},
                                           {"signed_char", {1, true, true}},
                                           {"unsigned_char", {1, true, false}},
                                           {"short", {2, true, true}},
                                           {"unsigned_short", {2, true, false}},
                                           {"int", {4, true, true}},
                                           {"unsigned_int", {4, true, false}},
                                           {"vtkidtype", {4, true, true}},
                                           {"long", {8, true, true}},
                                           {"unsigned_long", {8, true, false}},
                                           {"vtktypeint64", {8, true, true}},
                                           {"vtktypeuint64", {8, true, false}},
                                           {"float", {4, false, true}},
                                           {"double", {8, false, true}}}};

/// Words that begin a section, or an array in a section.
constexpr std::array<std::string_view, 10> section_words{
    "points", "polygons",  "triangle_strips", "vertices", "lines",
    "field",  "cell_data", "point_data",      "offsets",  "connectivity"};

constexpr const char* cut_short = ", so it was cut short; copy or export it again";

/// Reads a legacy VTK file: lines with keywords, each followed by numbers, as text or as bytes in
/// big-endian order.
class LegacyVtk {
 public:
  explicit LegacyVtk(const MeshSource& source) : source_(source), lines_(source) {}

  MeshFile read() {
    read_header();
    while (true) {
      if (!next_section()) {
        if (!is_binary_) lines_.warn_of_open_end(last_number_lost, mesh_.warnings);
        break;
      }
      section_ = lines_.words()[0];
      const std::string key = lower(section_);
      if (key == "field") {
        read_field();
      } else if (key == "points") {
        read_points();
      } else if (key == "polygons") {
        read_cells(VtkCellKind::polygons);
      } else if (key == "triangle_strips") {
        read_cells(VtkCellKind::strips);
      } else if (key == "vertices" || key == "lines") {
        pass_over_cells();
      } else if (key == "cell_data" || key == "point_data") {
        break;  // the surface comes before
      } else {
        lines_.fail("a line that is not understood: " + in_quotes(section_) +
                    "; the file is damaged, or no legacy VTK file");
      }
    }
    if (!is_binary_ && lines_.has_only_floats()) mesh_.round_to_floats();
    cells_.cut_into(mesh_, source_);
    return std::move(mesh_);
  }

 private:
  void read_header() {
    constexpr std::string_view magic = "# vtk DataFile Version ";
    const std::string_view first = lines_.next_line();
    const std::string_view version = first.substr(std::min(first.size(), magic.size()));
    if (!first.starts_with(magic) || version.empty() || version[0] < '1' || version[0] > '5' ||
        !version.substr(1).starts_with('.')) {
      lines_.fail("expected '# vtk DataFile Version', 1.0 to 5.1, found " + in_quotes(first) +
                  "; if the file has another format, give it that extension");
    }
    major_ = version[0] - '0';
    mesh_.comments.emplace_back(lines_.next_line());
    const std::string encoding = lower(lines_.next() ? lines_.words()[0] : "");
    if (encoding != "ascii" && encoding != "binary") {
      lines_.fail("expected 'ASCII' or 'BINARY', found " + in_quotes(encoding) +
                  "; the file is damaged, or was cut short");
    }
    is_binary_ = encoding == "binary";
    if (!next_section() || lower(lines_.words()[0]) != "dataset" || lines_.words().size() != 2) {
      lines_.fail("expected 'DATASET POLYDATA'; the file is damaged, or was cut short");
    }
    if (lower(lines_.words()[1]) != "polydata") {
      lines_.fail("the dataset is " + in_quotes(lines_.words()[1]) +
                  ", and only POLYDATA is a surface; extract the surface and save that");
    }
  }

  /// Advances to the next line of a section, past METADATA. Returns false at the end of the file.
  bool next_section() {
    while (lines_.next()) {
      if (lower(lines_.words()[0]) != "metadata" || pass_over_metadata()) return true;
    }
    return false;
  }

  /// Skips METADATA, which ends with a blank line. Returns true if it ended without one: then the
  /// current line begins the next section.
  bool pass_over_metadata() {
    std::uint64_t names = 0;  // names to follow, one a line, blank if a component has no name
    while (lines_.left() > 0) {
      lines_.next_line();
      const auto words = lines_.words();
      const std::string word = words.empty() ? std::string() : lower(words[0]);
      if (words.size() > 1 && std::ranges::find(section_words, word) != section_words.end()) {
        return true;
      }
      if (names > 0) {
        --names;
      } else if (words.empty()) {
        return false;
      } else if (word == "component_names") {
        names = components_;
      }
    }
    return false;
  }

  /// Returns a word of the section's line, which must have `count` words.
  std::string_view word(std::size_t i, std::size_t count) const {
    if (lines_.words().size() != count) {
      lines_.fail(in_quotes(section_) + " needs " + std::to_string(count - 1) +
                  " words behind it; the file is damaged");
    }
    return lines_.words()[i];
  }

  const NumberType& type_named(std::string_view name) const {
    const auto type = std::ranges::find(types, lower(name), &NamedType::first);
    if (type == types.end()) {
      lines_.fail("unknown type " + in_quotes(name) + "; the file is damaged");
    }
    return type->second;
  }

  void check_room(std::uint64_t count, const NumberType& type) const {
    // In text, a number takes a digit and a separator.
    const std::uint64_t most = is_binary_ ? lines_.left() / type.size : (lines_.left() + 1) / 2;
    if (count <= most) return;
    lines_.fail(in_quotes(section_) + " declares " + std::to_string(count) +
                " numbers, more than the file has room for; the file is damaged, or was cut short");
  }

  /// Calls take(bytes, word) for `count` numbers of a section. In a binary file `bytes` has the
  /// number, and in a text `word` has it.
  template <class Take>
  void for_each_number(std::uint64_t count, const NumberType& type, const Take& take) {
    check_room(count, type);
    if (is_binary_) {
      const std::string_view bytes = lines_.take_bytes(count * type.size);
      for (std::uint64_t i = 0; i < count; ++i) {
        take(bytes.data() + i * type.size, std::string_view());
      }
      return;
    }
    std::size_t used = lines_.words().size();
    for (std::uint64_t i = 0; i < count; ++i, ++used) {
      if (used == lines_.words().size()) {
        used = 0;
        if (!lines_.next()) {
          lines_.fail("the file ends within its " + in_quotes(section_) + cut_short);
        }
      }
      const std::string_view word = lines_.words()[used];
      if (std::isalpha(static_cast<unsigned char>(word[0])) != 0 && word.size() > 3) {
        lines_.fail(in_quotes(section_) + " declares " + std::to_string(count) +
                    " numbers, but has only " + std::to_string(i) + " before " + in_quotes(word) +
                    "; the file is damaged");
      }
      take(nullptr, word);
    }
    if (count > 0 && used != lines_.words().size()) {
      lines_.fail("more numbers than the " + std::to_string(count) + " that " +
                  in_quotes(section_) + " declares; the file is damaged");
    }
  }

  std::vector<std::uint64_t> wholes(std::uint64_t count, const NumberType& type) {
    if (!type.whole) lines_.fail(in_quotes(section_) + " must have integers; the file is damaged");
    check_room(count, type);
    std::vector<std::uint64_t> numbers;
    numbers.reserve(static_cast<std::size_t>(count));
    for_each_number(count, type, [&](const char* bytes, std::string_view word) {
      const std::int64_t number = bytes != nullptr ? whole_at(bytes, type, is_swapped) : 0;
      if (number < 0) {
        lines_.fail(in_quotes(section_) + " has the number " + std::to_string(number) +
                    ", which is below 0; the file is damaged");
      }
      numbers.push_back(bytes != nullptr ? static_cast<std::uint64_t>(number)
                                         : lines_.whole_number(word));
    });
    return numbers;
  }

  void read_points() {
    const std::uint64_t count = lines_.whole_number(word(1, 3));
    const NumberType& type = type_named(word(2, 3));
    if (has_points_) lines_.fail("has its POINTS twice; check the export");
    has_points_ = true;
    components_ = 3;
    const bool is_single = !type.whole && type.size == sizeof(float);
    check_room(count, type);  // so that 3 * count does not overflow
    std::vector<Vec3>& points = mesh_.surface.vertices;
    Eigen::Index axis = 0;
    for_each_number(3 * count, type, [&](const char* bytes, std::string_view word) {
      if (axis == 0) points.emplace_back();
      double& x = points.back()[axis];
      x = bytes != nullptr ? real_at(bytes, type, is_swapped)
          : is_single      ? double{lines_.number<float>(word)}
                           : lines_.coordinate(word);
      if (!std::isfinite(x)) {
        source_.fail("point " + std::to_string(points.size() - 1) +
                     " has a coordinate that is not finite; repair the mesh and export it again");
      }
      axis = (axis + 1) % 3;
    });
  }

  /// Reads an array of offsets or corners, from version 5 on.
  std::vector<std::uint64_t> read_array(std::string_view name, std::uint64_t count) {
    if (!next_section() || lower(lines_.words()[0]) != name || lines_.words().size() != 2) {
      lines_.fail("expected " + in_quotes(name) +
                  " and a type; the file is damaged, or was cut short");
    }
    section_ = lines_.words()[0];
    components_ = 1;
    return wholes(count, type_named(lines_.words()[1]));
  }

  void read_cells(VtkCellKind kind) {
    const std::uint64_t first = lines_.whole_number(word(1, 3));
    const std::uint64_t second = lines_.whole_number(word(2, 3));
    if (major_ >= 5) {
      if (first == 0) return;  // VTK then writes no arrays
      std::vector<std::uint64_t> offsets = read_array("offsets", first);
      if (offsets[0] != 0) lines_.fail("the first offset is not 0; the file is damaged");
      offsets.erase(offsets.begin());
      add_cells(kind, offsets, read_array("connectivity", second));
      return;
    }
    // Each cell is the number of its corners, followed by the corners.
    const std::vector<std::uint64_t> numbers = wholes(second, {4, true, true});
    std::vector<std::uint64_t> ends;
    std::vector<std::uint64_t> corners;
    corners.reserve(numbers.size());
    for (std::size_t i = 0; i < numbers.size(); ends.push_back(corners.size())) {
      const std::uint64_t size = numbers[i++];
      if (size > numbers.size() - i) {
        lines_.fail("a cell has fewer corners than it declares; the file is damaged");
      }
      const auto begin = numbers.begin() + static_cast<std::ptrdiff_t>(i);
      corners.insert(corners.end(), begin, begin + static_cast<std::ptrdiff_t>(size));
      i += static_cast<std::size_t>(size);
    }
    if (ends.size() != first) {
      lines_.fail(in_quotes(section_) + " declares " + std::to_string(first) + " cells, but has " +
                  std::to_string(ends.size()) + "; the file is damaged");
    }
    add_cells(kind, ends, corners);
  }

  void add_cells(VtkCellKind kind, const std::vector<std::uint64_t>& ends,
                 const std::vector<std::uint64_t>& corners) {
    if (!has_points_) lines_.fail("the cells come before the POINTS; export it again");
    cells_.add(kind, ends, corners, 0, mesh_.surface.vertices.size(), lines_);
  }

  /// Skips vertices and lines, which have no area.
  void pass_over_cells() {
    const std::uint64_t first = lines_.whole_number(word(1, 3));
    const std::uint64_t second = lines_.whole_number(word(2, 3));
    if (major_ < 5) {
      wholes(second, {4, true, true});
      cells_.leave_out(first);
    } else if (first > 0) {
      read_array("offsets", first);
      read_array("connectivity", second);
      cells_.leave_out(first - 1);
    }
  }

  /// Skips the arrays of a field, except the anatomical space.
  void read_field() {
    const std::uint64_t arrays = lines_.whole_number(word(2, 3));
    for (std::uint64_t i = 0; i < arrays; ++i) {
      if (!next_section()) lines_.fail("the file ends within a field" + std::string(cut_short));
      if (lines_.words()[0] == "NULL_ARRAY") continue;
      section_ = lines_.words()[0];
      const std::string name = lower(section_);
      const std::uint64_t components = lines_.whole_number(word(1, 4));
      const std::uint64_t tuples = lines_.whole_number(word(2, 4));
      if (components > 0 && tuples > 8 * lines_.left() / components) {  // a byte may have 8 bits
        lines_.fail("the field " + in_quotes(section_) +
                    " is larger than the file; the file is damaged, or was cut short");
      }
      components_ = components;
      pass_over_values(components * tuples, lower(word(3, 4)), name == "space");
    }
  }

  /// Skips the values of an array of a field, unless they name the anatomical space.
  void pass_over_values(std::uint64_t count, const std::string& type, bool is_space) {
    if (type == "string" || type == "utf8_string") {
      for (std::uint64_t i = 0; i < count; ++i) {
        const std::string text(is_binary_ ? take_string() : lines_.next_line());
        if (is_space) mesh_.comments.push_back("SPACE=" + text);
      }
    } else if (type == "variant") {
      for (std::uint64_t i = 0; i < count; ++i) lines_.next_line();  // in a binary file too
    } else {
      const bool is_packed = is_binary_ && type == "bit";
      for_each_number(is_packed ? (count + 7) / 8 : count,
                      type == "bit" ? NumberType{1, true, false} : type_named(type),
                      [](const char*, std::string_view) {});
    }
  }

  /// Returns a string of a binary file. The two highest bits of its first byte give the size of its
  /// length.
  std::string_view take_string() {
    const auto take = [&](std::uint64_t count) {
      if (count > lines_.left())
        lines_.fail("the file ends within a string" + std::string(cut_short));
      return lines_.take_bytes(count);
    };
    const auto first = static_cast<unsigned char>(take(1)[0]);
    constexpr std::array<std::size_t, 4> lengths{8, 4, 2, 1};
    std::uint64_t length = first & 0x3fU;
    for (const char c : take(lengths[first >> 6] - 1)) {
      length = length << 8 | static_cast<unsigned char>(c);
    }
    return take(length);
  }

  static constexpr bool is_swapped = std::endian::native != std::endian::big;

  const MeshSource& source_;
  TextLines lines_;
  MeshFile mesh_;
  VtkCells cells_;
  std::string section_;           // the present section, for messages
  std::uint64_t components_ = 1;  // of the last array
  int major_ = 0;                 // of the format
  bool is_binary_ = false;
  bool has_points_ = false;
};

}  // namespace

MeshFile read_vtk(const MeshSource& source) { return LegacyVtk(source).read(); }

}  // namespace keepout
