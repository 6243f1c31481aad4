// SPDX-License-Identifier: BSD-3-Clause
// Embree, and TBB whose threads build its trees, are compiled without the thread sanitizer. The
// sanitizer does not see their synchronization and reports false races.
#include <tbb/global_control.h>

namespace {

// Embree builds in the calling thread only, and calls our functions from no other thread.
const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);

}  // namespace

// Ignores races in calls from both libraries, which guard their allocations by their own spin
// locks.
extern "C" const char* __tsan_default_suppressions() {
  return "called_from_lib:libembree3.so\ncalled_from_lib:libtbb.so\n";
}
