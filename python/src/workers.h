// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <cstddef>
#include <deque>
#include <mutex>
#include <stop_token>

#include "batch.h"

namespace keepout::python {

namespace py = pybind11;

/// A lock whose holder in another thread may need Python's lock to continue. So it releases
/// Python's lock while it waits.
class InUse {
 public:
  explicit InUse(std::mutex& mutex) : lock_(mutex, std::try_to_lock) {
    if (lock_.owns_lock()) return;
    const py::gil_scoped_release release;
    lock_.lock();
  }

 private:
  std::unique_lock<std::mutex> lock_;
};

/// The constraints of the workers of a batch. They are made when a batch first needs them, and
/// reused. One batch at a time.
template <class Constraint>
class Workers {
 public:
  /// Calls `item(constraint, i, stop)` for each item of a batch, without Python's lock. `make()`
  /// makes the constraint of a worker. See run_batch.
  template <class Make, class Item>
  void do_each(std::size_t items, std::size_t chunk, unsigned threads, const Make& make,
               const Item& item) {
    const py::gil_scoped_release release;
    const std::lock_guard in_use(in_use_);
    while (constraints_.size() < threads) constraints_.push_back(make());
    const Work work = [&](unsigned worker, std::size_t begin, std::size_t end,
                          const std::stop_token& stop) {
      for (std::size_t i = begin; i < end && !stop.stop_requested(); ++i) {
        item(constraints_[worker], i, stop);
      }
    };
    if (chunk > 1 && items <= chunk) {
      work(0, 0, items, std::stop_token());  // a thread takes longer to start
    } else {
      run_batch(items, chunk, threads, work);
    }
  }

  /// The lock of a batch. Taken before the lock of single steps if both are needed.
  std::mutex& in_use() noexcept { return in_use_; }
  /// Precondition: in_use() is held.
  std::deque<Constraint>& constraints() noexcept { return constraints_; }

 private:
  std::deque<Constraint> constraints_;
  std::mutex in_use_;
};

}  // namespace keepout::python
