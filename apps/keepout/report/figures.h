// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "report/camera.h"
#include "report/views.h"
#include "simulation_record.h"

namespace keepout::app {

/// The parts of the page that show something, each as an HTML element.

/// The paths of one run on the anatomy: an overlay on the picture that carries the id "anatomy".
std::string overview_picture(const Simulation& simulation, const Overview& view, std::size_t run);

/// The picture that the overviews share, so that the page carries it once.
std::string shared_anatomy(const Overview& view);

std::string close_up_picture(const Simulation& simulation, const Moment& moment,
                             const CloseUp& view, std::size_t run);

/// Distance of the tip to the surface during one stroke, all runs in one plot.
std::string clearance_plot(const Simulation& simulation, std::size_t stroke);

/// The same, with the range of the runs under a rule: it shows what a free hand would dwarf.
std::string near_surface_plot(const Simulation& simulation, std::size_t stroke);

/// Which part of the steps took how long. Empty when no run was timed.
std::string step_time_plot(const Simulation& simulation);

/// The CSS class that gives the colour of a run.
std::string rule_class(std::size_t run);

}  // namespace keepout::app
