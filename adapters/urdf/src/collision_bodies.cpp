// SPDX-License-Identifier: BSD-3-Clause
#include "collision_bodies.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>

#include "enclosing_capsule.h"
#include "keepout/error.h"
#include "keepout/mesh/load_mesh.h"
#include "link_places.h"

namespace keepout {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t longest_name = 40;
constexpr const char* write_bodies = "; or write the bodies into a file of their own (--bodies)";

/// Returns the file that a URDF names: relative to its folder, or in a package of ROS, which is a
/// folder above or beside it. Throws Error if there is no such file.
fs::path mesh_file(const std::string& name, const fs::path& folder) {
  const auto existing = [&](const std::vector<fs::path>& places) {
    std::error_code none;
    std::string tried;
    for (const fs::path& place : places) {
      if (fs::is_regular_file(place, none)) return place;
      tried += (tried.empty() ? "" : ", ") + place.lexically_normal().string();
    }
    throw Error("there is no file " + tried + ": name one beside the URDF");
  };
  for (const std::string_view scheme : {"package://", "model://"}) {
    if (!name.starts_with(scheme)) continue;
    const fs::path rest = name.substr(scheme.size());
    if (rest.empty()) break;
    const fs::path package = *rest.begin();
    std::vector<fs::path> places;
    fs::path above = fs::absolute(folder).lexically_normal();
    for (int levels = 0; levels < 4 && above.has_relative_path(); ++levels) {
      places.push_back(above / rest);
      if (above.filename() == package) places.push_back(above.parent_path() / rest);
      above = above.parent_path();
    }
    return existing(places);
  }
  const std::string_view file = "file://";
  if (name.starts_with(file)) return existing({name.substr(file.size())});
  if (name.find("://") != std::string::npos) {
    throw Error("'" + name + "' is not a file: write its path, or package://NAME/PATH");
  }
  return existing({folder / name});
}

/// One collision element.
class Shape {
 public:
  Shape(const TiXmlElement& element, std::string which, const LinkPlace& place,
        const fs::path& folder, double scale, std::vector<std::string>& notices)
      : which_(std::move(which)), link_(place.link), scale_(scale) {
    const TiXmlElement* const origin = only(element, "origin");
    const Vec3 rpy = origin != nullptr ? vector(*origin, "rpy", Vec3::Zero()) : Vec3::Zero();
    Pose at;
    at.rotation =
        (Eigen::AngleAxisd(rpy.z(), Vec3::UnitZ()) * Eigen::AngleAxisd(rpy.y(), Vec3::UnitY()) *
         Eigen::AngleAxisd(rpy.x(), Vec3::UnitX()))
            .toRotationMatrix();
    if (origin != nullptr) at.position = scale * vector(*origin, "xyz", Vec3::Zero());
    pose_ = place.pose * at;
    // The roundings of all poses up to here are relative to these lengths.
    lengths_ = place.pose.position.norm() + at.position.norm();
    const TiXmlElement* const geometry = only(element, "geometry");
    const TiXmlElement* const form = geometry != nullptr ? geometry->FirstChildElement() : nullptr;
    if (form == nullptr) refuse("has no shape in <geometry>: write one, or remove the element");
    enclose(*form, folder, notices);
  }

