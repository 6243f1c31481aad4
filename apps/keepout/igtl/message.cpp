// SPDX-License-Identifier: BSD-3-Clause
#include "igtl/message.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace keepout::app::igtl {
namespace {

/// The CRC of each byte.
constexpr std::array<std::uint64_t, 256> crc_table = [] {
  constexpr std::uint64_t polynomial = 0x42F0E1EBA9EA3693;
  std::array<std::uint64_t, 256> table = {};
  for (std::uint64_t byte = 0; byte < table.size(); ++byte) {
    std::uint64_t crc = byte << 56;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 63) != 0 ? (crc << 1) ^ polynomial : crc << 1;
    table[byte] = crc;
  }
  return table;
}();

constexpr double fraction_of_second = 4294967296.0;  // 2^32 units of a time stamp

template <std::size_t Size>
void copy_text(Bytes from, std::array<char, Size>& to) noexcept {
  std::ranges::copy(from, to.begin());
  to.back() = '\0';
}

}  // namespace

std::uint64_t crc64(Bytes bytes, std::uint64_t crc) noexcept {
  for (const std::uint8_t byte : bytes) crc = crc_table[(crc >> 56) ^ byte] ^ (crc << 8);
  return crc;
}

Header read_header(std::span<const std::uint8_t, header_size> bytes) noexcept {
  Reader reader(bytes);
  Header header;
  header.version = reader.number<std::uint16_t>();
  copy_text(reader.take(header.type.size() - 1), header.type);
  copy_text(reader.take(header.device.size() - 1), header.device);
  header.stamp = static_cast<double>(reader.number<std::uint64_t>()) / fraction_of_second;
  header.body_size = reader.number<std::uint64_t>();
  header.crc = reader.number<std::uint64_t>();
  return header;
}

std::optional<Bytes> content_of(const Header& header, Bytes body) noexcept {
  if (header.version < 2) return body;
  constexpr std::size_t least = 12;
  if (body.size() < least) return std::nullopt;
  Reader reader(body);
  const std::size_t extended = reader.number<std::uint16_t>();
  const std::uint64_t around =
      extended + std::uint64_t{reader.number<std::uint16_t>()} + reader.number<std::uint32_t>();
  if (extended < least || around > body.size()) return std::nullopt;
  return body.subspan(extended, body.size() - static_cast<std::size_t>(around));
}

Bytes Reader::take(std::size_t count) noexcept {
  const Bytes taken = left_.first(count);
  left_ = left_.subspan(count);
  return taken;
}

double Reader::real() noexcept {
  return static_cast<double>(std::bit_cast<float>(number<std::uint32_t>()));
}

Writer::Writer(ByteList& out, std::string_view type, std::string_view device, double stamp)
    : out_(out), begin_(out.size()) {
  number(std::uint16_t{1});
  text(type, 12);
  text(device, 20);
  number(static_cast<std::uint64_t>(std::floor(stamp * fraction_of_second)));
  number(std::uint64_t{0});  // size and CRC are written by finish()
  number(std::uint64_t{0});
}

void Writer::real(double value) { number(std::bit_cast<std::uint32_t>(static_cast<float>(value))); }

void Writer::text(std::string_view text) { out_.insert(out_.end(), text.begin(), text.end()); }

void Writer::text(std::string_view text, std::size_t size) {
  this->text(text.substr(0, size));
  out_.insert(out_.end(), size - std::min(size, text.size()), std::uint8_t{0});
}

void Writer::finish() {
  const Bytes body = Bytes(out_).subspan(begin_ + header_size);
  const auto write_at = [this](std::size_t at, std::uint64_t value) {
    for (std::size_t i = 0; i < 8; ++i) {
      out_[begin_ + at + i] = static_cast<std::uint8_t>(value >> (56 - 8 * i));
    }
  };
  write_at(42, body.size());
  write_at(50, crc64(body));
}

}  // namespace keepout::app::igtl
