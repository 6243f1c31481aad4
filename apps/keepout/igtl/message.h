// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace keepout::app::igtl {

// Messages of OpenIGTLink: a header of 58 bytes and a body. All numbers are big-endian. Source of
// all formats: openigtlink.org, protocol versions 1 to 3.

using Bytes = std::span<const std::uint8_t>;
using ByteList = std::vector<std::uint8_t>;

inline constexpr std::size_t header_size = 58;
/// The largest header version that is read. From 2 on, a body has an extended header and metadata.
inline constexpr std::uint16_t newest_version = 2;

/// The header of a message.
struct Header {
  std::uint16_t version = 1;         // of the format of the header
  std::array<char, 13> type = {};    // for example "TRANSFORM"; ends with 0
  std::array<char, 21> device = {};  // the name of the sender's object; ends with 0
  double stamp = 0.0;                // Unix time; 0: not stated [s]
  std::uint64_t body_size = 0;       // as declared [bytes]
  std::uint64_t crc = 0;             // of the body, as declared

  std::string_view type_name() const noexcept { return type.data(); }
  std::string_view device_name() const noexcept { return device.data(); }
};

/// Returns the CRC-64 of ECMA-182 of bytes. `crc`: of the bytes before them, 0 at the beginning.
std::uint64_t crc64(Bytes bytes, std::uint64_t crc = 0) noexcept;

/// Returns the header of a message. Any bytes are a header; nothing in it is checked.
Header read_header(std::span<const std::uint8_t, header_size> bytes) noexcept;

/// Returns the content of a body, without extended header and metadata. Empty if their declared
/// sizes exceed the body.
std::optional<Bytes> content_of(const Header& header, Bytes body) noexcept;

/// Reads numbers from bytes.
class Reader {
 public:
  explicit Reader(Bytes bytes) noexcept : left_(bytes) {}

  /// Returns the number of bytes that are left.
  std::size_t left() const noexcept { return left_.size(); }
  /// Returns the next bytes. Precondition: count <= left().
  Bytes take(std::size_t count) noexcept;
  /// Returns the next number. Precondition: its size <= left().
  template <std::unsigned_integral Number>
  Number number() noexcept {
    std::uint64_t value = 0;
    for (const std::uint8_t byte : take(sizeof(Number))) value = (value << 8) | byte;
    return static_cast<Number>(value);
  }
  /// Returns the next float. Precondition: left() >= 4.
  double real() noexcept;

 private:
  Bytes left_;
};

/// Writes one message at the end of a list. Allocates only if the capacity of the list is too
/// small.
class Writer {
 public:
  /// Begins a message. Longer names are cut to 12 and 20 bytes. `stamp`: Unix time [s].
  Writer(ByteList& out, std::string_view type, std::string_view device, double stamp);

  template <std::unsigned_integral Number>
  void number(Number value) {
    for (std::size_t i = sizeof(Number); i-- > 0;) {
      out_.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i)));
    }
  }
  /// Writes the nearest float.
  void real(double value);
  /// Writes a text.
  void text(std::string_view text);
  /// Writes a text of a fixed size: cut, or filled with zeros.
  void text(std::string_view text, std::size_t size);

  /// Ends the message: writes the size and the CRC of the body into the header.
  void finish();

 private:
  ByteList& out_;
  std::size_t begin_;
};

}  // namespace keepout::app::igtl
