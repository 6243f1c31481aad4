// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "postbox.h"
#include "ring.h"
#include "transport.h"

namespace keepout::crtk {

/// A transport whose middleware runs in threads of its own, one that receives and one that sends.
/// The middleware locks and allocates; the thread that calls deliver() and send() does not. The
/// receiving thread starts with the first deliver(), after all topics are known.
class QueuedTransport final : public Transport, Inbox {
 public:
  explicit QueuedTransport(std::unique_ptr<Transport> middleware);
  ~QueuedTransport() override;

  int subscribe(const std::string& topic, Kind kind) override;
  int advertise(const std::string& topic, Kind kind, bool is_kept) override;
  /// Passes on what the receiving thread has received.
  void deliver(Inbox& inbox, double wait) override;
  /// Returns false if too many messages wait for the middleware.
  bool send(int topic, const Message& message) override;
  void show(int topic, const std::string& frame, const Shape& shape) override;
  int publishers(int subscription) override;
  bool is_read(int advertised) override;

 private:
  static constexpr std::size_t most_received = 256;  // messages that wait for deliver()
  static constexpr std::size_t most_sent = 64;       // messages that wait for the middleware

  /// A message that owns its values. Longer lists and texts than any valid one are cut.
  struct Stored {
    void set(int to, const Message& message);
    Message message() const;

    int topic = 0;
    Message values;  // without views
    std::string frame, text;
    std::array<std::string, Names().first.size()> names;
    std::array<double, Names().first.size() + 1> positions, velocities;
  };

  void receive(int topic, const Message& message) override;
  void run();

  std::unique_ptr<Transport> middleware_;
  std::vector<std::unique_ptr<std::atomic<int>>> publishers_;  // of each subscription
  Ring<Stored, most_received> received_;
  Postbox<Stored, most_sent> outbox_;
  std::atomic<bool> is_closed_ = false;
  std::thread receiver_;
};

}  // namespace keepout::crtk
