// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/message_traits.h>
#include <ros/serialization.h>
#include <std_msgs/Header.h>

#include <cstdint>
#include <string>

// The message crtk_msgs/operating_state of CRTK, which Debian does not have.

namespace crtk_msgs {

struct operating_state {
  std_msgs::Header header;
  std::string state;
  std::uint8_t is_homed = 0;
  std::uint8_t is_busy = 0;
};

}  // namespace crtk_msgs

namespace ros {
namespace message_traits {

template <>
struct IsMessage<crtk_msgs::operating_state> : TrueType {};
template <>
struct HasHeader<crtk_msgs::operating_state> : TrueType {};

template <>
struct DataType<crtk_msgs::operating_state> {
  static const char* value() { return "crtk_msgs/operating_state"; }
  static const char* value(const crtk_msgs::operating_state&) { return value(); }
};

template <>
struct MD5Sum<crtk_msgs::operating_state> {
  // The sum of the fields; genpy computes the same sum (tests/apps/crtk_node/test_ros1_node.py).
  static const char* value() { return "b1bd4021639d9d9c5fbfff78d6ff3158"; }
  static const char* value(const crtk_msgs::operating_state&) { return value(); }
};

template <>
struct Definition<crtk_msgs::operating_state> {
  static const char* value() {
    return "std_msgs/Header header\n"
           "string state\n"
           "bool is_homed\n"
           "bool is_busy\n"
           "\n"
           "================================================================================\n"
           "MSG: std_msgs/Header\n"
           "uint32 seq\n"
           "time stamp\n"
           "string frame_id\n";
  }
  static const char* value(const crtk_msgs::operating_state&) { return value(); }
};

}  // namespace message_traits

namespace serialization {

template <>
struct Serializer<crtk_msgs::operating_state> {
  template <typename Stream, typename T>
  static void allInOne(Stream& stream, T message) {
    stream.next(message.header);
    stream.next(message.state);
    stream.next(message.is_homed);
    stream.next(message.is_busy);
  }
  ROS_DECLARE_ALLINONE_SERIALIZER
};

}  // namespace serialization
}  // namespace ros
