// SPDX-License-Identifier: BSD-3-Clause
#include "queued_transport.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <numeric>
#include <semaphore>
#include <thread>

#include "realtime/counted_allocations.h"
#include "trials.h"

namespace keepout::crtk {
namespace {

using namespace std::chrono_literals;

constexpr std::array<std::string_view, 8> names{"yaw", "pitch", "insertion", "roll",
                                                "a",   "b",     "c",         "grip"};

/// Returns a message whose values all follow from its number. Views are of `numbers`.
Message numbered(int number, std::array<double, 12>& numbers) {
  std::iota(numbers.begin(), numbers.end(), number);
  const double n = number;
  Message message{.stamp = n,
                  .frame = names[static_cast<std::size_t>(number) % names.size()],
                  .vector = {n, -n, 0.5},
                  .rotation = {0.0, n, 0.0, 1.0},
                  .positions = {numbers.data(), static_cast<std::size_t>(number % 10)},
                  .velocities = {numbers.data() + 2, static_cast<std::size_t>(number % 4)},
                  .text = names[static_cast<std::size_t>(number + 1) % names.size()],
                  .flag = number % 2 == 0};
  message.names.count = static_cast<std::size_t>(number % 9);
  std::copy_n(names.begin(), message.names.count, message.names.first.begin());
  return message;
}

bool are_equal(const Numbers& a, const Numbers& b) {
  return std::equal(a.data, a.data + a.size, b.data, b.data + b.size);
}

void expect_equal(const Message& a, const Message& b) {
  ASSERT_EQ(a.stamp, b.stamp);
  ASSERT_EQ(a.frame, b.frame);
  ASSERT_EQ(a.vector, b.vector);
  ASSERT_EQ(a.rotation, b.rotation);
  ASSERT_EQ(a.names.count, b.names.count);
  ASSERT_EQ(a.names.first, b.names.first);
  ASSERT_TRUE(are_equal(a.positions, b.positions));
  ASSERT_TRUE(are_equal(a.velocities, b.velocities));
  ASSERT_EQ(a.text, b.text);
  ASSERT_EQ(a.flag, b.flag);
}

/// A middleware that has numbered messages to deliver, and can be held while it sends.
class Middleware final : public Transport {
 public:
  int subscribe(const std::string&, Kind) override { return subscriptions_++; }
  int advertise(const std::string&, Kind, bool) override { return 0; }
  void deliver(Inbox& inbox, double wait) override {
    // At most ten of each topic, as the others.
    for (int k = 0; k < 10 * subscriptions_ && delivered < due; ++k) {
      const int number = delivered;
      inbox.receive(number % subscriptions_, numbered(number, numbers_));
      ++delivered;
    }
    if (delivered == due) std::this_thread::sleep_for(std::chrono::duration<double>(wait));
  }
  bool send(int topic, const Message& message) override {
    if (holds) held.acquire();
    EXPECT_EQ(topic, 7);
    std::array<double, 12> numbers;
    expect_equal(message, numbered(sent, numbers));
    ++sent;
    return true;
  }
  int publishers(int subscription) override { return 3 + subscription; }
  bool is_read(int) override { return true; }

  std::atomic<int> due = 0, delivered = 0, sent = 0;
  std::atomic<bool> holds = false;
  std::counting_semaphore<> held{0};

 private:
  int subscriptions_ = 0;
  std::array<double, 12> numbers_;
};

class Queue : public testing::Test, public Inbox {
 protected:
  Queue() {
    auto owned = std::make_unique<Middleware>();
    middleware_ = owned.get();
    transport_ = std::make_unique<QueuedTransport>(std::move(owned));
    for (int k = 0; k < 3; ++k) EXPECT_EQ(transport_->subscribe("topic", Kind::joints), k);
  }
  void receive(int topic, const Message& message) override {
    ASSERT_EQ(topic, received_ % 3);
    std::array<double, 12> numbers;
    expect_equal(message, numbered(received_, numbers));
    ++received_;
  }
  /// Delivers until so many messages have come.
  void deliver_until(int count) {
    while (received_ < count && !HasFatalFailure()) {
      transport_->deliver(*this, 0.0);
      std::this_thread::yield();
    }
  }
  /// Sends the next `count` messages, as the middleware takes them.
  void send(int count) {
    std::array<double, 12> numbers;
    for (const int end = next_ + count; next_ < end;) {
      if (transport_->send(7, numbered(next_, numbers))) {
        ++next_;
      } else {
        std::this_thread::yield();
      }
    }
    while (middleware_->sent != next_) std::this_thread::yield();
  }

