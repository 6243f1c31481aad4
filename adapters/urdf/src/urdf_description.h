// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tinyxml.h>
#include <urdf_model/model.h>

#include <map>
#include <memory>
#include <string>
#include <string_view>

namespace keepout {

/// A robot as urdfdom interprets it, and as it is in the file. urdfdom adds missing parts and
/// ignores duplicates. Its links are a tree.
struct UrdfDescription {
  std::shared_ptr<urdf::ModelInterface> model;
  std::shared_ptr<TiXmlDocument> document;
  std::map<std::string, const TiXmlElement*> joints;  // by name
};

/// Reads a robot. Throws Error: see read_chain.
UrdfDescription describe(std::string_view text);

}  // namespace keepout
