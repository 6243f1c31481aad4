// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/ompl/guard_pool.h"

#include <algorithm>
#include <thread>
#include <utility>

#include "keepout/error.h"

namespace keepout {

GuardPool::GuardPool(std::function<MotionConstraint()> make, std::size_t most)
    : make_(std::move(make)), most_(most) {
  if (!make_ || most_ == 0) {
    throw Error(
        "a pool of guards needs a function that makes a MotionConstraint, and room for one");
  }
  free_.push_back(std::make_unique<MotionConstraint>(make_()));
  made_ = 1;
  options_ = free_.front()->options();
}

void GuardPool::GiveBack::operator()(MotionConstraint* guard) const noexcept {
  {
    const std::lock_guard lock(pool->mutex_);
    pool->free_.emplace_back(guard);
  }
  pool->returned_.notify_one();
}

std::unique_ptr<MotionConstraint> GuardPool::made_anew(std::unique_lock<std::mutex>& lock) {
  ++made_;
  lock.unlock();  // an index takes its time
  std::unique_ptr<MotionConstraint> guard;
  try {
    guard = std::make_unique<MotionConstraint>(make_());
  } catch (...) {
    // A planner's thread has nobody who would catch it, and there is one to wait for.
  }
  lock.lock();
  try {
    free_.reserve(made_);  // giving back shall not throw
  } catch (...) {
    guard.reset();
  }
  if (!guard) most_ = --made_;
  return guard;
}

GuardPool::Loan GuardPool::borrow() {
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

std::size_t GuardPool::made() const {
  const std::lock_guard lock(mutex_);
  return made_;
}

std::size_t GuardPool::cores() noexcept {
  return std::max<std::size_t>(1, std::thread::hardware_concurrency());
}

}  // namespace keepout
