// SPDX-License-Identifier: BSD-3-Clause

#include <string>
#include <utility>

#include "keepout/error.h"
#include "keepout/mesh/mesh.h"
#include "weld_blocks.h"

namespace keepout {

Surface weld(Surface surface, unsigned threads) {
  const auto make_reader = [&] {
    return [&](std::size_t, std::span<Corners> triangles, auto&& number) {
      for (Corners& corners : triangles) {
        for (VertexId& v : corners) {
          if (v >= surface.vertices.size()) {
            throw Error("a triangle names vertex " + std::to_string(v) + ", but there are only " +
                        std::to_string(surface.vertices.size()) + ": the file is damaged");
          }
          const Vec3& given = surface.vertices[v];
          // -0 becomes 0
          v = number(ExactPoint<double>{given.x() + 0.0, given.y() + 0.0, given.z() + 0.0});
        }
      }
    };
  };
  return weld_blocks<double>(std::move(surface.triangles), threads == 0 ? processors() : threads,
                             make_reader);
}

}  // namespace keepout
