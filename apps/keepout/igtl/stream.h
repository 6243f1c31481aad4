// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "igtl/message.h"

namespace keepout::app::igtl {

/// Cuts the bytes that one peer sends into messages. The bytes may come in pieces of any size. A
/// body is stored only if the caller asks for it after its header, so that a declared size costs no
/// memory; other bodies are skipped.
class MessageStream {
 public:
  enum class Event : std::uint8_t {
    needs_more,  // all bytes are used
    header,      // header() is complete: call store_body() to read the body
    message,     // the message is complete
    broken       // unknown version, or a body longer than the longest: no more bytes are read
  };

  /// `longest_body`: of any message [bytes].
  explicit MessageStream(std::size_t longest_body) noexcept : longest_body_(longest_body) {}

  /// Uses bytes up to the next event, and removes them from the front of `received`.
  Event next(Bytes& received);

  /// Stores the body of the message whose header has just come. Allocates the declared size.
  void store_body() {
    is_stored_ = true;
    body_.reserve(static_cast<std::size_t>(header_.body_size));
  }

  /// Returns the header of this message; valid until the next header.
  const Header& header() const noexcept { return header_; }
  /// Returns true if the body of this message is stored.
  bool is_stored() const noexcept { return is_stored_; }
  /// Returns true if the body has the declared CRC.
  bool is_intact() const noexcept { return crc_ == header_.crc; }
  /// Returns the body of this message; empty if it is not stored.
  Bytes body() const noexcept { return body_; }
  /// Returns the body of this message, and releases its memory here.
  ByteList take_body() noexcept { return std::exchange(body_, {}); }

 private:
  std::size_t longest_body_;
  std::array<std::uint8_t, header_size> raw_header_ = {};
  std::size_t header_bytes_ = 0;  // received
  Header header_;
  ByteList body_;
  std::uint64_t left_ = 0;  // of the body [bytes]
  std::uint64_t crc_ = 0;   // of the received part of the body
  bool is_in_body_ = false;
  bool is_stored_ = false;
  bool is_broken_ = false;
};

}  // namespace keepout::app::igtl
