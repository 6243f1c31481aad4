// SPDX-License-Identifier: BSD-3-Clause
// The transport of DDS, with the names of ROS 2. Not tried with a real ROS 2.
#include "transport.h"

#include <dds/dds.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

#include "messages.h"  // generated from messages.idl

namespace keepout::crtk {
namespace {

constexpr int queue_length = 10;
constexpr std::uint32_t largest_domain = 230;

// Topics stay on loopback.
constexpr const char* on_loopback =
    "<General><Interfaces><NetworkInterface name=\"lo\"/></Interfaces>"
    "<AllowMulticast>false</AllowMulticast></General>"
    "<Discovery><ParticipantIndex>auto</ParticipantIndex>"
    "<MaxAutoParticipantIndex>31</MaxAutoParticipantIndex>"
    "<Peers><Peer address=\"127.0.0.1\"/></Peers></Discovery>";

using Header = std_msgs_msg_dds__Header_;
using PoseStamped = geometry_msgs_msg_dds__PoseStamped_;
using JointState = sensor_msgs_msg_dds__JointState_;
using WrenchStamped = geometry_msgs_msg_dds__WrenchStamped_;
using OperatingState = crtk_msgs_msg_dds__OperatingState_;
using Bool = std_msgs_msg_dds__Bool_;
using String = std_msgs_msg_dds__String_;

/// Returns the description of a kind's type; nullptr for a kind that DDS does not have.
const dds_topic_descriptor_t* descriptor_of(Kind kind) {
  switch (kind) {
    case Kind::pose:
      return &geometry_msgs_msg_dds__PoseStamped__desc;
    case Kind::joints:
      return &sensor_msgs_msg_dds__JointState__desc;
    case Kind::wrench:
      return &geometry_msgs_msg_dds__WrenchStamped__desc;
    case Kind::state:
      return &crtk_msgs_msg_dds__OperatingState__desc;
    case Kind::flag:
      return &std_msgs_msg_dds__Bool__desc;
    case Kind::text:
      return &std_msgs_msg_dds__String__desc;
    case Kind::shape:
      break;
  }
  return nullptr;
}

void set(const Header& header, Message& values) {
  values.stamp = header.stamp.sec + 1e-9 * header.stamp.nanosec;
  values.frame = header.frame_id;
}

Numbers numbers_of(const dds_sequence_double& numbers) {
  return {numbers._buffer, numbers._length};
}

/// Returns a message of a kind as a Message.
Message values_of(Kind kind, const void* sample) {
  Message values;
  switch (kind) {
    case Kind::pose: {
      const auto& message = *static_cast<const PoseStamped*>(sample);
      const auto& [at, to] = message.pose;
      set(message.header, values);
      values.vector = {at.x, at.y, at.z};
      values.rotation = {to.x, to.y, to.z, to.w};
      break;
    }
    case Kind::joints: {
      const auto& message = *static_cast<const JointState*>(sample);
      set(message.header, values);
      values.names.count = message.name._length;
      for (std::size_t k = 0; k < std::min(values.names.count, values.names.first.size()); ++k) {
        values.names.first[k] = message.name._buffer[k];
      }
      values.positions = numbers_of(message.position);
      values.velocities = numbers_of(message.velocity);
      break;
    }
    case Kind::state: {
      const auto& message = *static_cast<const OperatingState*>(sample);
      set(message.header, values);
      values.text = message.state;
      values.flag = message.is_homed;
      break;
    }
    case Kind::flag:
      values.flag = static_cast<const Bool*>(sample)->data;
      break;
    case Kind::text:
      values.text = static_cast<const String*>(sample)->data;
      break;
    case Kind::wrench:
    case Kind::shape:
      break;
  }
  return values;
}

/// Copies a text, cut at the capacity.
template <std::size_t Size>
void copy(std::string_view text, char (&to)[Size]) {
  const std::size_t size = std::min(text.size(), Size - 1);
  std::memcpy(to, text.data(), size);
  to[size] = '\0';
}

void set(const Message& values, Header& header) {
  const double whole = std::floor(values.stamp);
  header.stamp.sec = static_cast<std::int32_t>(whole);
  header.stamp.nanosec = static_cast<std::uint32_t>(1e9 * (values.stamp - whole));
  copy(values.frame, header.frame_id);
}

dds_sequence_double sequence_of(const Numbers& numbers) {
  const auto count = static_cast<std::uint32_t>(numbers.size);
  return {count, count, const_cast<double*>(numbers.data), false};  // only read
}

/// Writes a Message as one of the kind. Returns false if the message was dropped.
bool write(dds_entity_t writer, Kind kind, const Message& values) {
  const auto& v = values.vector;
  const auto& q = values.rotation;
  const auto send = [&](const auto& message) {
    return dds_write(writer, &message) == DDS_RETCODE_OK;
  };
  switch (kind) {
    case Kind::pose: {
      PoseStamped message{};
      set(values, message.header);
      message.pose = {{v[0], v[1], v[2]}, {q[0], q[1], q[2], q[3]}};
      return send(message);
    }
    case Kind::joints: {
      JointState message{};
      set(values, message.header);
      char names[std::tuple_size_v<decltype(values.names.first)>][256];
      for (std::size_t k = 0; k < values.names.count; ++k) copy(values.names.first[k], names[k]);
      const auto count = static_cast<std::uint32_t>(values.names.count);
      message.name = {count, count, names, false};
      message.position = sequence_of(values.positions);
      message.velocity = sequence_of(values.velocities);
      return send(message);
    }
    case Kind::wrench: {
      WrenchStamped message{};
      set(values, message.header);
      message.wrench.force = {v[0], v[1], v[2]};
      return send(message);
    }
    case Kind::state: {
      OperatingState message{};
      set(values, message.header);
      copy(values.text, message.state);
      message.is_homed = values.flag;
      return send(message);
    }
    case Kind::flag:
      return send(Bool{values.flag});
    case Kind::text: {
      String message{};
      copy(values.text, message.data);
      return send(message);
    }
    case Kind::shape:
      break;
  }
  return false;
}

dds_entity_t checked(dds_entity_t entity, const std::string& what) {
  if (entity >= 0) return entity;
  throw std::runtime_error("DDS: " + what + ": " + dds_strretcode(-entity));
}

class DdsTransport final : public Transport {
 public:
  explicit DdsTransport(std::uint32_t domain) {
    if (std::getenv("CYCLONEDDS_URI") == nullptr) {
      domain_ =
          checked(dds_create_domain(domain, on_loopback), "cannot use the loopback interface");
    }
    participant_ = checked(
        dds_create_participant(domain, nullptr, nullptr),
        "cannot join domain " + std::to_string(domain) + ": see CYCLONEDDS_URI and ROS_DOMAIN_ID");
    arrivals_ = checked(dds_create_waitset(participant_), "cannot wait for messages");
  }
  ~DdsTransport() override {
    dds_delete(participant_);
    if (domain_ > 0) dds_delete(domain_);
  }
  DdsTransport(const DdsTransport&) = delete;
  DdsTransport& operator=(const DdsTransport&) = delete;

