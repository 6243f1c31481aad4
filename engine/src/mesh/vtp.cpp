// SPDX-License-Identifier: BSD-3-Clause
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "binary_number.h"
#include "text_lines.h"
#include "vtk_cells.h"
#include "vtp_document.h"

namespace keepout {
namespace {

using NamedType = std::pair<std::string_view, NumberType>;

constexpr std::array<NamedType, 10> types{{{"Int8", {1, true, true}},
                                           {"UInt8", {1, true, false}},
                                           {"Int16", {2, true, true}},
                                           {"UInt16", {2, true, false}},
                                           {"Int32", {4, true, true}},
                                           {"UInt32", {4, true, false}},
                                           {"Int64", {8, true, true}},
                                           {"UInt64", {8, true, false}},
                                           {"Float32", {4, false, true}},
                                           {"Float64", {8, false, true}}}};

constexpr const char* cut_short = "; the file is damaged, or was cut short";

/// Returns the six bits of a character of base64, or -1 for any other.
int bits_of(char c) noexcept {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' ? 62 : c == '/' ? 63 : -1;
}

/// A part of a file, raw or in base64, that is read byte by byte. Base64 may contain padding,
/// because VTK encodes counts and compressed data separately.
class ByteStream {
 public:
  ByteStream(const MeshSource& source, const std::string& array, std::uint64_t begin,
             std::uint64_t end, bool is_base64)
      : source_(source),
        array_(array),
        begin_(begin),
        position_(begin),
        end_(end),
        is_base64_(is_base64) {}

  /// Returns an upper bound of the bytes left.
  std::uint64_t left() const noexcept {
    const std::uint64_t left = end_ - position_ + (buffer_.size() - used_);
    return is_base64_ ? left / 4 * 3 + 3 : left;
  }

  /// Returns true if only blanks follow.
  bool is_at_end() { return is_base64_ ? decoded_ == 0 && !find_character() : position_ == end_; }

  /// Returns the number of bytes of the file that were used.
  std::uint64_t taken() const noexcept { return position_ - begin_ - (buffer_.size() - used_); }

  void read(char* to, std::uint64_t size) {
    if (size > left()) fail("ends too early" + std::string(cut_short));
    if (!is_base64_) {
      source_.read(position_, to, static_cast<std::size_t>(size));
      position_ += size;
      return;
    }
    for (std::uint64_t i = 0; i < size; ++i) {
      if (decoded_ == 0) decode_group();
      to[i] = group_[3 - decoded_--];
    }
  }

  /// Reads a count before binary data.
  std::uint64_t read_count(const VtpDocument& document) {
    std::array<char, 8> bytes;
    read(bytes.data(), document.count_size);
    const bool swapped = document.is_big_endian != (std::endian::native == std::endian::big);
    return document.count_size == 8 ? number_at<std::uint64_t>(bytes.data(), swapped)
                                    : number_at<std::uint32_t>(bytes.data(), swapped);
  }

  [[noreturn]] void fail(const std::string& what) const {
    source_.fail("array " + in_quotes(array_) + ": " + what);
  }

 private:
  /// Advances to the next character that is not a blank. Returns false if there is no other.
  bool find_character() {
    constexpr std::uint64_t at_once = std::uint64_t{1} << 16;
    constexpr std::string_view blanks = " \n\r\t";
    for (;; ++used_) {
      if (used_ == buffer_.size()) {
        buffer_.resize(static_cast<std::size_t>(std::min(at_once, end_ - position_)));
        used_ = 0;
        if (buffer_.empty()) return false;
        source_.read(position_, buffer_.data(), buffer_.size());
        position_ += buffer_.size();
      }
      if (blanks.find(buffer_[used_]) == std::string_view::npos) return true;
    }
  }

  char next_character() {
    if (!find_character()) fail("ends too early" + std::string(cut_short));
    return buffer_[used_++];
  }

  /// Decodes four characters to three bytes, or fewer if they end with '='.
  void decode_group() {
    std::uint32_t bits = 0;
    std::size_t padding = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const char c = next_character();
      const int six = bits_of(c);
      const bool is_padding = c == '=' && i >= 2;
      padding += is_padding ? 1 : 0;
      if ((six < 0 && !is_padding) || (padding > 0 && !is_padding)) {
        fail(in_quotes(std::string_view(&c, 1)) + " is not of base64" + cut_short);
      }
      bits = bits << 6 | static_cast<std::uint32_t>(is_padding ? 0 : six);
    }
    decoded_ = 3 - padding;
    // The bytes are at the end of group_, so the next one is always decoded_ from the end.
    for (std::size_t i = 0; i < decoded_; ++i) {
      group_[padding + i] = static_cast<char>(bits >> (16 - 8 * i) & 0xffU);
    }
  }

