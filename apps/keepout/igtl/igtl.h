// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "igtl/server.h"
#include "keepout/mesh/load_mesh.h"

namespace CLI {
class App;
}

namespace keepout::app {

struct IgtlOptions {
  std::filesystem::path mesh;
  LoadOptions load = {};
  std::vector<std::string> guides = {};  // texts of guides of the tip
  igtl::ServerOptions server = {};
};

/// Adds `keepout igtl` and its options to the command line.
void add_igtl(CLI::App& app, IgtlOptions& options);

/// Reads the mesh, and serves clients until a signal ends it. Returns an exit status. `log`:
/// receives messages for people; the last one has the lost cycles and the memory. Throws Error for
/// settings, mesh and address.
int serve_igtl(const IgtlOptions& options, std::ostream& log);

}  // namespace keepout::app
