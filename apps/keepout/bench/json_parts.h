// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "bench/benchmark.h"
#include "columns.h"

namespace keepout::app {

// What the JSON of all benchmarks is made of.

template <class T>
Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

inline Json json_of(const Timing& timing) {
  return {{"p50", timing.p50},
          {"p99", or_null(timing.p99)},
          {"p999", or_null(timing.p999)},
          {"max", timing.max}};
}

inline Json json_of(const Machine& machine) {
  return {{"processor", machine.processor},   {"cores", machine.cores},
          {"memory_gib", machine.memory_gib}, {"simd", machine.simd},
          {"system", machine.system},         {"compiler", machine.compiler},
          {"flags", machine.flags},           {"build_type", machine.build_type},
          {"keepout", machine.keepout},       {"libraries", machine.libraries},
          {"clock_ns", machine.clock_ns}};
}

}  // namespace keepout::app
