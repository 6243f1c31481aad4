// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>

#include <array>
#include <cstdint>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace keepout::test {

// A peer of the DDS node that shares no code with it: Fast DDS, and messages that are written here
// by the rules of CDR.

struct WireHeader {
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
  std::string frame = {};

  template <class Cdr>
  void fields(Cdr&& cdr) {
    cdr(sec), cdr(nanosec), cdr(frame);
  }
};

struct WirePose {
  static constexpr const char* type = "geometry_msgs::msg::dds_::PoseStamped_";
  WireHeader header = {};
  std::array<double, 3> position = {};               // [m]
  std::array<double, 4> orientation = {0, 0, 0, 1};  // x, y, z, w

  template <class Cdr>
  void fields(Cdr&& cdr) {
    header.fields(cdr);
    for (double& number : position) cdr(number);
    for (double& number : orientation) cdr(number);
  }
};

struct WireJoints {
  static constexpr const char* type = "sensor_msgs::msg::dds_::JointState_";
  WireHeader header = {};
  std::vector<std::string> name = {};
  std::vector<double> position = {}, velocity = {}, effort = {};

  template <class Cdr>
  void fields(Cdr&& cdr) {
    header.fields(cdr);
    cdr(name), cdr(position), cdr(velocity), cdr(effort);
  }
};

struct WireState {
  static constexpr const char* type = "crtk_msgs::msg::dds_::OperatingState_";
  WireHeader header = {};
  std::string state = {};
  bool is_homed = false, is_busy = false;

  template <class Cdr>
  void fields(Cdr&& cdr) {
    header.fields(cdr);
    cdr(state), cdr(is_homed), cdr(is_busy);
  }
};

struct WireFlag {
  static constexpr const char* type = "std_msgs::msg::dds_::Bool_";
  bool data = false;

  template <class Cdr>
  void fields(Cdr&& cdr) {
    cdr(data);
  }
};

struct WireText {
  static constexpr const char* type = "std_msgs::msg::dds_::String_";
  std::string data = {};

  template <class Cdr>
  void fields(Cdr&& cdr) {
    cdr(data);
  }
};

/// The type of a message in Fast DDS.
template <class M>
class WireType : public eprosima::fastdds::dds::TopicDataType {
 public:
  WireType() {
    setName(M::type);
    m_typeSize = 1 << 13;
    m_isGetKeyDefined = false;
  }
  bool serialize(void* data, eprosima::fastrtps::rtps::SerializedPayload_t* payload) override {
    eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(payload->data), payload->max_size);
    eprosima::fastcdr::Cdr cdr(buffer, eprosima::fastcdr::Cdr::LITTLE_ENDIANNESS,
                               eprosima::fastcdr::Cdr::DDS_CDR);
    payload->encapsulation = CDR_LE;
    cdr.serialize_encapsulation();
    static_cast<M*>(data)->fields([&](auto& field) { cdr << field; });
    payload->length = static_cast<std::uint32_t>(cdr.getSerializedDataLength());
    return true;
  }
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) override {
    eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(payload->data), payload->length);
    eprosima::fastcdr::Cdr cdr(buffer, eprosima::fastcdr::Cdr::LITTLE_ENDIANNESS,
                               eprosima::fastcdr::Cdr::DDS_CDR);
    cdr.read_encapsulation();
    static_cast<M*>(data)->fields([&](auto& field) { cdr >> field; });
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void*) override {
    return [this] { return m_typeSize; };
  }
  void* createData() override { return new M; }
  void deleteData(void* data) override { delete static_cast<M*>(data); }
  bool getKey(void*, eprosima::fastrtps::rtps::InstanceHandle_t*, bool) override { return false; }
};

