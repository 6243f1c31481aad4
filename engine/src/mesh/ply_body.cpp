// SPDX-License-Identifier: BSD-3-Clause
#include "ply_body.h"

namespace keepout {

void PlyText::begin_item(const PlyElement& element) {
  PlyBody::begin_item(element);
  used_ = 0;
  if (!lines_.next()) fail_cut_short();
}

void PlyText::end_item() {
  if (used_ != lines_.words().size()) {
    fail("more values than the header declares for a " + element_->name);
  }
}

std::string_view PlyText::take_word() {
  if (used_ == lines_.words().size()) {
    fail("fewer values than the header declares for a " + element_->name + "; the file is damaged");
  }
  return lines_.words()[used_++];
}

double PlyText::take_real(const PlyScalar& type) {
  const bool is_single = !type.whole && type.size == sizeof(float);
  return is_single ? lines_.number<float>(take_word()) : lines_.coordinate(take_word());
}

void PlyText::skip(const PlyScalar&, std::uint64_t count) {
  for (std::uint64_t i = 0; i < count; ++i) lines_.number<double>(take_word());
}

PlyBytes::PlyBytes(const ReadOnlyFile& file, const std::string& name, const PlyHeader& header)
    : file_(file),
      name_(name),
      swapped_((header.encoding == PlyEncoding::big_endian) !=
               (std::endian::native == std::endian::big)),
      position_(header.size) {
  if (!file_.is_open()) fail("cannot be opened; check the name and the permissions");
  if (file_.size() < header.size) fail("was changed while it was read; read it again");
}

const char* PlyBytes::take(std::size_t size) {
  constexpr std::uint64_t at_once = std::uint64_t{1} << 20;
  if (size > left()) fail_cut_short();
  if (position_ < begin_ || position_ + size > begin_ + buffer_.size()) {
    begin_ = position_;
    buffer_.resize(std::min(at_once, left()));
    if (!file_.read(begin_, buffer_.data(), buffer_.size())) fail_cut_short();
  }
  const char* bytes = buffer_.data() + (position_ - begin_);
  position_ += size;
  return bytes;
}

std::vector<char> PlyBytes::copy(std::uint64_t behind, std::size_t size) const {
  std::vector<char> bytes(size);
  if (!file_.read(position_ + behind, bytes.data(), size)) {
    fail("cannot be read to its end; check the disk");
  }
  return bytes;
}

std::uint64_t PlyBytes::take_whole(const PlyScalar& type) {
  const std::int64_t value = whole(take(type.size), type);
  if (value < 0) {
    fail("a negative length or index at a " + element_->name + "; the file is damaged");
  }
  return static_cast<std::uint64_t>(value);
}

void PlyBytes::skip(const PlyScalar& type, std::uint64_t count) {
  if (count > left() / type.size) fail_cut_short();
  position_ += count * type.size;
}

}  // namespace keepout
