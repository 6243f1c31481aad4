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
  std::string robot = {};  // the robot whose instrument is dragged, or a URDF file; empty: a ball
  std::filesystem::path bodies = {};  // of the robot of a URDF file
  std::vector<std::filesystem::path> meshes{"skull"};
  LoadOptions load = {};
  std::filesystem::path page = "keepout-live.html";  // the file to write
  MotionConstraintSettings constraint = {
      .options = {.tool_radius = 3.0}};  // initial values of the page
  std::vector<std::string> guides = {};  // initial guides of the page, as texts
  double max_step = 0.5;                 // longest motion of the tool in a cycle [mm]
  Opening opening = Opening::by_the_desktop;
  std::string command = {};  // the whole command line, for a recorded run
};

/// Adds `keepout live` and its options to the command line.
void add_live(CLI::App& app, LiveOptions& options);

/// Writes a page that contains keepout and the meshes, in which the user drags the tool over them.
/// Opens the page, and prints its path to `out`. Throws Error, also if the page would overwrite a
/// mesh; then it writes nothing. Returns the exit status.
///
/// The engine in the page has only the instruments of robots with a name. For the robot of a URDF
/// file the page is the report of a recorded run of simulate(), one stroke of each manner, and says
/// so.
int live(const LiveOptions& options, std::ostream& out);

}  // namespace keepout::app
