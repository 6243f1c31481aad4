// SPDX-License-Identifier: BSD-3-Clause
#include "drawing.h"

#include <Eigen/Geometry>
#include <utility>

#include "keepout/mesh/mesh.h"

namespace keepout::crtk {
namespace {

constexpr double plane_size = 10.0;  // from the middle of a drawn plane to its corners [mm]

}  // namespace

Drawing::Drawing(MotionConstraint guard, const Registration& registration, const std::string& frame,
                 const std::string& topic, Transport& transport)
    : guard_(std::move(guard)),
      registration_(registration),
      frame_(frame),
      transport_(transport),
      mesh_topic_(transport.advertise(topic + "/mesh", Kind::shape, true)),
      topic_(transport.advertise(topic + "/limits", Kind::shape)),
      box_([this](const Motion& motion) { draw(motion); }) {
  const Mesh& mesh = guard_.mesh();
  Shape shape{.name = "mesh", .color = {0.9F, 0.85F, 0.75F, 0.6F}};
  shape.points.reserve(3 * mesh.triangle_count());
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    for (const Vec3& corner : mesh.triangle(static_cast<TriangleId>(t))) add(shape, corner);
  }
  transport_.show(mesh_topic_, frame_, shape);
}

void Drawing::add(Shape& shape, const Vec3& point) const {
  const Vec3 at = registration_.point_to_robot(point);
  shape.points.push_back({at.x(), at.y(), at.z()});
}

void Drawing::draw(const Motion& motion) {
  const auto& [tip, goal] = motion;
  if (!transport_.is_read(topic_)) return;
  Shape triangles{.name = "triangles", .color = {0.9F, 0.1F, 0.1F, 1.0F}};
  Shape planes{.form = Shape::Form::lines, .name = "planes", .color = {0.1F, 0.3F, 0.9F, 1.0F}};
  Vec3 desired = goal - tip;
  const double radius = guard_.options().radius;
  if (desired.norm() > radius) desired *= radius / desired.norm();
  const Step step = guard_.step({.tip = tip, .desired = desired});
  for (const std::uint32_t number : step.active) {
    if (number >= step.planes.size()) continue;
    const HalfSpace& plane = step.planes[number];
    if (plane.source != no_triangle) {
      for (const Vec3& corner : guard_.mesh().triangle(plane.source)) add(triangles, corner);
    }
    // A plane limits the increment of the tip.
    const Vec3 middle = tip + plane.offset * plane.normal;
    const Vec3 along = plane.normal.unitOrthogonal();
    const Vec3 across = plane.normal.cross(along);
    const Vec3 corners[4] = {middle + plane_size * along, middle + plane_size * across,
                             middle - plane_size * along, middle - plane_size * across};
    for (int k = 0; k < 4; ++k) {
      add(planes, corners[k]);
      add(planes, corners[(k + 1) % 4]);
    }
  }
  transport_.show(topic_, frame_, triangles);
  transport_.show(topic_, frame_, planes);
}

}  // namespace keepout::crtk
