// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <cstddef>
#include <functional>
#include <optional>
#include <stop_token>

namespace keepout::python {

namespace py = pybind11;

/// Returns the number of threads for a batch of `items`: what the caller wants, or the processors
/// that this process may use, but at most one for each item. Throws Error for a number out of
/// range.
unsigned threads_for(std::size_t items, std::optional<py::ssize_t> wanted);

/// Does items begin to end of a batch; a worker does one such chunk at a time. Must stop early if
/// `stop` is requested: the user has interrupted, or another worker has failed.
using Work = std::function<void(unsigned worker, std::size_t begin, std::size_t end,
                                const std::stop_token& stop)>;

/// Does a batch on `threads` workers, each of which takes one chunk of `chunk` items after another.
/// The result of `work` must not depend on which worker does which items.
///
/// Call it without Python's lock. It takes the lock every 50 ms to check if the user has
/// interrupted (Ctrl-C). Throws that exception, or the one of a worker, after the workers have
/// stopped.
void run_batch(std::size_t items, std::size_t chunk, unsigned threads, const Work& work);

}  // namespace keepout::python