  int subscribe(const std::string& topic, Kind kind) override {
    // A flag or a state must not be lost; of the others, a newer one comes in a period.
    const bool is_event = kind == Kind::flag || kind == Kind::state || kind == Kind::text;
    const auto read = [&](dds_durability_kind_t durability) {
      dds_qos_t* const qos = dds_create_qos();
      dds_qset_reliability(qos, is_event ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                           0);
      dds_qset_durability(qos, durability);
      dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, queue_length);
      dds_qset_ignorelocal(qos, DDS_IGNORELOCAL_PARTICIPANT);
      const dds_entity_t reader =
          dds_create_reader(participant_, topic_of(topic, kind), qos, nullptr);
      dds_delete_qos(qos);
      checked(reader, "cannot read " + topic);
      checked(dds_set_status_mask(reader, DDS_DATA_AVAILABLE_STATUS), "cannot watch " + topic);
      checked(dds_waitset_attach(arrivals_, reader, 0), "cannot wait for " + topic);
      return reader;
    };
    Subscribed subscribed{kind, read(DDS_DURABILITY_VOLATILE), 0};
    // A publisher that keeps its last state sends it only to a reader that requests it, and such a
    // reader does not match other publishers.
    if (kind == Kind::state) {
      subscribed.kept = read(DDS_DURABILITY_TRANSIENT_LOCAL);
    }
    subscribed_.push_back(subscribed);
    return static_cast<int>(subscribed_.size()) - 1;
  }

