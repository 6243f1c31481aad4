// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace keepout::app {

/// The environment of a run: the machine, how keepout was built, and its libraries.
struct Machine {
  std::string processor;
  unsigned cores = 0;
  double memory_gib = 0.0;
  std::string simd;  // the instruction set in use
  std::string system;
  std::string compiler;
  std::string flags;
  std::string build_type;
  std::string keepout;                 // version
  std::vector<std::string> libraries;  // name and version
  double clock_ns = 0.0;               // the time that one clock reading adds to each measured time
};
Machine this_machine();

/// Returns the processor's name, as the system reports it.
std::string processor();

/// Returns the memory that a process could still allocate. [bytes]
std::size_t available_memory();

/// Returns the peak memory of the process since it began, or since reset_peak_memory(). 0 if the
/// system does not report it. [bytes]
std::size_t peak_memory();

/// Returns the present time in UTC, in ISO 8601 format.
std::string date_now();

}  // namespace keepout::app
