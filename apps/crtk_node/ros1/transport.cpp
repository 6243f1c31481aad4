// SPDX-License-Identifier: BSD-3-Clause
// The transport of ROS 1. C++17: the headers of the messages do not compile as C++20.
#include "transport.h"

#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/WrenchStamped.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>
#include <std_msgs/Bool.h>
#include <std_msgs/String.h>
#include <visualization_msgs/Marker.h>
#include <xmlrpcpp/XmlRpcValue.h>

#include <algorithm>
#include <cstdlib>
#include <stdexcept>
#include <tuple>

#include "ros1/operating_state.h"

namespace keepout::crtk {
namespace {

constexpr int queue_length = 10;

Numbers numbers_of(const std::vector<double>& numbers) { return {numbers.data(), numbers.size()}; }

template <class M>
Message stamped(const M& message) {
  Message values;
  values.stamp = message.header.stamp.toSec();
  values.frame = message.header.frame_id;
  return values;
}

// Each message of ROS as a Message.

Message values_of(const geometry_msgs::PoseStamped& message) {
  Message values = stamped(message);
  const auto& [at, to] = std::tie(message.pose.position, message.pose.orientation);
  values.vector = {at.x, at.y, at.z};
  values.rotation = {to.x, to.y, to.z, to.w};
  return values;
}

Message values_of(const sensor_msgs::JointState& message) {
  Message values = stamped(message);
  values.names.count = message.name.size();
  const std::size_t known = std::min(message.name.size(), values.names.first.size());
  std::copy_n(message.name.begin(), known, values.names.first.begin());
  values.positions = numbers_of(message.position);
  values.velocities = numbers_of(message.velocity);
  return values;
}

Message values_of(const crtk_msgs::operating_state& message) {
  Message values = stamped(message);
  values.text = message.state;
  values.flag = message.is_homed != 0;
  return values;
}

Message values_of(const std_msgs::Bool& message) {
  Message values;
  values.flag = message.data != 0;
  return values;
}

Message values_of(const std_msgs::String& message) {
  Message values;
  values.text = message.data;
  return values;
}

// Each Message as a message of ROS.

template <class M>
M with_header(const Message& values) {
  M message;
  message.header.stamp = ros::Time(values.stamp);
  message.header.frame_id = std::string(values.frame);
  return message;
}

geometry_msgs::PoseStamped pose_of(const Message& values) {
  auto message = with_header<geometry_msgs::PoseStamped>(values);
  message.pose.position.x = values.vector[0];
  message.pose.position.y = values.vector[1];
  message.pose.position.z = values.vector[2];
  message.pose.orientation.x = values.rotation[0];
  message.pose.orientation.y = values.rotation[1];
  message.pose.orientation.z = values.rotation[2];
  message.pose.orientation.w = values.rotation[3];
  return message;
}

sensor_msgs::JointState joints_of(const Message& values) {
  auto message = with_header<sensor_msgs::JointState>(values);
  const auto& names = values.names.first;
  message.name.assign(names.begin(), names.begin() + values.names.count);
  message.position.assign(values.positions.data, values.positions.data + values.positions.size);
  message.velocity.assign(values.velocities.data, values.velocities.data + values.velocities.size);
  return message;
}

geometry_msgs::WrenchStamped wrench_of(const Message& values) {
  auto message = with_header<geometry_msgs::WrenchStamped>(values);
  message.wrench.force.x = values.vector[0];
  message.wrench.force.y = values.vector[1];
  message.wrench.force.z = values.vector[2];
  return message;
}

crtk_msgs::operating_state state_of(const Message& values) {
  auto message = with_header<crtk_msgs::operating_state>(values);
  message.state = std::string(values.text);
  message.is_homed = values.flag;
  return message;
}

std_msgs::Bool flag_of(const Message& values) {
  std_msgs::Bool message;
  message.data = values.flag;
  return message;
}

std_msgs::String text_of(const Message& values) {
  std_msgs::String message;
  message.data = std::string(values.text);
  return message;
}

class Ros1Transport final : public Transport {
 public:
  Ros1Transport() { node_.setCallbackQueue(&queue_); }
  ~Ros1Transport() override { ros::shutdown(); }

