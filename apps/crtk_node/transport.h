// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// This header is C++17, because the headers of ROS 1 messages do not compile as C++20.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace keepout::crtk {

/// The type of a topic's messages.
enum class Kind : std::uint8_t {
  pose,    // geometry_msgs/PoseStamped
  joints,  // sensor_msgs/JointState
  wrench,  // geometry_msgs/WrenchStamped; only sent
  state,   // crtk_msgs/operating_state in ROS 1, crtk_msgs/OperatingState in ROS 2
  flag,    // std_msgs/Bool
  text,    // std_msgs/String
  shape    // visualization_msgs/Marker; only sent, and only in ROS 1
};

/// The numbers of a message, which the message does not own.
struct Numbers {
  const double* data = nullptr;
  std::size_t size = 0;
};

/// The names of a message's joints, which the message does not own.
struct Names {
  std::array<std::string_view, 8> first = {};  // the first ones: no chain has more joints
  std::size_t count = 0;                       // of all; 0: not stated
};

/// The values of a message, for all kinds: each kind uses the members that its comment names. Views
/// are valid until the function that receives them returns. Lengths are in meters.
struct Message {
  double stamp = 0.0;                   // all but flag and text: seconds since 1970; 0: invalid
  std::string_view frame = {};          // all but flag and text
  std::array<double, 3> vector = {};    // pose: position; wrench: force [N]
  std::array<double, 4> rotation = {};  // pose: quaternion x, y, z, w
  Names names = {};                     // joints
  Numbers positions = {};               // joints [rad or m]
  Numbers velocities = {};              // joints [rad/s or m/s]
  std::string_view text = {};           // state: its name; text
  bool flag = false;                    // flag; state: true if the robot is homed
};

/// A shape to draw, in the robot's frame.
struct Shape {
  enum class Form : std::uint8_t { triangles, lines };

  Form form = Form::triangles;                     // each three points, or each two
  const char* name = "";                           // a shape replaces the last one of this name
  std::array<float, 4> color = {};                 // red, green, blue, opacity: 0 to 1
  std::vector<std::array<double, 3>> points = {};  // [m]
};

/// Receives the messages of subscribed topics.
class Inbox {
 public:
  virtual ~Inbox() = default;
  /// Receives a message. `topic`: what Transport::subscribe returned.
  virtual void receive(int topic, const Message& message) = 0;
};

/// A middleware with topics. After the topics are known, one thread receives and others may send.
class Transport {
 public:
  virtual ~Transport() = default;

  /// Subscribes to a topic. Returns its number, from 0 on. Throws std::runtime_error.
  virtual int subscribe(const std::string& topic, Kind kind) = 0;
  /// Announces a topic. Returns its number, from 0 on. `is_kept`: a later subscriber gets the last
  /// message. Throws std::runtime_error.
  virtual int advertise(const std::string& topic, Kind kind, bool is_kept = false) = 0;

  /// Passes on the messages that have arrived, at most ten of each topic. `wait`: how long to wait
  /// for the first message [s].
  virtual void deliver(Inbox& inbox, double wait = 0.0) = 0;
  /// Sends a message, without waiting for a reader: a slow reader loses messages. Returns false if
  /// the message was dropped here.
  virtual bool send(int topic, const Message& message) = 0;
  /// Sends a shape, if the middleware has shapes.
  virtual void show(int, const std::string& /*frame*/, const Shape&) {}

  /// Returns the number of publishers of a subscribed topic in other processes. A process must
  /// subscribe to a topic before it announces the same topic.
  virtual int publishers(int subscription) = 0;
  /// Returns true if a process reads an announced topic.
  virtual bool is_read(int advertised) = 0;
};

/// Connects a program to its middleware. Removes the arguments of the middleware from `arguments`,
/// and adds those that the middleware has as parameters. `names`: of the program's options, without
/// dashes. Throws std::runtime_error, which says what to do, if there is no middleware.
std::unique_ptr<Transport> connect(std::vector<std::string>& arguments,
                                   const std::vector<std::string>& names);

/// The program's name, for messages: "keepout-ros1-node".
extern const char* const program_name;
/// A sentence on the middleware, for the help.
extern const char* const program_help;

}  // namespace keepout::crtk