  const MeshSource& source_;
  const std::string& array_;
  std::uint64_t begin_;
  std::uint64_t position_;
  std::uint64_t end_;
  bool is_base64_;
  std::vector<char> buffer_;  // of base64
  std::size_t used_ = 0;      // of the buffer
  std::array<char, 3> group_{};
  std::size_t decoded_ = 0;  // bytes of the group that are not read yet
};

[[noreturn]] void refuse_surplus(const ByteStream& stream, std::uint64_t most) {
  stream.fail("holds more than the " + std::to_string(most) + " bytes that belong in it" +
              cut_short);
}

std::vector<char> read_plain(ByteStream& stream, const VtpDocument& document, std::uint64_t most) {
  const std::uint64_t size = stream.read_count(document);
  if (size > stream.left()) {
    stream.fail("declares " + std::to_string(size) + " bytes, more than the file has room for" +
                cut_short);
  }
  if (size > most) refuse_surplus(stream, most);
  std::vector<char> bytes(static_cast<std::size_t>(size));
  stream.read(bytes.data(), bytes.size());
  return bytes;
}

/// Appends what a block unpacks to. Returns false unless these are `size` bytes. Takes memory as
/// the data come: a false size alone takes none.
bool unpack(std::vector<char>& block, std::uint64_t size, std::vector<char>& bytes) {
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) throw std::bad_alloc();
  stream.next_in = reinterpret_cast<Bytef*>(block.data());
  stream.avail_in = static_cast<uInt>(block.size());
  int status = Z_OK;
  std::uint64_t left = size;
  while (status == Z_OK) {
    std::array<char, std::size_t{1} << 14> part;
    stream.next_out = reinterpret_cast<Bytef*>(part.data());
    stream.avail_out = part.size();
    status = inflate(&stream, Z_NO_FLUSH);
    const std::size_t got = part.size() - stream.avail_out;
    if (got > left) break;
    left -= got;
    bytes.insert(bytes.end(), part.begin(), part.begin() + static_cast<std::ptrdiff_t>(got));
  }
  inflateEnd(&stream);
  return status == Z_STREAM_END && left == 0;
}

/// Reads blocks of data, each compressed by zlib. Unpacks none if all have more than `most` bytes:
/// a small file would take any memory.
std::vector<char> read_compressed(ByteStream& stream, const VtpDocument& document,
                                  std::uint64_t most) {
  std::vector<char> bytes;
  const std::uint64_t blocks = stream.read_count(document);
  if (blocks == 0) return bytes;
  const std::uint64_t size = stream.read_count(document);
  const std::uint64_t last_size = stream.read_count(document);
  if (blocks > stream.left() / document.count_size) {
    stream.fail("declares " + std::to_string(blocks) + " blocks, more than the file has room for" +
                cut_short);
  }
  std::vector<std::uint64_t> packed(static_cast<std::size_t>(blocks));
  for (std::uint64_t& count : packed) count = stream.read_count(document);
  const auto unpacked_size = [&](std::size_t b) {
    return b + 1 == packed.size() && last_size > 0 ? last_size : size;
  };
  std::uint64_t room = most;
  for (std::size_t b = 0; b < packed.size(); ++b) {
    if (packed[b] > stream.left() || unpacked_size(b) > most_unpacked * packed[b]) {
      stream.fail("block " + std::to_string(b) + " has an impossible size" + cut_short);
    }
    if (unpacked_size(b) > room) refuse_surplus(stream, most);
    room -= unpacked_size(b);
  }
  std::vector<char> block;
  for (std::size_t b = 0; b < packed.size(); ++b) {
    if (packed[b] > stream.left()) {
      stream.fail("block " + std::to_string(b) + " has an impossible size" + cut_short);
    }
    block.resize(static_cast<std::size_t>(packed[b]));
    stream.read(block.data(), block.size());
    if (!unpack(block, unpacked_size(b), bytes)) {
      stream.fail("block " + std::to_string(b) + " cannot be unpacked" + cut_short);
    }
  }
  return bytes;
}

/// Reads the arrays of a document.
class VtpArrays {
 public:
  VtpArrays(const MeshSource& source, const VtpDocument& document)
      : source_(source), document_(document), unread_(source.size()) {}