  int subscribe(const std::string& topic, Kind kind) override {
    switch (kind) {
      case Kind::pose:
        return subscribe<geometry_msgs::PoseStamped>(topic);
      case Kind::joints:
        return subscribe<sensor_msgs::JointState>(topic);
      case Kind::state:
        return subscribe<crtk_msgs::operating_state>(topic);
      case Kind::flag:
        return subscribe<std_msgs::Bool>(topic);
      case Kind::text:
        return subscribe<std_msgs::String>(topic);
      default:
        throw std::runtime_error(topic + ": only sent");
    }
  }

  int advertise(const std::string& topic, Kind kind, bool is_kept) override {
    const auto announce = [&](auto message) {
      announced_.push_back(
          {node_.advertise<decltype(message)>(topic, queue_length, is_kept), kind});
    };
    switch (kind) {
      case Kind::pose:
        announce(geometry_msgs::PoseStamped());
        break;
      case Kind::joints:
        announce(sensor_msgs::JointState());
        break;
      case Kind::wrench:
        announce(geometry_msgs::WrenchStamped());
        break;
      case Kind::state:
        announce(crtk_msgs::operating_state());
        break;
      case Kind::flag:
        announce(std_msgs::Bool());
        break;
      case Kind::text:
        announce(std_msgs::String());
        break;
      case Kind::shape:
        announce(visualization_msgs::Marker());
        break;
    }
    for (Subscribed& subscribed : subscribed_) {
      const bool is_own =
          subscribed.subscriber.getTopic() == announced_.back().publisher.getTopic();
      if (is_own) ++subscribed.own;
    }
    return static_cast<int>(announced_.size()) - 1;
  }

  void deliver(Inbox& inbox, double wait) override {
    inbox_ = &inbox;
    queue_.callAvailable(ros::WallDuration(wait));
  }

  bool send(int topic, const Message& values) override {
    const auto& [publisher, kind] = announced_[static_cast<std::size_t>(topic)];
    switch (kind) {
      case Kind::pose:
        publisher.publish(pose_of(values));
        return true;
      case Kind::joints:
        publisher.publish(joints_of(values));
        return true;
      case Kind::wrench:
        publisher.publish(wrench_of(values));
        return true;
      case Kind::state:
        publisher.publish(state_of(values));
        return true;
      case Kind::flag:
        publisher.publish(flag_of(values));
        return true;
      case Kind::text:
        publisher.publish(text_of(values));
        return true;
      case Kind::shape:
        break;
    }
    return false;
  }

  void show(int topic, const std::string& frame, const Shape& shape) override {
    using visualization_msgs::Marker;
    const bool is_list = shape.form == Shape::Form::triangles;
    Marker marker;
    marker.header.frame_id = frame;
    marker.ns = shape.name;
    marker.type = is_list ? Marker::TRIANGLE_LIST : Marker::LINE_LIST;
    marker.action = shape.points.empty() ? Marker::DELETE : Marker::ADD;
    marker.pose.orientation.w = 1.0;
    // The scale of triangles, or the width of lines [m].
    marker.scale.x = marker.scale.y = marker.scale.z = is_list ? 1.0 : 0.0005;
    marker.color.r = shape.color[0];
    marker.color.g = shape.color[1];
    marker.color.b = shape.color[2];
    marker.color.a = shape.color[3];
    marker.points.resize(shape.points.size());
    for (std::size_t k = 0; k < shape.points.size(); ++k) {
      marker.points[k].x = shape.points[k][0];
      marker.points[k].y = shape.points[k][1];
      marker.points[k].z = shape.points[k][2];
    }
    announced_[static_cast<std::size_t>(topic)].publisher.publish(marker);
  }

