// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/urdf/read_chain.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fstream>

#include "keepout/error.h"
#include "keepout/option_table.h"
#include "keepout/registry.h"
#include "urdf_chain.h"
#include "xml_bounds.h"

namespace keepout {
namespace {

/// An axis whose length differs from 1 by at most this is a unit vector with few digits.
constexpr double axis_digits = 1e-3;
constexpr std::size_t most_listed = 20;  // names in a message

Vec3 vec3(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

std::string listed(std::vector<std::string_view> names) {
  std::sort(names.begin(), names.end());
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), most_listed); ++i) {
    text += (i > 0 ? ", " : "") + std::string(names[i]);
  }
  return names.size() > most_listed ? text + " and others" : text;
}

urdf::LinkConstSharedPtr only_leaf(const urdf::LinkConstSharedPtr& base) {
  std::vector<urdf::LinkConstSharedPtr> links{base};
  std::vector<std::string_view> leaves;
  urdf::LinkConstSharedPtr leaf;
  for (std::size_t i = 0; i < links.size(); ++i) {
    const urdf::LinkConstSharedPtr link = links[i];
    links.insert(links.end(), link->child_links.begin(), link->child_links.end());
    if (!link->child_links.empty()) continue;
    leaves.push_back(link->name);
    leaf = link;
  }
  if (leaves.size() == 1) return leaf;
  throw Error("more than one link is a tip: name one of " + listed(leaves));
}

/// Reads one joint for a chain.
class JointReader {
 public:
  JointReader(const urdf::Joint& joint, const TiXmlElement& element, double scale)
      : joint_(joint),
        element_(element),
        is_prismatic_(joint.type == urdf::Joint::PRISMATIC),
        scale_(is_prismatic_ ? scale : 1.0) {
    for (const char* part : {"origin", "parent", "child", "axis", "limit", "mimic"}) {
      const TiXmlElement* first = element_.FirstChildElement(part);
      if (first == nullptr || first->NextSiblingElement(part) == nullptr) continue;
      refuse("has <" + std::string(part) + "> twice: remove one of them");
    }
  }

  Joint read(const Pose& origin) const {
    if (joint_.type == urdf::Joint::FLOATING) refuse("is floating: begin the chain after it");
    if (joint_.type == urdf::Joint::PLANAR) refuse("is planar: write single joints instead");
    if (joint_.mimic) refuse("mimics another: make it fixed, or end the chain before it");
    return {.name = joint_.name,
            .kind = is_prismatic_ ? JointKind::prismatic : JointKind::revolute,
            .origin = origin,
            .axis = axis(),
            .limits = limits()};
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw Error("joint '" + joint_.name + "' " + what);
  }

  Vec3 axis() const {
    const double length = vec3(joint_.axis).norm();
    if (length == 0.0) refuse("has a zero axis: write a unit vector");
    if (std::abs(length - 1.0) <= axis_digits) return vec3(joint_.axis) / length;
    refuse("has an axis of length " + std::to_string(length) + ": write a unit vector");
  }

  JointLimits limits() const {
    JointLimits limits;
    if (!joint_.limits) return limits;  // continuous: urdfdom rejects all others
    limits.velocity = scale_ * joint_.limits->velocity;
    if (!(limits.velocity > 0.0)) refuse("has a velocity limit not above zero: write its speed");
    if (!std::isfinite(limits.velocity)) refuse("has a velocity limit that is not finite");
    if (joint_.type == urdf::Joint::CONTINUOUS) return limits;
    for (const char* end : {"lower", "upper"}) {
      // urdfdom assumes 0, which could exclude allowed positions.
      if (element_.FirstChildElement("limit")->Attribute(end)) continue;
      refuse("has no " + std::string(end) + " limit: write it, or make the joint continuous");
    }
    limits.lower = scale_ * joint_.limits->lower;
    limits.upper = scale_ * joint_.limits->upper;
    if (!(limits.lower <= limits.upper)) refuse("has lower above upper limit: exchange them");
    if (std::isfinite(limits.lower) && std::isfinite(limits.upper)) return limits;
    refuse("has a limit that is not finite: write a number, or make the joint continuous");
  }

