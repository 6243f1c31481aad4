// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/urdf/read_robot.h"

#include <utility>

#include "bodies_file.h"
#include "collision_bodies.h"
#include "keepout/error.h"
#include "link_places.h"
#include "urdf_chain.h"
#include "xml_bounds.h"

namespace keepout {
namespace {

/// Throws the error of a function with the name of a file before its message.
template <class Function>
auto in_file(const std::filesystem::path& file, const Function& function) {
  try {
    return function();
  } catch (const Error& error) {
    throw Error(file.string() + ": " + error.what());
  }
}

/// Returns the bodies of a file, with points in the frames of the chain's links. `scale`: the
/// length of a meter.
std::vector<Body> bodies_of(const BodiesFile& file, const UrdfDescription& read,
                            const UrdfChain& chain, double scale) {
  const double millimeter = scale / 1000.0;
  std::vector<Body> bodies;
  for (std::size_t b = 0; b < file.bodies->size(); ++b) {
    const BodiesFile::Entry& entry = (*file.bodies)[b];
    Body& body = bodies.emplace_back(Body{.name = entry.name, .radius = millimeter * entry.radius});
    for (std::size_t i = 0; i < entry.points.size(); ++i) {
      const std::string where =
          "bodies[" + std::to_string(b) + "].points[" + std::to_string(i) + "].link: ";
      const auto& [name, position] = entry.points[i];
      FoundPlace found;
      try {
        found = place_of(link_named(*read.model, name), chain, scale);
      } catch (const Error& error) {
        throw Error(where + error.what());
      }
      if (found.place) {
        body.points.push_back({found.place->link, found.place->pose * Vec3(millimeter * position)});
        continue;
      }
      throw Error(where + "the chain from '" + chain.links.front() +
                  "' to the tip does not carry '" + name + "'" +
                  (found.moved_by.empty() ? "" : ": joint '" + found.moved_by + "' moves it") +
                  "; name a link between base and tip, or fixed to one");
    }
  }
  return bodies;
}

}  // namespace

UrdfRobot read_robot(const std::filesystem::path& urdf, const std::filesystem::path& bodies,
                     std::string_view base, std::string_view tip, double scale) {
  BodiesFile file;
  if (!bodies.empty()) {
    const std::string text = contents_of(bodies, most_bytes_of_bodies, "JSON");
    file = in_file(bodies, [&] { return parse_bodies(text); });
  }
  const std::string text = contents_of(urdf, most_bytes_of_urdf, "URDF");
  const UrdfDescription read = in_file(urdf, [&] { return describe(text); });
  const UrdfChain chain = in_file(urdf, [&] {
    return chain_of(read, base.empty() ? file.base : base, tip.empty() ? file.tip : tip, scale);
  });
  std::vector<std::string> notices;
  std::vector<Body> made =
      file.bodies ? in_file(bodies, [&] { return bodies_of(file, read, chain, scale); })
                  : in_file(urdf, [&] {
                      return bodies_of_collisions(read, chain, urdf.parent_path(), scale, notices);
                    });
  for (std::string& notice : notices) notice.insert(0, urdf.string() + ": ");
  Pose pose = file.base_pose;
  pose.position *= scale / 1000.0;
  return in_file(file.bodies ? bodies : urdf, [&] {
    return UrdfRobot{
        .name = chain.robot,
        .instrument = Instrument(Chain(chain.joints, pose, chain.flange), std::move(made)),
        .links = chain.links,
        .notices = std::move(notices)};
  });
}

}  // namespace keepout
