// SPDX-License-Identifier: BSD-3-Clause
// Neither Embree nor TBB, whose threads it builds with, is compiled with the thread sanitizer. What
// they do to hand memory from one thread to another it cannot see, and takes for a race.
#include <tbb/global_control.h>

namespace {

// So Embree builds with the thread that asks for it, and calls none of ours from another.
const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);

}  // namespace

// And the allocations of both, which they guard by spin locks of their own, are not looked at. What
// it calls of ours, and all that we do, is.
extern "C" const char* __tsan_default_suppressions() {
  return "called_from_lib:libembree3.so\ncalled_from_lib:libtbb.so\n";
}
