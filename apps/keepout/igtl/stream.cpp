// SPDX-License-Identifier: BSD-3-Clause
#include "igtl/stream.h"

#include <algorithm>

namespace keepout::app::igtl {
namespace {

constexpr std::size_t longest_kept = std::size_t{1} << 18;  // memory kept between messages [bytes]

}  // namespace

MessageStream::Event MessageStream::next(Bytes& received) {
  if (is_broken_) return Event::broken;
  if (!is_in_body_) {
    const std::size_t taken = std::min(header_size - header_bytes_, received.size());
    std::copy_n(received.begin(), taken, raw_header_.begin() + header_bytes_);
    received = received.subspan(taken);
    header_bytes_ += taken;
    if (header_bytes_ < header_size) return Event::needs_more;
    header_ = read_header(raw_header_);
    is_broken_ = header_.version == 0 || header_.version > newest_version ||
                 header_.body_size > longest_body_;
    if (is_broken_) return Event::broken;
    if (body_.capacity() > longest_kept) body_ = {};  // of a mesh that was refused
    body_.clear();
    left_ = header_.body_size;
    crc_ = 0;
    is_in_body_ = true;
    is_stored_ = false;
    return Event::header;
  }
  const Bytes part =
      received.first(static_cast<std::size_t>(std::min<std::uint64_t>(left_, received.size())));
  received = received.subspan(part.size());
  left_ -= part.size();
  crc_ = crc64(part, crc_);
  if (is_stored_) body_.insert(body_.end(), part.begin(), part.end());
  if (left_ > 0) return Event::needs_more;
  is_in_body_ = false;
  header_bytes_ = 0;
  return Event::message;
}

}  // namespace keepout::app::igtl
