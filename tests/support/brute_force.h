// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "chains.h"
#include "keepout/geometry/separation.h"
#include "keepout/mesh/mesh.h"
#include "keepout/robot/instrument.h"
#include "keepout/testing/index_probes.h"

namespace keepout {

// Distances found triangle by triangle, without an index: see also keepout/testing/index_probes.h.

/// Returns the distance from a point to the mesh.
inline double distance_to(const Mesh& mesh, const Vec3& point) {
  return std::ranges::min(distances(mesh, point));
}

/// Returns the clearance of an instrument: the least distance of a body, less its radius.
inline double clearance_of(const Instrument& instrument, const Mesh& mesh,
                           const std::vector<double>& q) {
  const ChainState chain = test::state_of(instrument.chain(), q);
  double least = test::infinity;
  for (const Body& body : instrument.bodies()) {
    std::vector<Vec3> core;
    for (const LinkPoint& point : body.points) core.push_back(chain.at(point.link, point.position));
    const ConvexTool tool = ConvexTool::hull(core, body.radius);
    for (TriangleId t = 0; t < mesh.triangle_count(); ++t) {
      least = std::min(least, separation(tool, Vec3::Zero(), mesh.triangle(t)).distance);
    }
  }
  return least;
}

}  // namespace keepout