  Middleware* middleware_;
  std::unique_ptr<QueuedTransport> transport_;
  int received_ = 0;
  int next_ = 0;  // message to send
};

TEST_F(Queue, PassesOnEveryMessageUnchangedAndInOrder) {
  const int count = test::trials(100'000);
  middleware_->due = count;
  deliver_until(count);
  send(count);
  EXPECT_EQ(received_, count);
  EXPECT_EQ(middleware_->sent, count);
}

TEST_F(Queue, DoesNotAllocateOnceItsSlotsHaveTheirMemory) {
  middleware_->due = 1000;
  deliver_until(1000);
  send(1000);
  const std::size_t before = allocations();
  middleware_->due = 11'000;
  deliver_until(11'000);
  send(10'000);
  EXPECT_EQ(allocations(), before);
}

// Neither a middleware that stands still nor a flood holds the caller.
TEST_F(Queue, RefusesMessagesWhileTheMiddlewareStandsStill) {
  middleware_->holds = true;
  std::array<double, 12> numbers;
  int accepted = 0;
  while (transport_->send(7, numbered(accepted, numbers))) ++accepted;
  EXPECT_EQ(accepted, 64);  // with the one that the middleware is sending
  middleware_->holds = false;
  middleware_->held.release();
  while (middleware_->sent != accepted) std::this_thread::yield();
  next_ = accepted;
  send(10);
}

TEST_F(Queue, LeavesAFloodInTheMiddleware) {
  transport_->deliver(*this, 0.0);  // starts the thread
  middleware_->due = 20'000;
  std::this_thread::sleep_for(50ms);
  EXPECT_LE(middleware_->delivered, 256);
  EXPECT_GE(middleware_->delivered, 10);
  const int waiting = received_;
  transport_->deliver(*this, 0.0);
  EXPECT_LE(received_ - waiting, 256);
  deliver_until(20'000);
  EXPECT_EQ(received_, 20'000);
}

TEST_F(Queue, KnowsThePublishersOfEachTopic) {
  EXPECT_EQ(transport_->publishers(2), 0);  // before the first deliver()
  middleware_->due = 1;
  deliver_until(1);
  EXPECT_EQ(transport_->publishers(2), 5);
  EXPECT_TRUE(transport_->is_read(0));
}

// A list is longer than that of any chain also after it was cut, so it is refused.
TEST(StoredMessages, KeepListsTooLong) {
  class Echo final : public Transport {
   public:
    int subscribe(const std::string&, Kind) override { return 0; }
    int advertise(const std::string&, Kind, bool) override { return 0; }
    void deliver(Inbox& inbox, double) override {
      const std::vector<double> many(100'000, 1.0);
      const std::string text(1'000'000, 'x');
      Message message{.frame = text, .positions = {many.data(), many.size()}, .text = text};
      message.names.count = 5000;
      message.names.first.fill(text);
      inbox.receive(0, message);
    }
    bool send(int, const Message&) override { return true; }
    int publishers(int) override { return 0; }
    bool is_read(int) override { return false; }
  };
  class Reader final : public Inbox {
   public:
    void receive(int, const Message& message) override {
      EXPECT_EQ(message.positions.size, 9U);
      EXPECT_EQ(message.names.count, 5000U);
      EXPECT_EQ(message.frame.size(), 1000U);
      EXPECT_EQ(message.names.first[7].size(), 1000U);
      ++count;
    }
    int count = 0;
  } reader;
  QueuedTransport transport(std::make_unique<Echo>());
  transport.subscribe("topic", Kind::joints);
  while (reader.count == 0) transport.deliver(reader, 0.0);
}

}  // namespace
}  // namespace keepout::crtk
