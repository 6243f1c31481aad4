// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "../read_only_file.h"
#include "keepout/error.h"
#include "ply_header.h"
#include "text_lines.h"

namespace keepout {

/// The values behind the header of a PLY file, one after the other. Each function throws Error for
/// a file that is damaged, or that ends too early.
class PlyBody {
 public:
  virtual ~PlyBody() = default;

  /// Comes to the next item of an element, and to its end.
  virtual void begin_item(const PlyElement& element) { element_ = &element; }
  virtual void end_item() {}

  /// The next value: a coordinate, or a length or an index.
  virtual double take_real(const PlyScalar& type) = 0;
  virtual std::uint64_t take_whole(const PlyScalar& type) = 0;

  /// Passes over values. What they are is no concern of ours.
  virtual void skip(const PlyScalar& type, std::uint64_t count) = 0;

  /// Whether anything follows.
  virtual bool has_more() = 0;

  /// Whether the coordinates are to be rounded to floats.
  virtual bool is_of_floats() const { return false; }

  [[noreturn]] void fail(const std::string& what) const { throw Error(place() + ": " + what); }

 protected:
  /// The file, and how far it was read where it has lines.
  virtual std::string place() const = 0;

  [[noreturn]] void fail_cut_short() const {
    fail("the file ends before its last " + element_->name +
         ", so it was cut short; copy or export it again");
  }

  const PlyElement* element_ = nullptr;
};

/// An item a line, whose values are its words.
class PlyText final : public PlyBody {
 public:
  /// `lines` are at the end of the header.
  explicit PlyText(TextLines& lines) : lines_(lines) {}

  void begin_item(const PlyElement& element) override;
  void end_item() override;
  double take_real(const PlyScalar& type) override;
  std::uint64_t take_whole(const PlyScalar&) override { return lines_.whole_number(take_word()); }
  void skip(const PlyScalar& type, std::uint64_t count) override;
  bool has_more() override { return lines_.next(); }
  bool is_of_floats() const override { return lines_.has_only_floats(); }

 private:
  std::string place() const override { return lines_.place(); }
  std::string_view take_word();

  TextLines& lines_;
  std::size_t used_ = 0;
};

/// Bytes of either order.
class PlyBytes final : public PlyBody {
 public:
  /// `file` and `name`, which names it in errors, must outlive this.
  PlyBytes(const ReadOnlyFile& file, const std::string& name, const PlyHeader& header);

  double take_real(const PlyScalar& type) override { return real(take(type.size), type); }
  std::uint64_t take_whole(const PlyScalar& type) override;
  void skip(const PlyScalar& type, std::uint64_t count) override;
  bool has_more() override { return left() > 0; }

  // For items that are all of one size, and are read at once.

  /// Bytes from so many behind the next one on.
  std::vector<char> copy(std::uint64_t behind, std::size_t size) const;
  std::uint64_t left() const noexcept { return file_.size() - position_; }
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
  std::string place() const override { return name_; }
  /// The next bytes, up to eight.
  const char* take(std::size_t size);

  template <class T>
  T get(const char* bytes) const noexcept {
    char ordered[sizeof(T)];
    std::memcpy(ordered, bytes, sizeof(T));
    if (swapped_) std::reverse(ordered, ordered + sizeof(T));
    return std::bit_cast<T>(ordered);
  }

  const ReadOnlyFile& file_;
  const std::string& name_;
  bool swapped_;
  std::uint64_t position_;
  std::uint64_t begin_ = 0;  // of the buffer, in the file
  std::vector<char> buffer_;
};

}  // namespace keepout