  int advertise(const std::string& topic, Kind kind, bool is_kept) override {
    dds_entity_t writer = 0;
    if (descriptor_of(kind) != nullptr) {
      dds_qos_t* const qos = dds_create_qos();
      // Readers of ROS 2 request reliable writers. The writer never waits for a reader.
      dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, 0);
      dds_qset_durability(qos, is_kept ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
      dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, is_kept ? 1 : queue_length);
      writer = dds_create_writer(participant_, topic_of(topic, kind), qos, nullptr);
      dds_delete_qos(qos);
      checked(writer, "cannot write " + topic);
    }
    announced_.push_back({kind, writer});
    return static_cast<int>(announced_.size()) - 1;
  }

  void deliver(Inbox& inbox, double wait) override {
    if (wait > 0.0) {
      dds_waitset_wait(arrivals_, nullptr, 0, static_cast<dds_duration_t>(1e9 * wait));
    }
    for (std::size_t k = 0; k < subscribed_.size(); ++k) {
      take(subscribed_[k].reader, static_cast<int>(k), inbox);
      if (subscribed_[k].kept > 0) take(subscribed_[k].kept, static_cast<int>(k), inbox);
    }
  }

  bool send(int topic, const Message& values) override {
    const Announced& announced = announced_[static_cast<std::size_t>(topic)];
    return write(announced.writer, announced.kind, values);
  }

  int publishers(int subscription) override {
    return dds_get_matched_publications(subscribed_[static_cast<std::size_t>(subscription)].reader,
                                        nullptr, 0);
  }

  bool is_read(int advertised) override {
    const dds_entity_t writer = announced_[static_cast<std::size_t>(advertised)].writer;
    return writer > 0 && dds_get_matched_subscriptions(writer, nullptr, 0) > 0;
  }

 private:
  struct Subscribed {
    Kind kind;
    dds_entity_t reader;
    dds_entity_t kept;  // the reader of the last messages of publishers that keep them; 0: none
  };
  struct Announced {
    Kind kind;
    dds_entity_t writer;
  };

  dds_entity_t topic_of(const std::string& topic, Kind kind) {
    // ROS 2 names its topics so in DDS.
    return checked(dds_create_topic(participant_, descriptor_of(kind), ("rt" + topic).c_str(),
                                    nullptr, nullptr),
                   "cannot create " + topic);
  }

  void take(dds_entity_t reader, int number, Inbox& inbox) {
    std::array<void*, queue_length> samples{};
    std::array<dds_sample_info_t, queue_length> infos;
    const int count = dds_take(reader, samples.data(), infos.data(), queue_length, queue_length);
    if (count <= 0) return;
    for (int k = 0; k < count; ++k) {
      const auto at = static_cast<std::size_t>(k);
      if (!infos[at].valid_data) continue;
      const Kind kind = subscribed_[static_cast<std::size_t>(number)].kind;
      inbox.receive(number, values_of(kind, samples[at]));
    }
    dds_return_loan(reader, samples.data(), count);
  }

  dds_entity_t domain_ = 0;
  dds_entity_t participant_ = 0;
  dds_entity_t arrivals_ = 0;  // waits for messages
  std::vector<Subscribed> subscribed_;
  std::vector<Announced> announced_;
};

}  // namespace

std::unique_ptr<Transport> connect(std::vector<std::string>&, const std::vector<std::string>&) {
  std::uint32_t domain = 0;
  if (const char* const text = std::getenv("ROS_DOMAIN_ID"); text != nullptr && *text != '\0') {
    const char* const end = text + std::strlen(text);
    const auto [last, error] = std::from_chars(text, end, domain);
    if (error != std::errc() || last != end || domain > largest_domain) {
      throw std::runtime_error("ROS_DOMAIN_ID must be a number from 0 to 230, not '" +
                               std::string(text) + "'");
    }
  }
  return std::make_unique<DdsTransport>(domain);
}

const char* const program_name = "keepout-dds-node";
const char* const program_help =
    "Over DDS, with the topics and types of ROS 2. The domain is that of ROS_DOMAIN_ID. Topics "
    "stay "
    "on loopback unless CYCLONEDDS_URI configures other interfaces.";

}  // namespace keepout::crtk
