// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "keepout/mesh/mesh.h"
#include "keepout/monitor/judged_robot.h"
#include "keepout/monitor/triangle_tree.h"
#include "keepout/robot/instrument.h"
#include "keepout/robot/instrument_monitor.h"
#include "keepout/step/tip_monitor.h"

namespace keepout::monitor {

/// The bounds of a monitor's work and memory. A motion that needs more is not confirmed. A motion
/// of an instrument takes one check, and that of a tip at most four.
struct MonitorCapacity {
  std::size_t triangles = 16'384;  // near one body
  std::uint64_t work = 65'536;     // of a check, in units of about one distance
};

/// Returns a monitor of a tip beside a mesh. It confirms a motion if MotionCheck proves that the
/// tip stays min(required clearance, its distance at the start) - 4 tau away. Tau is that of
/// docs/certified-step.md. Monitors may share the tree of a mesh. A tip within 4 tau of the surface
/// is confirmed only if it escapes. Throws Error without a tree.
std::unique_ptr<TipMonitor> make_tip_monitor(std::shared_ptr<const TriangleTree> mesh,
                                             const MonitorCapacity& capacity = {});

/// Returns a monitor of an instrument beside meshes. It confirms a motion if MotionCheck proves the
/// certified clearance - 4 tolerances of each pair, on the whole true motion.
/// The certified clearance of a pair that is not degraded must be at least
/// min(margin - band, distance at the start - band). While all meshes stand still, each pair must
/// have a certified clearance. Throws Error for a tree that is null.
std::unique_ptr<InstrumentMonitor> make_instrument_monitor(
    const Instrument& instrument, std::vector<std::shared_ptr<const TriangleTree>> meshes,
    const MonitorCapacity& capacity = {});

/// Returns the robot model of an instrument, from its data.
JudgedRobot model_of(const Instrument& instrument);

}  // namespace keepout::monitor