  /// Returns the numbers of an array that should have `count`. Text may have more, and other
  /// formats fewer: the caller must check.
  std::vector<double> reals(const VtpArray& array, std::uint64_t count) {
    const NumberType& type = type_of(array);
    std::vector<double> numbers;
    if (array.format == VtpArray::Format::text) {
      TextLines lines = text_of(array);
      const bool is_single = !type.whole && type.size == sizeof(float);
      while (lines.next()) {
        for (const std::string_view word : lines.words()) {
          numbers.push_back(is_single ? double{lines.number<float>(word)} : lines.coordinate(word));
        }
      }
      if (!lines.has_only_floats()) has_only_floats_ = false;
      return numbers;
    }
    for_each_number(array, type, count, [&](const char* bytes, bool swapped) {
      const double number = real_at(bytes, type, swapped);
      if (number != static_cast<float>(number)) has_only_floats_ = false;
      numbers.push_back(number);
    });
    return numbers;
  }

  /// Returns true if all real numbers so far are floats, or may have been printed from floats.
  bool has_only_floats() const noexcept { return has_only_floats_; }

  /// Like reals().
  std::vector<std::uint64_t> wholes(const VtpArray& array, std::uint64_t count) {
    const NumberType& type = type_of(array);
    if (!type.whole) fail(array, "must have integers, not " + in_quotes(array.type));
    std::vector<std::uint64_t> numbers;
    if (array.format == VtpArray::Format::text) {
      TextLines lines = text_of(array);
      while (lines.next()) {
        for (const std::string_view word : lines.words()) {
          numbers.push_back(lines.whole_number(word));
        }
      }
      return numbers;
    }
    for_each_number(array, type, count, [&](const char* bytes, bool swapped) {
      const std::int64_t number = whole_at(bytes, type, swapped);
      if (number < 0) fail(array, "has a number below 0; the file is damaged");
      numbers.push_back(static_cast<std::uint64_t>(number));
    });
    return numbers;
  }

  /// Returns the strings of an array, each of which ends with a NUL. In text, each character is a
  /// number.
  std::vector<std::string> strings(const VtpArray& array) {
    std::string text;
    if (array.format == VtpArray::Format::text) {
      TextLines lines = text_of(array);
      while (lines.next()) {
        for (const std::string_view word : lines.words()) {
          text += static_cast<char>(lines.whole_number(word));
        }
      }
    } else {
      constexpr std::uint64_t longest = std::uint64_t{1} << 16;
      const std::vector<char> bytes = bytes_of(array, longest);
      text.assign(bytes.begin(), bytes.end());
    }
    std::vector<std::string> strings;
    for (std::size_t begin = 0, end = 0; begin < text.size(); begin = end + 1) {
      end = std::min(text.find('\0', begin), text.size());
      strings.push_back(text.substr(begin, end - begin));
    }
    return strings;
  }

  /// Returns true if the array has no numbers.
  bool is_empty(const VtpArray& array) const {
    if (array.format == VtpArray::Format::text) return !text_of(array).next();
    ByteStream stream = stream_of(array);
    return stream.is_at_end() || stream.read_count(document_) == 0;
  }

  [[noreturn]] void fail(const VtpArray& array, const std::string& what) const {
    source_.fail("array " + in_quotes(array.name) + ": " + what);
  }

 private:
  const NumberType& type_of(const VtpArray& array) const {
    const auto type = std::ranges::find(types, array.type, &NamedType::first);
    if (type == types.end()) fail(array, "unknown type " + in_quotes(array.type));
    return type->second;
  }

  TextLines text_of(const VtpArray& array) const {
    std::string text(static_cast<std::size_t>(array.end - array.begin), '\0');
    source_.read(array.begin, text.data(), text.size());
    return TextLines(std::move(text), source_.name(), {.first_line = array.line});
  }

  ByteStream stream_of(const VtpArray& array) const {
    if (array.format != VtpArray::Format::appended) {
      return ByteStream(source_, array.name, array.begin, array.end, true);
    }
    const std::uint64_t end = source_.size();
    if (document_.appended == 0 || array.begin > end - document_.appended) {
      fail(array, "its data are not in the file" + std::string(cut_short));
    }
    return ByteStream(source_, array.name, document_.appended + array.begin, end,
                      !document_.is_raw);
  }

  std::vector<char> bytes_of(const VtpArray& array, std::uint64_t most) {
    ByteStream stream = stream_of(array);
    std::vector<char> bytes = document_.is_compressed ? read_compressed(stream, document_, most)
                                                      : read_plain(stream, document_, most);
    // After a count of 0, VTK writes the sizes of blocks that do not exist.
    if (array.format == VtpArray::Format::base64 && !bytes.empty() && !stream.is_at_end()) {
      fail(array, "has more base64 than the " + std::to_string(bytes.size()) +
                      " bytes that it declares; the file is damaged");
    }
    if (stream.taken() > unread_) fail(array, "overlaps another one; the file is damaged");
    unread_ -= stream.taken();
    return bytes;
  }

