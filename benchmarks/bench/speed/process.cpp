// SPDX-License-Identifier: BSD-3-Clause
#include <dlfcn.h>
#include <pthread.h>
#include <sys/resource.h>

#include <atomic>
#include <cerrno>
#include <fstream>

#include "bench/speed/speed.h"

namespace keepout::app {
namespace {

cpu_set_t allowed_cores() noexcept {
  cpu_set_t cores;
  CPU_ZERO(&cores);
  sched_getaffinity(0, sizeof cores, &cores);
  return cores;
}

/// The cores that the process may use at its start.
const cpu_set_t allowed_at_first = allowed_cores();

}  // namespace

OnCores::OnCores(unsigned count) noexcept : before_(allowed_cores()) {
  const int core = sched_getcpu();
  if (core < 0) return;
  cpu_set_t some;
  CPU_ZERO(&some);
  CPU_SET(static_cast<unsigned>(core), &some);
  for (unsigned other = 0; other < CPU_SETSIZE && CPU_COUNT(&some) < static_cast<int>(count);
       ++other) {
    if (CPU_ISSET(other, &allowed_at_first)) CPU_SET(other, &some);
  }
  holds_ = sched_setaffinity(0, sizeof some, &some) == 0;
}

OnCores::~OnCores() {
  if (holds_) sched_setaffinity(0, sizeof before_, &before_);
}

void reset_peak_memory() {
  std::ofstream("/proc/self/clear_refs") << "5\n";  // proc(5): resets VmHWM
}

std::uint64_t page_faults() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return static_cast<std::uint64_t>(usage.ru_minflt + usage.ru_majflt);
}

}  // namespace keepout::app

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)

bool keepout::app::counts_calls() noexcept { return false; }
keepout::app::CallCounts keepout::app::calls_of_this_thread() noexcept { return {}; }

#else

namespace {

// One counter for each thread, so that counting costs almost no time.
constinit thread_local keepout::app::CallCounts counts;

/// A function of the C library that this file replaces, looked up on its first call. All threads
/// find the same address, so no lock is needed.
template <class Argument>
using Original = std::atomic<int (*)(Argument*)>;
constinit Original<pthread_mutex_t> lock_mutex = nullptr;
constinit Original<pthread_rwlock_t> lock_to_read = nullptr, lock_to_write = nullptr;

template <class Argument>
int call(Original<Argument>& original, const char* name, Argument* argument) {
  auto* function = original.load(std::memory_order_relaxed);
  if (function == nullptr) {
    function = reinterpret_cast<int (*)(Argument*)>(dlsym(RTLD_NEXT, name));
    original.store(function, std::memory_order_relaxed);
  }
  return function(argument);
}

}  // namespace

bool keepout::app::counts_calls() noexcept { return true; }
keepout::app::CallCounts keepout::app::calls_of_this_thread() noexcept { return counts; }

// The GNU C library offers its allocation under these names to programs that replace malloc.
// Operator new and Eigen call these functions as well.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);

void* malloc(std::size_t size) {
  ++counts.allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t number, std::size_t size) {
  ++counts.allocations;
  return __libc_calloc(number, size);
}
void* realloc(void* old, std::size_t size) {
  ++counts.allocations;
  return __libc_realloc(old, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  ++counts.allocations;
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) { return memalign(alignment, size); }
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
  *memory = memalign(alignment, size);
  return *memory != nullptr ? 0 : ENOMEM;
}
void free(void* memory) { __libc_free(memory); }  // must match the other functions

int pthread_mutex_lock(pthread_mutex_t* mutex) {
  ++counts.locks;
  return call(lock_mutex, "pthread_mutex_lock", mutex);
}
int pthread_rwlock_rdlock(pthread_rwlock_t* lock) {
  ++counts.locks;
  return call(lock_to_read, "pthread_rwlock_rdlock", lock);
}
int pthread_rwlock_wrlock(pthread_rwlock_t* lock) {
  ++counts.locks;
  return call(lock_to_write, "pthread_rwlock_wrlock", lock);
}
}

#endif
