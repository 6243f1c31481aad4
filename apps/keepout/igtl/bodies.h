// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "igtl/message.h"
#include "keepout/geometry/pose.h"

namespace keepout::app::igtl {

// The contents of the small messages. POLYDATA: see polydata.h.

inline constexpr std::size_t transform_size = 48;    // [bytes]
inline constexpr std::size_t longest_string = 1024;  // [bytes]
inline constexpr std::size_t point_size = 136;       // of each point [bytes]
inline constexpr std::size_t most_points = 1000;     // in one message

/// Codes of a STATUS message.
enum class StatusCode : std::uint16_t {
  ok = 1,
  unknown_error = 2,
  access_denied = 5,
  busy = 6,
  time_out = 7,
  overflow = 8,
  checksum_error = 9,
  config_error = 10,
  unknown_instruction = 12,
  not_ready = 13,
  disabled = 15,
  unknown_version = 17,
  shut_down = 19
};

/// Returns the pose of a TRANSFORM; empty for another size. The numbers are not checked.
std::optional<Pose> read_transform(Bytes content) noexcept;

/// Returns the text of a STRING; empty for another size. The view is one of the content.
std::optional<std::string_view> read_string(Bytes content) noexcept;

/// Returns the positions of a POINT message; empty for another size, or for more than most_points.
/// The numbers are not checked.
std::optional<std::vector<Vec3>> read_points(Bytes content);

/// Appends a TRANSFORM message. The numbers are rounded to floats.
void write_transform(ByteList& out, std::string_view device, double stamp, const Pose& pose);

/// Appends a STATUS message. `name`: at most 20 bytes.
void write_status(ByteList& out, std::string_view device, double stamp, StatusCode code,
                  std::uint64_t subcode, std::string_view name, std::string_view text);

}  // namespace keepout::app::igtl
