// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <semaphore.h>

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <functional>
#include <thread>
#include <utility>

#include "ring.h"

namespace keepout::crtk {

/// A thread that handles items which one other thread posts. At most `n` items wait for it.
template <class Item, std::size_t n>
class Postbox {
 public:
  explicit Postbox(std::function<void(const Item&)> handle) : handle_(std::move(handle)) {
    sem_init(&posted_, 0, 0);
    thread_ = std::thread([this]() noexcept { run(); });
  }
  /// Waits for the item that the thread handles now; drops the others.
  ~Postbox() {
    is_closed_ = true;
    sem_post(&posted_);
    thread_.join();
    sem_destroy(&posted_);
  }
  Postbox(const Postbox&) = delete;
  Postbox& operator=(const Postbox&) = delete;

  /// Posts the item that fill(item) writes. Never waits. Returns false if the box is full.
  template <class Fill>
  bool post(const Fill& fill) {
    return items_.write(fill) && sem_post(&posted_) == 0;
  }

 private:
  void run() {
    while (true) {
      while (sem_wait(&posted_) != 0 && errno == EINTR) continue;
      if (is_closed_) return;
      items_.read(handle_);
    }
  }

  std::function<void(const Item&)> handle_;
  Ring<Item, n> items_;
  sem_t posted_;
  std::atomic<bool> is_closed_ = false;
  std::thread thread_;
};

}  // namespace keepout::crtk
