// SPDX-License-Identifier: BSD-3-Clause
// The exact oracle on what `keepout replay` has written of a path: judge_path MESH STEPS.csv KEPT.
// Prints as JSON how many motions of the tip there were, how many of them end inside, how many
// touch the mesh on their way, how many come nearer than KEPT less a tenth of a micrometre, and how
// near the nearest comes, if it is no farther than a tenth of a millimetre beyond that; else null.
// [mm]
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <limits>
#include <sstream>
#include <string>

#include "keepout/mesh/load_mesh.h"
#include "keepout/oracle/safety_oracle.h"

int main(int argc, char** argv) try {
  if (argc != 4) {
    std::cerr << "usage: judge_path MESH STEPS.csv KEPT\n";
    return EXIT_FAILURE;
  }
  const double kept = std::stod(argv[3]);
  const auto mesh = keepout::load_mesh(argv[1], {.check = keepout::MeshCheck::none}).mesh;
  keepout::oracle::SafetyOracle oracle(mesh);
  std::ifstream steps(argv[2]);
  std::string line;
  std::getline(steps, line);
  std::size_t motions = 0, inside = 0, crossing = 0, nearer = 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (; std::getline(steps, line); ++motions) {
    std::istringstream columns(line);
    std::string word;
    double value[11] = {};  // step, status, p, d, u
    for (int i = 0; i < 11 && std::getline(columns, word, ','); ++i) {
      if (i != 1) value[i] = std::stod(word);
    }
    const keepout::Vec3 tip(value[2], value[3], value[4]);
    const keepout::Vec3 end = tip + keepout::Vec3(value[8], value[9], value[10]);
    const keepout::oracle::Finding finding =
        oracle.check(tip, end, std::max(kept - 1e-4, 0.0), kept + 0.1);
    crossing += finding.crosses ? 1 : 0;
    nearer += finding.below ? 1 : 0;
    nearest = std::min(nearest, finding.distance);
    inside += oracle.inside(end).value_or(false) ? 1 : 0;
  }
  std::cout << "{\"motions\": " << motions << ", \"inside\": " << inside
            << ", \"crossing\": " << crossing << ", \"nearer\": " << nearer << ", \"nearest\": ";
  if (std::isfinite(nearest)) {
    std::cout << nearest << "}\n";
  } else {
    std::cout << "null}\n";
  }
  return motions > 0 ? EXIT_SUCCESS : EXIT_FAILURE;
} catch (const std::exception& error) {
  std::cerr << "judge_path: " << error.what() << '\n';
  return EXIT_FAILURE;
}
