// SPDX-License-Identifier: BSD-3-Clause
// The program that makes the first report of ./run: `keepout simulate MESH --out REPORT.html`. It
// needs a third of the sources, so ./run builds it before the complete command.
//   keepout_first_page MESH REPORT.html
#include <cstdlib>
#include <exception>
#include <iostream>

#include "keepout/activation/registry.h"
#include "shared/names.h"
#include "simulate/simulate.h"

int main(int argc, char** argv) try {
  using namespace keepout::app;
  if (argc != 3) {
    std::cerr << "keepout_first_page: expected a mesh and a report: skull out/skull.html\n";
    return 2;
  }
  SimulateOptions options;
  options.meshes = {argv[1]};
  options.files.page = argv[2];
  options.rules = names(keepout::activation_rules());
  options.called_as = "";
  options.command = "keepout simulate " + shell_word(argv[1]) + " --out " + shell_word(argv[2]);
  return simulate(options, std::cout);
} catch (const std::exception& error) {
  std::cerr << "keepout: " << error.what() << '\n';
  return EXIT_FAILURE;
}