/// A participant on loopback.
class FastDdsPeer {
 public:
  explicit FastDdsPeer(std::uint32_t domain) {
    using namespace eprosima::fastdds::dds;
    DomainParticipantQos qos;
    auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    udp->interfaceWhiteList.push_back("127.0.0.1");
    qos.transport().use_builtin_transports = false;
    qos.transport().user_transports.push_back(udp);
    for (std::uint32_t number = 0; number < 4; ++number) {
      eprosima::fastrtps::rtps::Locator_t locator;
      eprosima::fastrtps::rtps::IPLocator::setIPv4(locator, 127, 0, 0, 1);
      locator.port = 7400 + 250 * domain + 10 + 2 * number;  // of discovery, as the protocol has it
      qos.wire_protocol().builtin.initialPeersList.push_back(locator);
    }
    // A participant that starts later is found without delay.
    qos.wire_protocol().builtin.discovery_config.leaseDuration_announcementperiod = {0,
                                                                                     100'000'000};
    participant_ = DomainParticipantFactory::get_instance()->create_participant(domain, qos);
    publisher_ = participant_->create_publisher(PUBLISHER_QOS_DEFAULT);
    subscriber_ = participant_->create_subscriber(SUBSCRIBER_QOS_DEFAULT);
  }
  ~FastDdsPeer() {
    participant_->delete_contained_entities();
    eprosima::fastdds::dds::DomainParticipantFactory::get_instance()->delete_participant(
        participant_);
  }
  FastDdsPeer(const FastDdsPeer&) = delete;
  FastDdsPeer& operator=(const FastDdsPeer&) = delete;

  /// Announces a topic, reliable as in ROS 2.
  template <class M>
  eprosima::fastdds::dds::DataWriter* writer(const std::string& topic, bool is_kept = false) {
    using namespace eprosima::fastdds::dds;
    DataWriterQos qos = DATAWRITER_QOS_DEFAULT;
    qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
    qos.durability().kind = is_kept ? TRANSIENT_LOCAL_DURABILITY_QOS : VOLATILE_DURABILITY_QOS;
    qos.history().depth = 10;
    qos.reliable_writer_qos().times.heartbeatPeriod = {0, 50'000'000};  // default: 3 s
    return publisher_->create_datawriter(topic_of<M>(topic), qos);
  }
  void remove(eprosima::fastdds::dds::DataWriter* writer) { publisher_->delete_datawriter(writer); }

  /// Reads a topic; `receive` gets each message in a thread of Fast DDS.
  template <class M>
  void read(const std::string& topic, std::function<void(const M&)> receive, bool is_kept = false) {
    using namespace eprosima::fastdds::dds;
    struct Listener : DataReaderListener {
      std::function<void(const M&)> receive;
      void on_data_available(DataReader* reader) override {
        M message;
        SampleInfo info;
        while (reader->take_next_sample(&message, &info) ==
               eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK) {
          if (info.valid_data) receive(message);
        }
      }
    };
    auto listener = std::make_shared<Listener>();
    listener->receive = std::move(receive);
    listeners_.push_back(listener);
    DataReaderQos qos = DATAREADER_QOS_DEFAULT;
    qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
    qos.durability().kind = is_kept ? TRANSIENT_LOCAL_DURABILITY_QOS : VOLATILE_DURABILITY_QOS;
    qos.history().kind = KEEP_ALL_HISTORY_QOS;
    subscriber_->create_datareader(topic_of<M>(topic), qos, listener.get());
  }

 private:
  template <class M>
  eprosima::fastdds::dds::Topic* topic_of(const std::string& name) {
    using namespace eprosima::fastdds::dds;
    auto* const known = participant_->lookup_topicdescription(name);
    if (known != nullptr) return static_cast<Topic*>(known);
    TypeSupport type(new WireType<M>);
    type.register_type(participant_);
    return participant_->create_topic(name, M::type, TOPIC_QOS_DEFAULT);
  }

  eprosima::fastdds::dds::DomainParticipant* participant_;
  eprosima::fastdds::dds::Publisher* publisher_;
  eprosima::fastdds::dds::Subscriber* subscriber_;
  std::vector<std::shared_ptr<eprosima::fastdds::dds::DataReaderListener>> listeners_;
};

}  // namespace keepout::test
