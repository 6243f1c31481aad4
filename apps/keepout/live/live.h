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

/// The opener of the page: the desktop or the user.
enum class Opening : std::uint8_t { by_the_desktop, by_hand };

struct LiveOptions {
  std::string robot = {};  // the robot whose instrument is dragged; empty: a ball
  std::vector<std::filesystem::path> meshes{"skull"};
  LoadOptions load = {};
  std::filesystem::path page = "keepout-live.html";  // the file to write
  MotionConstraintSettings constraint = {
      .options = {.tool_radius = 3.0}};  // initial values of the page
  std::vector<std::string> guides = {};  // initial guides of the page, as texts
  double max_step = 0.5;                 // longest motion of the tool in a cycle [mm]
  Opening opening = Opening::by_the_desktop;
};

/// Adds `keepout live` and its options to the command line.
void add_live(CLI::App& app, LiveOptions& options);

/// Writes a page that contains keepout and the meshes, in which the user drags the tool over them.
/// Opens the page, and prints its path to `out`. Throws Error, also if the page would overwrite a
/// mesh; then it writes nothing.
void live(const LiveOptions& options, std::ostream& out);

}  // namespace keepout::app