  template <class Take>
  void for_each_number(const VtpArray& array, const NumberType& type, std::uint64_t count,
                       const Take& take) {
    const std::uint64_t most = std::min(count, UINT64_MAX / type.size) * type.size;
    const std::vector<char> bytes = bytes_of(array, most);
    if (bytes.size() % type.size != 0) fail(array, "has half a number" + std::string(cut_short));
    const bool swapped = document_.is_big_endian != (std::endian::native == std::endian::big);
    for (std::size_t i = 0; i < bytes.size(); i += type.size) take(bytes.data() + i, swapped);
  }

  const MeshSource& source_;
  const VtpDocument& document_;
  std::uint64_t unread_;  // bytes of the file that no array has used; many arrays at one place
                          // could take all memory
  bool has_only_floats_ = true;
};

/// Fails if an array has numbers although its Piece declares a `count` of 0 or no count.
void check_is_empty(const std::optional<VtpArray>& array, const std::string& count,
                    const VtpArrays& arrays) {
  if (!array || arrays.is_empty(*array)) return;
  arrays.fail(*array, "holds numbers, but the " + count +
                          " of its Piece is 0 or missing; the file is damaged");
}

void add_points(const VtpPiece& piece, VtpArrays& arrays, const MeshSource& source,
                std::vector<Vec3>& points) {
  if (piece.points == 0) return check_is_empty(piece.coordinates, "NumberOfPoints", arrays);
  if (!piece.coordinates) source.fail("a Piece has no array in its Points; check the export");
  const std::vector<double> numbers = arrays.reals(*piece.coordinates, 3 * piece.points);
  if (numbers.size() / 3 != piece.points || numbers.size() % 3 != 0) {
    arrays.fail(*piece.coordinates, "has " + std::to_string(numbers.size()) +
                                        " numbers, which must be three for each of " +
                                        std::to_string(piece.points) + " points" + cut_short);
  }
  for (std::size_t i = 0; i < numbers.size(); i += 3) {
    points.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
    if (points.back().allFinite()) continue;
    source.fail("point " + std::to_string(points.size() - 1) +
                " has a coordinate that is not finite; repair the mesh and export it again");
  }
}

void add_cells(VtkCellKind kind, const VtpCellArrays& cells, std::uint64_t first,
               std::uint64_t points, VtpArrays& arrays, const MeshSource& source, VtkCells& all) {
  if (cells.count == 0) {
    const bool is_of_polygons = kind == VtkCellKind::polygons;
    return check_is_empty(cells.corners, is_of_polygons ? "NumberOfPolys" : "NumberOfStrips",
                          arrays);
  }
  if (!cells.ends || !cells.corners) {
    source.fail(
        "a Piece has cells, but not both of their arrays, connectivity and offsets; check "
        "the export");
  }
  const std::vector<std::uint64_t> ends = arrays.wholes(*cells.ends, cells.count);
  if (ends.size() != cells.count) {
    arrays.fail(*cells.ends, "has " + std::to_string(ends.size()) + " numbers for " +
                                 std::to_string(cells.count) + " cells" + cut_short);
  }
  all.add(kind, ends, arrays.wholes(*cells.corners, ends.back()), first, points, source);
}

}  // namespace

MeshFile read_vtp(const MeshSource& source) {
  const VtpDocument document = read_vtp_document(source);
  VtpArrays arrays(source, document);
  MeshFile mesh;
  VtkCells cells;
  for (const VtpArray& array : document.spaces) {
    for (const std::string& space : arrays.strings(array)) {
      mesh.comments.push_back("SPACE=" + space);
    }
  }
  for (const VtpPiece& piece : document.pieces) {
    const std::uint64_t first = mesh.surface.vertices.size();
    add_points(piece, arrays, source, mesh.surface.vertices);
    add_cells(VtkCellKind::polygons, piece.polygons, first, piece.points, arrays, source, cells);
    add_cells(VtkCellKind::strips, piece.strips, first, piece.points, arrays, source, cells);
    cells.leave_out(piece.left_out);
  }
  // Pieces share the vertices of a seam, so either all pieces are rounded, or none.
  if (arrays.has_only_floats()) mesh.round_to_floats();
  cells.cut_into(mesh, source);
  return mesh;
}

}  // namespace keepout
