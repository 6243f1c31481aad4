// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "mesh_file.h"
#include "ply_header.h"
#include "text_lines.h"

namespace keepout {

// The values behind the header of a PLY file, one after the other: as text and as bytes. Each
// function throws Error for a file that is damaged, or that ends too early.

inline std::string cut_short(const PlyElement& element) {
  return "the file ends before its last " + element.name +
         ", so it was cut short; copy or export it again";
}

/// An item a line, whose values are its words.
class PlyText {
 public:
  /// `lines` are at the end of the header.
  explicit PlyText(TextLines& lines) : lines_(lines) {}

  /// Comes to the next item of an element, and to its end.
  void begin_item(const PlyElement& element) {
    element_ = &element;
    used_ = 0;
    if (!lines_.next()) fail(cut_short(element));
  }
  void end_item() const {
    if (used_ != lines_.words().size()) {
      fail("more values than the header declares for a " + element_->name);
    }
  }

  /// The next value: a coordinate, or a length or an index.
  double take_real(const PlyScalar& type) {
    const bool is_single = !type.whole && type.size == sizeof(float);
    return is_single ? lines_.number<float>(take_word()) : lines_.coordinate(take_word());
  }
  std::uint64_t take_whole(const PlyScalar&) { return lines_.whole_number(take_word()); }

  /// Passes over values. What they are is no concern of ours.
  void skip(const PlyScalar&, std::uint64_t count) {
    for (std::uint64_t i = 0; i < count; ++i) lines_.number<double>(take_word());
  }

  /// Whether anything follows.
  bool has_more() { return lines_.next(); }

  /// Whether the coordinates are to be rounded to floats.
  bool is_of_floats() const { return lines_.has_only_floats(); }

  [[noreturn]] void fail(const std::string& what) const { lines_.fail(what); }

 private:
  std::string_view take_word() {
    if (used_ == lines_.words().size()) {
      fail("fewer values than the header declares for a " + element_->name +
           "; the file is damaged");
    }
    return lines_.words()[used_++];
  }

  TextLines& lines_;
  const PlyElement* element_ = nullptr;
  std::size_t used_ = 0;
};

/// Bytes of either order. The functions are those of PlyText.
class PlyBytes {
 public:
  /// `source` must outlive this.
  PlyBytes(const MeshSource& source, const PlyHeader& header)
      : source_(source),
        swapped_((header.encoding == PlyEncoding::big_endian) !=
                 (std::endian::native == std::endian::big)),
        position_(header.size) {}

  void begin_item(const PlyElement& element) { element_ = &element; }
  void end_item() const {}
  double take_real(const PlyScalar& type) { return real(take(type.size), type); }
  std::uint64_t take_whole(const PlyScalar& type) {
    const std::int64_t value = whole(take(type.size), type);
    if (value < 0) {
      fail("a negative length or index at a " + element_->name + "; the file is damaged");
    }
    return static_cast<std::uint64_t>(value);
  }
  void skip(const PlyScalar& type, std::uint64_t count) {
    if (count > left() / type.size) fail(cut_short(*element_));
    position_ += count * type.size;
  }
  bool has_more() const { return left() > 0; }
  bool is_of_floats() const { return false; }
  [[noreturn]] void fail(const std::string& what) const { source_.fail(what); }

  // For items that are all of one size, and are read at once.

  /// Bytes from so many behind the next one on.
  std::vector<char> copy(std::uint64_t behind, std::size_t size) const {
    std::vector<char> bytes(size);
    source_.read(position_ + behind, bytes.data(), size);
    return bytes;
  }
  std::uint64_t left() const noexcept { return source_.size() - position_; }
  void move_on(std::uint64_t bytes) noexcept { position_ += bytes; }

  double real(const char* bytes, const PlyScalar& type) const noexcept {
    if (type.whole) return static_cast<double>(whole(bytes, type));
    return type.size == 4 ? double{get<float>(bytes)} : get<double>(bytes);
  }

  std::int64_t whole(const char* bytes, const PlyScalar& type) const noexcept {
    switch (type.size) {
      case 1:
        return type.is_signed ? std::int64_t{get<std::int8_t>(bytes)} : get<std::uint8_t>(bytes);
      case 2:
        return type.is_signed ? std::int64_t{get<std::int16_t>(bytes)} : get<std::uint16_t>(bytes);
      default:
        return type.is_signed ? std::int64_t{get<std::int32_t>(bytes)} : get<std::uint32_t>(bytes);
    }
  }

 private:
  /// The next bytes, up to eight.
  const char* take(std::size_t size) {
    constexpr std::uint64_t at_once = std::uint64_t{1} << 20;
    if (size > left()) fail(cut_short(*element_));
    if (position_ < begin_ || position_ + size > begin_ + buffer_.size()) {
      begin_ = position_;
      buffer_.resize(std::min(at_once, left()));
      if (!source_.try_read(begin_, buffer_.data(), buffer_.size())) fail(cut_short(*element_));
    }
    const char* bytes = buffer_.data() + (position_ - begin_);
    position_ += size;
    return bytes;
  }

  template <class T>
  T get(const char* bytes) const noexcept {
    char ordered[sizeof(T)];
    std::memcpy(ordered, bytes, sizeof(T));
    if (swapped_) std::reverse(ordered, ordered + sizeof(T));
    return std::bit_cast<T>(ordered);
  }

  const MeshSource& source_;
  bool swapped_;
  const PlyElement* element_ = nullptr;
  std::uint64_t position_;
  std::uint64_t begin_ = 0;  // of the buffer, in the file
  std::vector<char> buffer_;
};

}  // namespace keepout
