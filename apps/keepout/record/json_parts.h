// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "shared/columns.h"
#include "shared/machine.h"
#include "shared/timing.h"

// Parts of the JSON of several records.

/// Writes an empty optional as null.
template <class T>
struct nlohmann::adl_serializer<std::optional<T>> {
  static void to_json(auto& json, const std::optional<T>& value) {
    if (value) {
      json = *value;
    } else {
      json = nullptr;
    }
  }
};

namespace keepout::app {

inline void to_json(Json& json, const Timing& timing) {
  json = {{"p50", timing.p50}, {"p99", timing.p99}, {"p999", timing.p999}, {"max", timing.max}};
}

inline void to_json(Json& json, const Machine& machine) {
  json = {{"processor", machine.processor},   {"cores", machine.cores},
          {"memory_gib", machine.memory_gib}, {"simd", machine.simd},
          {"system", machine.system},         {"compiler", machine.compiler},
          {"flags", machine.flags},           {"build_type", machine.build_type},
          {"keepout", machine.keepout},       {"libraries", machine.libraries},
          {"clock_ns", machine.clock_ns}};
}

}  // namespace keepout::app
