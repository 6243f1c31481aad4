// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "keepout/index/wide_bvh.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

// What took long about a built index on the disk, for the next start: the order of its triangles. A
// file is never trusted: its version, its length, a digest of its contents and one of the mesh it
// was built for must agree, it must name each triangle once, and all else is made of the mesh anew
// (see WideBvh). So neither damage nor malice can make an index lose a triangle.

/// The file in `folder` that an index of this mesh has. Its name holds a digest of the mesh, so
/// that any number of meshes may share a folder.
std::filesystem::path index_cache_file(const Mesh& mesh, const std::filesystem::path& folder);

/// The index in a file; null if there is no such file, or if it is of another version or mesh, or
/// damaged in any way.
std::unique_ptr<WideBvh> load_index(std::shared_ptr<const Mesh> mesh,
                                    const std::filesystem::path& file);

/// Writes an index, whole or not at all: it is renamed into place when complete, so any number of
/// processes may write and read at the same time. False if it cannot be written.
bool save_index(const WideBvh& index, const std::filesystem::path& file);

/// The index of a mesh: from `folder`, or built and, if it can be, put there. The folder is made
/// where it is missing. What goes wrong with files costs time and nothing else; when the index
/// could not be put there, `warn` is told which file and why. Throws Error where building does.
std::unique_ptr<WideBvh> load_or_build(std::shared_ptr<const Mesh> mesh,
                                       const std::filesystem::path& folder,
                                       const std::function<void(const std::string&)>& warn = {});

}  // namespace keepout
