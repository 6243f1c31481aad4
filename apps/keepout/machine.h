// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>

namespace keepout::app {

/// The processor's name, as the system tells it.
std::string processor();

/// The name and version of the system.
std::string operating_system();

/// Memory that a process could still take. [bytes]
std::size_t available_memory();

/// All of the machine's memory. [bytes]
std::size_t total_memory();

/// The time now in UTC, as ISO 8601 has it.
std::string date_now();

}  // namespace keepout::app
