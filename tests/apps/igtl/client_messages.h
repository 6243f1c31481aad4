// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "igtl/bodies.h"
#include "igtl/message.h"
#include "keepout/mesh/mesh.h"

namespace keepout::test::igtl {

using namespace app::igtl;

// Messages of a client, made with our codec, and wrong ones.

inline ByteList transform(const Pose& pose, std::string_view device = "Tool", double stamp = 0.0) {
  ByteList out;
  write_transform(out, device, stamp, pose);
  return out;
}

inline ByteList transform(const Vec3& tip) { return transform(Pose{.position = tip}); }

inline ByteList string_message(std::string_view text) {
  ByteList out;
  Writer writer(out, "STRING", "Command", 0.0);
  writer.number(std::uint16_t{3});
  writer.number(static_cast<std::uint16_t>(text.size()));
  writer.text(text);
  writer.finish();
  return out;
}

inline ByteList point_message(std::string_view device, std::span<const Vec3> points) {
  ByteList out;
  Writer writer(out, "POINT", device, 0.0);
  for (const Vec3& point : points) {
    writer.text("F", 64 + 32 + 4);
    for (const double x : point) writer.real(x);
    writer.text("", 4 + 20);
  }
  writer.finish();
  return out;
}

/// Returns a message with any body.
inline ByteList message(std::string_view type, std::string_view device, Bytes body) {
  ByteList out;
  Writer writer(out, type, device, 0.0);
  for (const std::uint8_t byte : body) writer.number(byte);
  writer.finish();
  return out;
}

/// Returns a POLYDATA message of a surface. Every second triangle is a strip if `has_strips`.
inline ByteList polydata(const Surface& surface, bool has_strips = false) {
  std::vector<Corners> polygons;
  std::vector<Corners> strips;
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    (has_strips && i % 2 == 1 ? strips : polygons).push_back(surface.triangles[i]);
  }
  ByteList out;
  Writer writer(out, "POLYDATA", "Model", 0.0);
  const auto count = [](const auto& list) { return static_cast<std::uint32_t>(list.size()); };
  for (const std::uint32_t size : {count(surface.vertices), 0u, 0u, 0u, 0u, count(polygons),
                                   16 * count(polygons), count(strips), 16 * count(strips), 0u}) {
    writer.number(size);
  }
  for (const Vec3& vertex : surface.vertices) {
    for (const double x : vertex) writer.real(x);
  }
  for (const auto* list : {&polygons, &strips}) {
    for (const Corners& corners : *list) {
      writer.number(std::uint32_t{3});
      for (const VertexId corner : corners) writer.number(corner);
    }
  }
  writer.finish();
  return out;
}

/// Writes another number into the header: at 0 the version, at 42 the size and at 50 the CRC.
inline ByteList changed(ByteList message, std::size_t at, std::size_t size, std::uint64_t value) {
  for (std::size_t i = 0; i < size; ++i) {
    message[at + i] = static_cast<std::uint8_t>(value >> (8 * (size - 1 - i)));
  }
  return message;
}

inline ByteList joined(ByteList one, const ByteList& other) {
  one.insert(one.end(), other.begin(), other.end());
  return one;
}

/// Returns a rotation whose elements are floats only by rounding.
inline Mat3 turned(double angle) {
  Mat3 rotation;
  rotation << std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle), 0, 0, 0, 1;
  return rotation;
}

}  // namespace keepout::test::igtl