  /// Returns a body that contains the shape.
  Body body() const {
    Body body{.radius = capsule_.radius};
    body.points.push_back({link_, capsule_.from});
    if (capsule_.to != capsule_.from) body.points.push_back({link_, capsule_.to});
    return body;
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const { throw Error(which_ + " " + what); }

  /// Returns the only child of this name; null without one.
  const TiXmlElement* only(const TiXmlElement& of, const char* name) const {
    const TiXmlElement* const first = of.FirstChildElement(name);
    if (first != nullptr && first->NextSiblingElement(name) != nullptr) {
      refuse("has <" + std::string(name) + "> twice: remove one of them");
    }
    return first;
  }

  template <std::size_t count>
  std::array<double, count> numbers(const TiXmlElement& of, const char* name) const {
    const char* const text = of.Attribute(name);
    const std::string where = "<" + of.ValueStr() + " " + name + ">";
    if (text == nullptr) refuse("has no " + where + ": write it");
    std::array<double, count> read{};
    const char* at = text;
    const char* const end = text + std::strlen(text);
    const auto skip_blanks = [&] {
      at = std::find_if_not(at, end,
                            [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; });
    };
    bool is_read = true;
    for (double& number : read) {
      skip_blanks();
      if (at != end && *at == '+') ++at;
      const auto [next, error] = std::from_chars(at, end, number);
      is_read = is_read && error == std::errc{} && std::isfinite(number);
      at = next;
    }
    skip_blanks();
    if (is_read && at == end) return read;
    refuse("has " + where + " '" + std::string(text).substr(0, longest_name) + "': write " +
           (count == 1 ? "a finite number" : "three finite numbers"));
  }
  Vec3 vector(const TiXmlElement& of, const char* name, const Vec3& usual) const {
    return of.Attribute(name) != nullptr ? Vec3(numbers<3>(of, name).data()) : usual;
  }
  /// Returns a length that is not negative, in the mesh's unit.
  double length(const TiXmlElement& of, const char* name) const {
    const double read = numbers<1>(of, name)[0];
    if (read < 0.0) refuse("has a negative <" + of.ValueStr() + " " + name + ">: write a length");
    return scale_ * read;
  }

  void enclose(const TiXmlElement& form, const fs::path& folder,
               std::vector<std::string>& notices) {
    const std::string& kind = form.ValueStr();
    if (kind == "sphere") {
      set_along_z(length(form, "radius"), 0.0);
    } else if (kind == "cylinder" || kind == "capsule") {
      // The length of a capsule is that between the centers of its two ends. A cylinder's points
      // are within its radius of its axis.
      set_along_z(length(form, "radius"), length(form, "length"));
    } else if (kind == "box") {
      const Vec3 half = 0.5 * scale_ * Vec3(numbers<3>(form, "size").data());
      if (half.minCoeff() < 0.0) refuse("has a negative <box size>: write lengths");
      std::vector<Vec3> corners;
      for (int i = 0; i < 8; ++i) {
        corners.push_back(half.cwiseProduct(
            Vec3((i & 1) != 0 ? 1.0 : -1.0, (i & 2) != 0 ? 1.0 : -1.0, (i & 4) != 0 ? 1.0 : -1.0)));
      }
      set_around(corners);
    } else if (kind == "mesh") {
      set_around(vertices(form, folder, notices));
    } else {
      refuse("has a <" + kind + ">: write a sphere, cylinder, capsule, box or mesh" + write_bodies);
    }
  }

  void set_along_z(double radius, double length) {
    const Vec3 half(0.0, 0.0, 0.5 * length);
    capsule_ = {pose_ * Vec3(-half), pose_ * half,
                radius + outwards * (radius + length + lengths_)};
  }

  /// `points`: in the frame of the shape.
  void set_around(std::vector<Vec3> points) {
    double farthest = 0.0;
    for (Vec3& point : points) {
      farthest = std::max(farthest, point.norm());
      point = pose_ * point;
    }
    capsule_ = enclosing_capsule(points);
    capsule_.radius += outwards * (farthest + lengths_);
  }

  std::vector<Vec3> vertices(const TiXmlElement& form, const fs::path& folder,
                             std::vector<std::string>& notices) const {
    const char* const name = form.Attribute("filename");
    if (name == nullptr || *name == '\0') refuse("has no <mesh filename>: write it");
    const Vec3 factors = vector(form, "scale", Vec3::Ones());
    try {
      const LoadedMesh loaded =
          load_mesh(mesh_file(name, folder), {.scale = 1.0, .check = MeshCheck::none});
      notices.insert(notices.end(), loaded.warnings.begin(), loaded.warnings.end());
      std::vector<Vec3> points;
      for (const Vec3& vertex : loaded.mesh->vertices()) {
        points.push_back(scale_ * factors.cwiseProduct(vertex));
      }
      if (points.empty()) throw Error(std::string(name) + ": has no vertex");
      return points;
    } catch (const Error& error) {
      throw Error(which_ + ": " + error.what() + write_bodies);
    }
  }

  std::string which_;  // for messages
  int link_;
  double scale_;
  Pose pose_;             // of the shape in the frame of the chain's link
  double lengths_ = 0.0;  // that the pose adds up [length]
  Capsule capsule_{};
};

/// Returns the name with characters that every record and table can have, and that no other has.
std::string unique_name(std::string name, std::set<std::string>& used) {
  for (char& c : name) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                          (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
    if (!is_plain) c = '_';
  }
  name = name.empty() ? "body" : name.substr(0, longest_name);
  std::string unique = name;
  for (int number = 2; !used.insert(unique).second; ++number) {
    unique = name + "_" + std::to_string(number);
  }
  return unique;
}

/// Moves the body that comes nearest to the tip to the end, and turns its nearest point to its end.
void put_tool_last(std::vector<Body>& bodies, const UrdfChain& chain) {
  const int last = static_cast<int>(chain.joints.size());
  const auto off = [&](const LinkPoint& point) {
    return point.link == last ? (point.position - chain.flange.position).norm()
                              : std::numeric_limits<double>::infinity();
  };
  const auto nearest = [&](const Body& body) {
    double least = std::numeric_limits<double>::infinity();
    for (const LinkPoint& point : body.points) least = std::min(least, off(point));
    return least;
  };
  const auto tool = std::ranges::min_element(bodies, {}, nearest);
  if (std::isfinite(nearest(*tool))) std::rotate(tool, tool + 1, bodies.end());
  std::vector<LinkPoint>& points = bodies.back().points;
  if (off(points.front()) < off(points.back())) std::ranges::reverse(points);
}

}  // namespace

std::vector<Body> bodies_of_collisions(const UrdfDescription& read, const UrdfChain& chain,
                                       const fs::path& folder, double scale,
                                       std::vector<std::string>& notices) {
  struct Found {
    const TiXmlElement* element;
    std::string link, name, which;
    LinkPlace place;
  };
  std::vector<Found> found;
  std::set<int> covered;
  for (const TiXmlElement* link = read.document->RootElement()->FirstChildElement("link");
       link != nullptr; link = link->NextSiblingElement("link")) {
    const std::string name = link->Attribute("name");  // urdfdom has required it
    const FoundPlace at = place_of(read.model->getLink(name), chain, scale);
    int number = 0;
    for (const TiXmlElement* element = link->FirstChildElement("collision"); element != nullptr;
         element = element->NextSiblingElement("collision")) {
      const char* const own = element->Attribute("name");
      const std::string which = "link '" + name + "', collision " + std::to_string(++number);
      if (!at.place && !at.moved_by.empty()) {
        throw Error(which + " moves with joint '" + at.moved_by +
                    "', which is not in the chain: make that joint fixed" + write_bodies);
      }
      if (!at.place) {
        notices.push_back("link '" + name + "' is not on the way from '" + chain.links.front() +
                          "' to the tip: its collision elements are not guarded");
        break;
      }
      covered.insert(at.place->link);
      found.push_back(
          {element, name, own != nullptr && *own != '\0' ? own : name, which, *at.place});
    }
  }
  for (std::size_t k = 1; k < chain.links.size(); ++k) {
    if (covered.contains(static_cast<int>(k))) continue;
    notices.push_back("link '" + chain.links[k] +
                      "' has no collision element: nothing of it is guarded");
  }
  if (found.empty() || found.size() > Instrument::most_bodies) {
    throw Error("the links from base to tip have " + std::to_string(found.size()) +
                " collision elements, not 1 to " + std::to_string(Instrument::most_bodies) +
                ": write the bodies into a file of their own (--bodies)");
  }
  std::ranges::stable_sort(found, {}, [](const Found& one) { return one.place.link; });
  std::vector<Body> bodies;
  std::set<std::string> used;
  for (const Found& one : found) {
    Body& body = bodies.emplace_back(
        Shape(*one.element, one.which, one.place, folder, scale, notices).body());
    body.name = unique_name(one.name, used);
  }
  put_tool_last(bodies, chain);
  return bodies;
}

}  // namespace keepout
