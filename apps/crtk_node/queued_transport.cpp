// SPDX-License-Identifier: BSD-3-Clause
#include "queued_transport.h"

#include <algorithm>
#include <chrono>
#include <string_view>
#include <utility>

namespace keepout::crtk {
namespace {

constexpr double longest_wait = 0.01;        // of the receiving thread, for a message [s]
constexpr std::size_t longest_text = 1000;   // no frame, name or state is as long
constexpr std::size_t most_of_a_topic = 10;  // messages that deliver() passes on

void set(std::string& text, std::string_view value) { text.assign(value.substr(0, longest_text)); }

template <std::size_t n>
Numbers copied(const Numbers& numbers, std::array<double, n>& to) {
  const std::size_t size = std::min(numbers.size, n);
  std::copy_n(numbers.data, size, to.begin());
  return {nullptr, size};
}

}  // namespace

void QueuedTransport::Stored::set(int to, const Message& message) {
  topic = to;
  values = message;
  crtk::set(frame, message.frame);
  crtk::set(text, message.text);
  for (std::size_t k = 0; k < std::min(message.names.count, names.size()); ++k) {
    crtk::set(names[k], message.names.first[k]);
  }
  values.positions = copied(message.positions, positions);
  values.velocities = copied(message.velocities, velocities);
}

Message QueuedTransport::Stored::message() const {
  Message message = values;
  message.frame = frame;
  message.text = text;
  for (std::size_t k = 0; k < std::min(message.names.count, names.size()); ++k) {
    message.names.first[k] = names[k];
  }
  message.positions.data = positions.data();
  message.velocities.data = velocities.data();
  return message;
}

QueuedTransport::QueuedTransport(std::unique_ptr<Transport> middleware)
    : middleware_(std::move(middleware)),
      outbox_([this](const Stored& stored) { middleware_->send(stored.topic, stored.message()); }) {
}

QueuedTransport::~QueuedTransport() {
  is_closed_ = true;
  if (receiver_.joinable()) receiver_.join();
}

int QueuedTransport::subscribe(const std::string& topic, Kind kind) {
  publishers_.push_back(std::make_unique<std::atomic<int>>(0));
  return middleware_->subscribe(topic, kind);
}

int QueuedTransport::advertise(const std::string& topic, Kind kind, bool is_kept) {
  return middleware_->advertise(topic, kind, is_kept);
}

void QueuedTransport::deliver(Inbox& inbox, double) {
  if (!receiver_.joinable()) receiver_ = std::thread([this]() noexcept { run(); });
  const auto pass_on = [&](const Stored& stored) { inbox.receive(stored.topic, stored.message()); };
  // A flood that goes on does not hold the caller.
  for (std::size_t k = 0; k < most_received && received_.read(pass_on); ++k) continue;
}

bool QueuedTransport::send(int topic, const Message& message) {
  return outbox_.post([&](Stored& stored) { stored.set(topic, message); });
}

void QueuedTransport::show(int topic, const std::string& frame, const Shape& shape) {
  middleware_->show(topic, frame, shape);
}

int QueuedTransport::publishers(int subscription) {
  return *publishers_[static_cast<std::size_t>(subscription)];
}

bool QueuedTransport::is_read(int advertised) { return middleware_->is_read(advertised); }

void QueuedTransport::receive(int topic, const Message& message) {
  received_.write([&](Stored& stored) { stored.set(topic, message); });
}

/// Receives until the transport is closed. Messages stay in the middleware, which keeps the newest
/// of each topic, as long as the caller of deliver() has not made room for them.
void QueuedTransport::run() {
  while (!is_closed_) {
    for (std::size_t k = 0; k < publishers_.size(); ++k) {
      *publishers_[k] = middleware_->publishers(static_cast<int>(k));
    }
    if (received_.room() >= most_of_a_topic * publishers_.size()) {
      middleware_->deliver(*this, longest_wait);
    } else {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
}

}  // namespace keepout::crtk
