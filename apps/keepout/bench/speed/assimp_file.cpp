// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/speed/assimp_file.h"

#include <string>

#include "keepout/error.h"

#if KEEPOUT_WITH_ASSIMP
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#endif

namespace keepout::app {

#if KEEPOUT_WITH_ASSIMP

Surface assimp_surface(const std::filesystem::path& file) {
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(file.string(), aiProcess_Triangulate);
  if (scene == nullptr) throw Error(file.string() + ": assimp: " + importer.GetErrorString());
  Surface surface;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& mesh = *scene->mMeshes[m];
    const auto first = static_cast<VertexId>(surface.vertices.size());
    surface.vertices.reserve(first + mesh.mNumVertices);
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      const aiVector3D& at = mesh.mVertices[v];
      surface.vertices.emplace_back(double{at.x}, double{at.y}, double{at.z});
    }
    surface.triangles.reserve(surface.triangles.size() + mesh.mNumFaces);
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3) continue;
      surface.triangles.push_back(
          {first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]});
    }
  }
  return surface;
}

#else

Surface assimp_surface(const std::filesystem::path&) {
  throw Error("this build has no assimp: configure with KEEPOUT_WITH_ASSIMP=ON");
}

#endif

}  // namespace keepout::app
