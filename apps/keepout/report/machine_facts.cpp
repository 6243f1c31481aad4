// SPDX-License-Identifier: BSD-3-Clause
#include "report/machine_facts.h"

#include <ostream>
#include <utility>
#include <vector>

#include "number_text.h"
#include "report/text.h"

namespace keepout::app {

void print_machine_facts(std::ostream& out, const Machine& machine, const std::string& date,
                         const std::string& command, std::uint64_t seed) {
  const std::vector<std::pair<std::string, std::string>> facts = {
      {"date", date},
      {"processor", machine.processor},
      {"cores", machine.cores > 0 ? std::to_string(machine.cores) : ""},
      {"memory", machine.memory_gib > 0.0 ? rounded(machine.memory_gib) + " GiB" : ""},
      {"SIMD target", machine.simd},
      {"system", machine.system},
      {"compiler", machine.compiler},
      {"flags", machine.flags},
      {"build type", machine.build_type},
      {"keepout", machine.keepout},
      {"libraries", listed(machine.libraries)},
      {"seed", std::to_string(seed)}};
  out << "<dl>";
  for (const auto& [name, value] : facts) {
    if (!value.empty()) out << "<dt>" << name << "</dt><dd>" << escape(value) << "</dd>";
  }
  if (!command.empty()) {
    out << "<dt class=\"wide\">command</dt><dd class=\"wide\">" << escape(command) << "</dd>";
  }
  out << "</dl>";
}

}  // namespace keepout::app
