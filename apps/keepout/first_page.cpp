// SPDX-License-Identifier: BSD-3-Clause
// The first page of ./run, which builds this program before the command: `keepout simulate MESH
// --out REPORT.html`, from a third of the sources.
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
