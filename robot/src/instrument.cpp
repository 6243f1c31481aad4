// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/robot/instrument.h"

#include <algorithm>
#include <string>
#include <utility>

#include "keepout/error.h"
#include "keepout/option_table.h"

namespace keepout {
namespace {

void require_usable(const Body& body, int links, const std::string& which) {
  if (body.points.empty() || body.points.size() > Instrument::most_points_of_a_body) {
    throw Error(which + " has " + std::to_string(body.points.size()) + " points, not 1 to " +
                std::to_string(Instrument::most_points_of_a_body));
  }
  if (!(body.radius >= 0.0 && body.radius <= longest_length)) {
    throw Error("the radius of " + which + " must be a length from 0 to 1e15, not " +
                text_of(body.radius));
  }
  for (const LinkPoint& point : body.points) {
    if (point.link < 0 || point.link > links) {
      throw Error(which + " is on link " + std::to_string(point.link) + "; there are links 0 to " +
                  std::to_string(links));
    }
    if (!(point.position.norm() <= longest_length)) {
      throw Error(which + " has a point that is not finite, or too far away");
    }
    if (body.points.size() > 2 && point.link != body.points.front().link) {
      throw Error(which + " has three points or more that are on different links: only a capsule " +
                  "may reach from one link to another");
    }
  }
}

}  // namespace

Instrument::Instrument(Chain chain, std::vector<Body> bodies)
    : chain_(std::move(chain)), bodies_(std::move(bodies)) {
  if (bodies_.empty() || bodies_.size() > most_bodies) {
    throw Error("an instrument has 1 to " + std::to_string(most_bodies) + " bodies, not " +
                std::to_string(bodies_.size()));
  }
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    std::string which = "body " + std::to_string(b + 1);
    if (!bodies_[b].name.empty()) which += " ('" + bodies_[b].name + "')";
    require_usable(bodies_[b], chain_.size(), which);
    auto& numbers = numbers_.emplace_back();
    std::size_t count = 0;
    for (const LinkPoint& point : bodies_[b].points) {
      const auto is_same = [&](const LinkPoint& other) {
        return other.link == point.link && other.position == point.position;
      };
      const auto place = std::find_if(points_.begin(), points_.end(), is_same);
      numbers[count++] = static_cast<std::uint8_t>(place - points_.begin());
      if (place == points_.end()) points_.push_back(point);
    }
  }
  if (points_.size() > most_points) {
    throw Error("an instrument has at most " + std::to_string(most_points) +
                " points that differ, not " + std::to_string(points_.size()));
  }
}

Instrument free_ball(double radius) {
  std::vector<Joint> slides;
  for (int axis = 0; axis < 3; ++axis) {
    slides.push_back({.name = std::string(1, static_cast<char>('x' + axis)),
                      .kind = JointKind::prismatic,
                      .axis = Vec3::Unit(axis)});
  }
  return {Chain(std::move(slides)), {{"ball", {{3, Vec3::Zero()}}, radius}}};
}

}  // namespace keepout
