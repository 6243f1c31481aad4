// SPDX-License-Identifier: BSD-3-Clause
#include "igtl/bodies.h"

namespace keepout::app::igtl {

std::optional<Pose> read_transform(Bytes content) noexcept {
  if (content.size() != transform_size) return std::nullopt;
  Reader reader(content);
  Pose pose;
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) pose.rotation(row, column) = reader.real();
  }
  for (double& x : pose.position) x = reader.real();
  return pose;
}

std::optional<std::string_view> read_string(Bytes content) noexcept {
  if (content.size() < 4) return std::nullopt;
  Reader reader(content);
  reader.number<std::uint16_t>();  // the encoding: all commands are ASCII
  const std::size_t size = reader.number<std::uint16_t>();
  if (size != reader.left()) return std::nullopt;
  const Bytes text = reader.take(size);
  return std::string_view(reinterpret_cast<const char*>(text.data()), text.size());
}

std::optional<std::vector<Vec3>> read_points(Bytes content) {
  const std::size_t count = content.size() / point_size;
  if (content.size() != count * point_size || count > most_points) return std::nullopt;
  std::vector<Vec3> points(count);
  Reader reader(content);
  for (Vec3& point : points) {
    reader.take(64 + 32 + 4);  // name, group, color
    for (double& x : point) x = reader.real();
    reader.take(4 + 20);  // diameter, owner
  }
  return points;
}

void write_transform(ByteList& out, std::string_view device, double stamp, const Pose& pose) {
  Writer writer(out, "TRANSFORM", device, stamp);
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) writer.real(pose.rotation(row, column));
  }
  for (const double x : pose.position) writer.real(x);
  writer.finish();
}

void write_status(ByteList& out, std::string_view device, double stamp, StatusCode code,
                  std::uint64_t subcode, std::string_view name, std::string_view text) {
  Writer writer(out, "STATUS", device, stamp);
  writer.number(static_cast<std::uint16_t>(code));
  writer.number(subcode);
  writer.text(name, 20);
  writer.text(text);
  writer.number(std::uint8_t{0});
  writer.finish();
}

}  // namespace keepout::app::igtl
