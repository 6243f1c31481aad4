// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/urdf/read_chain.h"
#include "urdf_description.h"

namespace keepout {

/// Returns the chain of a description. Throws Error: see read_chain.
UrdfChain chain_of(const UrdfDescription& read, std::string_view base, std::string_view tip,
                   double scale);

/// Returns the link of this name. Throws Error, with a similar name, if it does not exist.
urdf::LinkConstSharedPtr link_named(const urdf::ModelInterface& model, std::string_view wanted);

/// Returns a pose of a URDF. `scale`: the length of a meter.
Pose pose_of(const urdf::Pose& told, double scale);

/// Returns the contents of a file: at most `most` bytes, and one more if there are more. `kind`:
/// "URDF", for messages. Throws Error, with the path, for a file that cannot be read, is empty or
/// is not regular.
std::string contents_of(const std::filesystem::path& file, std::size_t most, std::string_view kind);

}  // namespace keepout
