// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace keepout::test::igtl {

/// A client made with the OpenIGTLink library. Its headers stay in one source, because they are not
/// ours.
class LibraryPeer {
 public:
  using Matrix = std::array<std::array<float, 4>, 4>;  // rows
  using Point = std::array<float, 3>;
  enum class Stamp { none, now };

  /// The contents of a message, as the library reads it.
  struct Message {
    std::string type, device;
    Matrix matrix = {};
    int code = 0;
    std::string name, text;     // of a STATUS
    std::vector<Point> points;  // of a POLYDATA
    std::vector<std::array<std::uint32_t, 3>> triangles = {};
  };

  /// Connects to the server on this machine. Throws std::runtime_error.
  explicit LibraryPeer(std::uint16_t port);
  ~LibraryPeer();
  LibraryPeer(LibraryPeer&&) noexcept;
  LibraryPeer& operator=(LibraryPeer&&) noexcept;

  void send_transform(const std::string& device, const Matrix& matrix, Stamp stamp = Stamp::none);
  void send_string(const std::string& text);
  void send_points(const std::string& device, const std::vector<Point>& points);
  void send_polydata(const std::vector<Point>& points,
                     const std::vector<std::array<std::uint32_t, 3>>& triangles);

  /// Returns the next message, whose CRC the library has checked. Throws std::runtime_error if none
  /// comes.
  Message receive();
  /// Returns the next message of this device, and skips others.
  Message receive(const std::string& device);

  /// Returns the bytes of a TRANSFORM that the library packs. The time stamp is 1.5 s.
  static std::vector<std::uint8_t> packed_transform(const std::string& device,
                                                    const Matrix& matrix);

 private:
  struct Socket;
  std::unique_ptr<Socket> socket_;
};

}  // namespace keepout::test::igtl
