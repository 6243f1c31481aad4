// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace keepout::app {

/// Where something ran: the machine, how keepout was built, and the libraries in it.
struct Machine {
  std::string processor;
  unsigned cores = 0;
  double memory_gib = 0.0;
  std::string simd;  // the instruction set that keepout ran on
  std::string system;
  std::string compiler;
  std::string flags;
  std::string build_type;
  std::string keepout;                 // version
  std::vector<std::string> libraries;  // name and version
  double clock_ns = 0.0;               // what reading the clock adds to each time
};
Machine this_machine();

/// The processor's name, as the system tells it.
std::string processor();

/// Memory that a process could still take. [bytes]
std::size_t available_memory();

/// The most memory that the process has held at once since it began, or since reset_peak_memory().
/// [bytes] 0 where the system does not tell.
std::size_t peak_memory();

/// The time now in UTC, as ISO 8601 has it.
std::string date_now();

}  // namespace keepout::app
