// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "keepout/factory/make_motion_constraint.h"
#include "keepout/mesh/load_mesh.h"

namespace CLI {
class App;
}

namespace keepout::app {

/// Who opens the page.
enum class Opening : std::uint8_t { by_the_desktop, by_hand };

struct LiveOptions {
  std::string robot = {};  // whose instrument is dragged; empty: a ball
  std::vector<std::filesystem::path> meshes{"skull"};
  LoadOptions load = {};
  std::filesystem::path page = "keepout-live.html";  // to be written
  MotionConstraintSettings constraint = {
      .options = {.tool_radius = 3.0}};  // that the page begins with
  std::vector<std::string> guides = {};  // texts, that the page begins with
  double max_step = 0.5;                 // longest way of the tool in a cycle [mm]
  Opening opening = Opening::by_the_desktop;
};

/// Adds `keepout live` and its options to the command line.
void add_live(CLI::App& app, LiveOptions& options);

/// Writes a page in which one drags the tool over the meshes, with keepout itself in it, and opens
/// it. Where it is goes to `out`. Throws Error, also when the page would overwrite a mesh; then
/// none is written.
void live(const LiveOptions& options, std::ostream& out);

}  // namespace keepout::app