  int publishers(int subscription) override {
    const Subscribed& subscribed = subscribed_[static_cast<std::size_t>(subscription)];
    return static_cast<int>(subscribed.subscriber.getNumPublishers()) - subscribed.own;
  }

  bool is_read(int advertised) override {
    return announced_[static_cast<std::size_t>(advertised)].publisher.getNumSubscribers() > 0;
  }

 private:
  struct Announced {
    ros::Publisher publisher;
    Kind kind;
  };
  struct Subscribed {
    ros::Subscriber subscriber;
    int own = 0;  // publishers in this process, which announces after it subscribes
  };

  template <class M>
  int subscribe(const std::string& topic) {
    const int number = static_cast<int>(subscribed_.size());
    const boost::function<void(const boost::shared_ptr<const M>&)> pass_on =
        [this, number](const boost::shared_ptr<const M>& message) {
          inbox_->receive(number, values_of(*message));
        };
    subscribed_.push_back({node_.subscribe<M>(topic, queue_length, pass_on, ros::VoidConstPtr(),
                                              ros::TransportHints().tcpNoDelay())});
    return number;
  }

  ros::CallbackQueue queue_;
  ros::NodeHandle node_;
  std::vector<Subscribed> subscribed_;
  std::vector<Announced> announced_;
  Inbox* inbox_ = nullptr;
};

/// Returns a parameter as the text of an argument; empty if it has another type.
std::string text_of(XmlRpc::XmlRpcValue& value) {
  switch (value.getType()) {
    case XmlRpc::XmlRpcValue::TypeString:
      return static_cast<std::string&>(value);
    case XmlRpc::XmlRpcValue::TypeInt:
      return std::to_string(static_cast<int&>(value));
    case XmlRpc::XmlRpcValue::TypeDouble: {
      char text[40];
      std::snprintf(text, sizeof text, "%.17g", static_cast<double&>(value));
      return text;
    }
    default:
      return {};
  }
}

void add_parameters(std::vector<std::string>& arguments, const std::vector<std::string>& names) {
  const ros::NodeHandle own("~");
  for (const std::string& name : names) {
    const std::string option = "--" + name;
    const bool is_given =
        std::any_of(arguments.begin(), arguments.end(), [&](const std::string& argument) {
          return argument == option || argument.rfind(option + "=", 0) == 0;
        });
    std::string key = name;
    std::replace(key.begin(), key.end(), '-', '_');  // names of ROS have no dash
    XmlRpc::XmlRpcValue value;
    if (is_given || !own.getParam(key, value)) continue;
    arguments.push_back(option + "=" + text_of(value));
  }
}

}  // namespace

std::unique_ptr<Transport> connect(std::vector<std::string>& arguments,
                                   const std::vector<std::string>& names) {
  // Topics stay on loopback unless the user chooses another interface, as ROS lets him.
  if (std::getenv("ROS_HOSTNAME") == nullptr) setenv("ROS_IP", "127.0.0.1", 0);
  setenv("ROS_MASTER_URI", "http://127.0.0.1:11311", 0);  // without it, roscpp aborts
  std::string program = program_name;
  std::vector<char*> argv{program.data()};
  for (std::string& argument : arguments) argv.push_back(argument.data());
  int count = static_cast<int>(argv.size());
  ros::init(count, argv.data(), "keepout",
            ros::init_options::NoSigintHandler | ros::init_options::AnonymousName);
  arguments = {argv.begin() + 1, argv.begin() + count};
  if (!ros::master::check()) {
    throw std::runtime_error("no ROS master answers at " + ros::master::getURI() +
                             ": start one with 'roscore', or set ROS_MASTER_URI");
  }
  ros::start();
  add_parameters(arguments, names);
  return std::make_unique<Ros1Transport>();
}

const char* const program_name = "keepout-ros1-node";
const char* const program_help =
    "Over ROS 1. Each option is also a private parameter of the node, with '_' for '-'.";

}  // namespace keepout::crtk
