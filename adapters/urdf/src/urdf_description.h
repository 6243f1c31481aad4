// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tinyxml.h>
#include <urdf_model/model.h>

#include <map>
#include <memory>
#include <string>
#include <string_view>

namespace keepout {

/// A robot as urdfdom understands it, and as it stands in the file: urdfdom fills in what is
/// missing and passes over what is there twice. Its links are a tree.
struct UrdfDescription {
  std::shared_ptr<urdf::ModelInterface> model;
  std::shared_ptr<TiXmlDocument> document;
  std::map<std::string, const TiXmlElement*> joints;  // by name
};

/// Reads one. Throws Error: see read_chain.
UrdfDescription describe(std::string_view text);

}  // namespace keepout
