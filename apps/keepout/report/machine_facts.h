// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>

#include "bench/benchmark.h"

namespace keepout::app {

/// A list of what ran where, and how to do it again. What is not known is left out.
void print_machine_facts(std::ostream& out, const Machine& machine, const std::string& date,
                         const std::string& command, std::uint64_t seed);

}  // namespace keepout::app
