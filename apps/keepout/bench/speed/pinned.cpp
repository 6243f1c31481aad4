// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/speed/pinned.h"

namespace keepout::app {

Pinned::Pinned() noexcept {
  CPU_ZERO(&before_);
  if (sched_getaffinity(0, sizeof before_, &before_) != 0) return;
  core_ = sched_getcpu();
  if (core_ >= 0 && !pin()) core_ = -1;
}

Pinned::~Pinned() {
  if (is_pinned()) sched_setaffinity(0, sizeof before_, &before_);
}

bool Pinned::pin() const noexcept {
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(static_cast<unsigned>(core_), &one);
  return sched_setaffinity(0, sizeof one, &one) == 0;
}

Pinned::Released::Released(const Pinned& pinned, unsigned cores) noexcept : pinned_(pinned) {
  if (!pinned_.is_pinned()) return;
  cpu_set_t some;
  CPU_ZERO(&some);
  CPU_SET(static_cast<unsigned>(pinned_.core_), &some);
  for (unsigned core = 0; core < CPU_SETSIZE && static_cast<unsigned>(CPU_COUNT(&some)) < cores;
       ++core) {
    if (CPU_ISSET(core, &pinned_.before_)) CPU_SET(core, &some);
  }
  sched_setaffinity(0, sizeof some, &some);
}

Pinned::Released::~Released() {
  if (pinned_.is_pinned()) pinned_.pin();
}

}  // namespace keepout::app
