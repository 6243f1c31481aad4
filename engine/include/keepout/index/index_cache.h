// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "keepout/index/wide_bvh.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

// An index cache stores the order of the triangles of a built index on disk, so that the next build
// is fast. keepout never trusts a file. Its version, its length, a digest of its contents and a
// digest of the mesh must agree, and it must name each triangle once. keepout computes all else
// from the mesh (see WideBvh). So a damaged or forged file cannot make an index lose a triangle.

/// Returns the path of the cache file of a mesh. The name contains a digest of the mesh, so meshes
/// may share a directory.
std::filesystem::path index_cache_file(const Mesh& mesh, const std::filesystem::path& folder);

/// Returns the index in a file; null if the file does not exist, is damaged, or is for another
/// version or mesh.
std::unique_ptr<WideBvh> load_index(std::shared_ptr<const Mesh> mesh,
                                    const std::filesystem::path& file);

/// Writes an index completely or not at all, by renaming a temporary file. Several processes may
/// read and write at the same time. Returns false if the file cannot be written.
bool save_index(const WideBvh& index, const std::filesystem::path& file);

/// Returns the index of a mesh: loads it from `folder`, or builds it and saves it there. Creates a
/// missing directory. File errors cost only time: if the index cannot be saved, calls `warn` with
/// the file and the cause. Throws Error like the constructor of WideBvh.
std::unique_ptr<WideBvh> load_or_build(std::shared_ptr<const Mesh> mesh,
                                       const std::filesystem::path& folder,
                                       const std::function<void(const std::string&)>& warn = {});

}  // namespace keepout
