// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "machine.h"

#include <array>
#include <ctime>
#include <fstream>
#include <sstream>
#include <string_view>

namespace keepout::app {
namespace {

/// What stands behind a key in one of the system's files; empty where there is none.
std::string value_of(const char* file, std::string_view key, std::string_view separator) {
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with(key)) continue;
    const std::size_t at = line.find(separator);
    if (at != std::string::npos) return line.substr(at + separator.size());
  }
  return {};
}

std::size_t kibibytes(std::string_view key) {
  std::istringstream text(value_of("/proc/meminfo", key, ":"));
  std::size_t count = 0;
  text >> count;
  return count << 10;
}

}  // namespace

std::string processor() {
  const std::string name = value_of("/proc/cpuinfo", "model name", ": ");
  return name.empty() ? "unknown processor" : name;
}

std::string operating_system() {
  std::string name = value_of("/etc/os-release", "PRETTY_NAME", "=");
  std::erase(name, '"');
  return name.empty() ? "unknown system" : name;
}

std::size_t available_memory() { return kibibytes("MemAvailable"); }

std::size_t total_memory() { return kibibytes("MemTotal"); }

std::string date_now() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  ::gmtime_r(&now, &utc);
  std::array<char, 32> text;
  return {text.data(), std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &utc)};
}

}  // namespace keepout::app