  const urdf::Joint& joint_;
  const TiXmlElement& element_;
  bool is_prismatic_;
  double scale_;
};

}  // namespace

Pose pose_of(const urdf::Pose& told, double scale) {
  const urdf::Rotation& r = told.rotation;
  return {scale * vec3(told.position),
          Eigen::Quaterniond(r.w, r.x, r.y, r.z).normalized().toRotationMatrix()};
}

urdf::LinkConstSharedPtr link_named(const urdf::ModelInterface& model, std::string_view wanted) {
  if (auto link = model.getLink(std::string(wanted))) return link;
  std::vector<std::string_view> known;
  for (const auto& entry : model.links_) known.push_back(entry.first);
  const auto meant = nearest_name(wanted, known);
  throw Error(
      "there is no link '" + std::string(wanted) + "'; " +
      (meant ? "did you mean '" + std::string(*meant) + "'?" : "name one of " + listed(known)));
}

UrdfChain chain_of(const UrdfDescription& read, std::string_view base, std::string_view tip,
                   double scale) {
  if (!(scale > 0.0 && std::isfinite(scale))) {
    throw Error("the scale must be finite and above zero, not " + text_of(scale));
  }
  const auto root = base.empty() ? read.model->getRoot() : link_named(*read.model, base);
  const auto end = tip.empty() ? only_leaf(root) : link_named(*read.model, tip);
  std::vector<const urdf::Joint*> way;
  for (urdf::LinkConstSharedPtr at = end; at != root; at = at->getParent()) {
    way.push_back(at->parent_joint.get());
    if (way.back() != nullptr) continue;
    throw Error("link '" + end->name + "' is not below '" + root->name + "': name another base");
  }
  UrdfChain chain{
      .robot = read.model->getName(), .joints = {}, .flange = {}, .links = {root->name}};
  for (auto joint = way.rbegin(); joint != way.rend(); ++joint) {
    const JointReader reader(**joint, *read.joints.at((*joint)->name), scale);
    chain.flange = chain.flange * pose_of((*joint)->parent_to_joint_origin_transform, scale);
    if ((*joint)->type == urdf::Joint::FIXED) continue;
    chain.joints.push_back(reader.read(chain.flange));
    chain.links.push_back((*joint)->child_link_name);
    chain.flange = {};
  }
  if (chain.joints.empty() || chain.joints.size() > Chain::most_joints) {
    throw Error(std::to_string(chain.joints.size()) + " joints move between '" + root->name +
                "' and '" + end->name + "', not 1 to " + std::to_string(Chain::most_joints) +
                ": name another base or tip");
  }
  [[maybe_unused]] const Chain usable(chain.joints, {}, chain.flange);  // throws if the chain is
                                                                        // not valid
  return chain;
}

UrdfChain parse_chain(std::string_view text, std::string_view name, std::string_view base,
                      std::string_view tip, double scale) {
  try {
    return chain_of(describe(text), base, tip, scale);
  } catch (const Error& error) {
    throw Error(std::string(name) + ": " + error.what());
  }
}

std::string contents_of(const std::filesystem::path& file, std::size_t most,
                        std::string_view kind) {
  std::error_code none;  // such a path cannot be opened either
  const std::filesystem::file_status status = std::filesystem::status(file, none);
  if (std::filesystem::is_directory(status)) {
    throw Error(file.string() + ": is a directory; name a " + std::string(kind) + " file in it");
  }
  // Opening a pipe might never return.
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    throw Error(file.string() + ": is not a regular file; copy its contents to one");
  }
  std::ifstream stream(file, std::ios::binary);
  // One byte more than the limit, to detect files that are too large or endless.
  std::string text(most + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (stream.gcount() == 0) {
    throw Error(file.string() + ": cannot read it, or it is empty; name a file of " +
                std::string(kind));
  }
  text.resize(static_cast<std::size_t>(stream.gcount()));
  return text;
}

UrdfChain read_chain(const std::filesystem::path& file, std::string_view base, std::string_view tip,
                     double scale) {
  return parse_chain(contents_of(file, most_bytes_of_urdf, "URDF"), file.string(), base, tip,
                     scale);
}

}  // namespace keepout
