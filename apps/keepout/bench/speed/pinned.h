// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sched.h>

namespace keepout::app {

/// Keeps the calling thread, and those that it starts, on the core that it is on. Where the system
/// refuses, nothing happens, and is_pinned() says so.
class Pinned {
 public:
  Pinned() noexcept;
  ~Pinned();
  Pinned(const Pinned&) = delete;
  Pinned& operator=(const Pinned&) = delete;

  bool is_pinned() const noexcept { return core_ >= 0; }
  int core() const noexcept { return core_; }

  /// Lets the thread, and those that it starts, on so many of the cores that it was allowed before.
  class Released {
   public:
    Released(const Pinned& pinned, unsigned cores) noexcept;
    ~Released();
    Released(const Released&) = delete;
    Released& operator=(const Released&) = delete;

   private:
    const Pinned& pinned_;
  };

 private:
  bool pin() const noexcept;

  cpu_set_t before_;
  int core_ = -1;
};

}  // namespace keepout::app
