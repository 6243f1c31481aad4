// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/ompl/guard_pool.h"

#include <algorithm>
#include <thread>
#include <utility>

#include "keepout/error.h"

namespace keepout {

template <class Guard>
GuardPoolOf<Guard>::GuardPoolOf(std::function<Guard()> make, std::size_t most)
    : make_(std::move(make)), most_(most) {
  if (!make_ || most_ == 0) {
    throw Error(
        "a pool of guards needs a function that makes a constraint, and a capacity of at least "
        "one");
  }
  free_.push_back(std::make_unique<Guard>(make_()));
  made_ = 1;
  options_ = free_.front()->options();
}

template <class Guard>
void GuardPoolOf<Guard>::GiveBack::operator()(Guard* guard) const noexcept {
  {
    const std::lock_guard lock(pool->mutex_);
    pool->free_.emplace_back(guard);
  }
  pool->returned_.notify_one();
}

template <class Guard>
std::unique_ptr<Guard> GuardPoolOf<Guard>::made_anew(std::unique_lock<std::mutex>& lock) {
  ++made_;
  lock.unlock();  // building an index takes time
  std::unique_ptr<Guard> guard;
  try {
    guard = std::make_unique<Guard>(make_());
  } catch (...) {
    // No caller could catch an exception in a planner's thread. It can wait for another guard.
  }
  lock.lock();
  try {
    free_.reserve(made_);  // so that giving back does not throw
  } catch (...) {
    guard.reset();
  }
  if (!guard) most_ = --made_;
  return guard;
}

template <class Guard>
typename GuardPoolOf<Guard>::Loan GuardPoolOf<Guard>::borrow() {
  std::unique_lock lock(mutex_);
  while (true) {
    if (!free_.empty()) {
      Loan guard(free_.back().release(), {this});
      free_.pop_back();
      return guard;
    }
    if (made_ < most_) {
      if (auto guard = made_anew(lock)) return {guard.release(), {this}};
      continue;
    }
    returned_.wait(lock, [this] { return !free_.empty(); });
  }
}

template <class Guard>
std::size_t GuardPoolOf<Guard>::made() const {
  const std::lock_guard lock(mutex_);
  return made_;
}

template <class Guard>
std::size_t GuardPoolOf<Guard>::cores() noexcept {
  return std::max<std::size_t>(1, std::thread::hardware_concurrency());
}

template class GuardPoolOf<MotionConstraint>;
template class GuardPoolOf<InstrumentConstraint>;

}  // namespace keepout
