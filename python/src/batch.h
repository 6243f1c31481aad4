// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <cstddef>
#include <functional>
#include <optional>
#include <stop_token>

namespace keepout::python {

namespace py = pybind11;

/// How many threads a batch of `items` takes: the processors this process may use, or what the
/// caller wants; never more than there are items. Throws Error for a number out of range.
unsigned threads_for(std::size_t items, std::optional<py::ssize_t> wanted);

/// Some of a batch: items begin to end, done by one worker at a time. It goes no further once
/// `stop` is asked for: the user has interrupted, or another worker has failed.
using Work = std::function<void(unsigned worker, std::size_t begin, std::size_t end,
                                const std::stop_token& stop)>;

/// Does a batch on `threads` workers, who take `chunk` items after another. Which worker does which
/// items is left to chance: `work` must not let it matter.
///
/// Called without Python's lock. Every twentieth of a second it is taken for a moment, to see
/// whether the user has interrupted (Ctrl-C); then the workers stop and the exception is thrown,
/// and so is what a worker threw.
void run_batch(std::size_t items, std::size_t chunk, unsigned threads, const Work& work);

}  // namespace keepout::python
