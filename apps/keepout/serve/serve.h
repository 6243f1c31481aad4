// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>

#include "keepout/mesh/load_mesh.h"
#include "serve/service.h"

namespace keepout::app {

struct ServeOptions {
  ServiceSettings service;
  LoadOptions load = {};
  std::optional<std::filesystem::path> socket;  // the socket to listen to; empty: stdin and stdout
  std::size_t most_clients = 16;                // clients of the socket at a time
};

/// Reads the mesh, and answers requests until the client or a signal ends it. Returns an exit
/// status. `log`: receives messages for people. Throws Error for settings, mesh and socket.
int serve(const ServeOptions& options, std::ostream& log);

/// Returns the protocol as one page, for --help.
std::string protocol_help();

}  // namespace keepout::app
