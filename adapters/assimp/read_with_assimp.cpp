// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause

#include "read_with_assimp.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/DefaultLogger.hpp>
#include <assimp/Importer.hpp>
#include <assimp/LogStream.hpp>
#include <cmath>
#include <mutex>
#include <thread>
#include <utility>

#include "keepout/error.h"

namespace keepout {
namespace {

struct Messages {
  std::vector<std::string> warnings, errors;
};

/// Receives what assimp's logger says on the thread that made it.
class Listener final : public Assimp::LogStream {
 public:
  explicit Listener(std::vector<std::string>& messages) : messages_(messages) {}

  void write(const char* message) override {
    if (std::this_thread::get_id() != thread_) return;  // about a file of someone else's
    std::string text = message;
    while (!text.empty() && text.back() == '\n') text.pop_back();
    messages_.push_back(std::move(text));
  }

 private:
  std::vector<std::string>& messages_;
  std::thread::id thread_ = std::this_thread::get_id();
};

/// Listens to assimp's global logger for as long as it lives, and makes one if there is none.
class LogCapture {
 public:
  explicit LogCapture(Messages& messages)
      : alone_(mutex()),
        made_logger_(Assimp::DefaultLogger::isNullLogger()),
        warnings_(messages.warnings),
        errors_(messages.errors) {
    if (made_logger_) Assimp::DefaultLogger::create("", Assimp::Logger::NORMAL, 0);
    Assimp::DefaultLogger::get()->attachStream(&warnings_, Assimp::Logger::Warn);
    Assimp::DefaultLogger::get()->attachStream(&errors_, Assimp::Logger::Err);
  }

  ~LogCapture() {
    // Detached streams remain ours; attached ones would be deleted.
    Assimp::DefaultLogger::get()->detachStream(&warnings_, Assimp::Logger::Warn);
    Assimp::DefaultLogger::get()->detachStream(&errors_, Assimp::Logger::Err);
    if (made_logger_) Assimp::DefaultLogger::kill();
  }

  LogCapture(const LogCapture&) = delete;
  LogCapture& operator=(const LogCapture&) = delete;

 private:
  static std::mutex& mutex() {
    static std::mutex instance;
    return instance;
  }

  std::lock_guard<std::mutex> alone_;
  bool made_logger_;
  Listener warnings_, errors_;
};

const char* extension(MeshFormat format) noexcept {
  switch (format) {
    case MeshFormat::stl:
      return "stl";
    case MeshFormat::ply:
      return "ply";
    case MeshFormat::obj:
      return "obj";
    case MeshFormat::off:
      return "off";
  }
  return "";
}

/// One file on its way through assimp.
class Reading {
 public:
  Reading(const std::string& file, const Screened& screened, const Messages& messages)
      : file_(file), screened_(screened), messages_(messages) {}

  Surface read(MeshFormat format) {
    scene_ = importer_.ReadFileFromMemory(screened_.text.data(), screened_.text.size(), 0,
                                          extension(format));
    if (scene_ == nullptr) fail(importer_.GetErrorString());
    check();
    // Only now: the triangulation trusts the indices. It may turn triangles, but not over.
    if (screened_.triangles > screened_.faces) {
      scene_ = importer_.ApplyPostProcessing(aiProcess_Triangulate);
      if (scene_ == nullptr) fail(importer_.GetErrorString());
    }
    if (!messages_.errors.empty()) fail(messages_.errors.front());
    return copy();
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(file_ + ": " + what + "; repair the mesh, or export it as binary STL");
  }

  void expect_untransformed(const aiNode& node) const {
    if (!node.mTransformation.IsIdentity()) fail("a part of the scene is moved or scaled");
    for (unsigned i = 0; i < node.mNumChildren; ++i) expect_untransformed(*node.mChildren[i]);
  }

  /// Holds what assimp returned against what was found in the file.
  void check() const {
    if (scene_->mRootNode != nullptr) expect_untransformed(*scene_->mRootNode);
    std::size_t vertices = 0;
    std::size_t faces = 0;
    for (unsigned m = 0; m < scene_->mNumMeshes; ++m) {
      const aiMesh& mesh = *scene_->mMeshes[m];
      vertices += mesh.mNumVertices;
      faces += mesh.mNumFaces;
      for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
        const aiFace& face = mesh.mFaces[f];
        if (face.mNumIndices < 3) fail("assimp returned a face without three corners");
        for (unsigned c = 0; c < face.mNumIndices; ++c) {
          if (face.mIndices[c] >= mesh.mNumVertices)
            fail("a face names a vertex that is not there");
        }
      }
      for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
        const aiVector3D& p = mesh.mVertices[v];
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
          fail("a coordinate is not finite, or does not fit single precision");
        }
      }
    }
    if (vertices != screened_.vertices || faces != screened_.faces) {
      fail("assimp returned " + std::to_string(vertices) + " vertices and " +
           std::to_string(faces) + " faces of " + std::to_string(screened_.vertices) + " and " +
           std::to_string(screened_.faces));
    }
  }

  Surface copy() const {
    Surface surface;
    surface.vertices.reserve(screened_.vertices);
    surface.triangles.reserve(screened_.triangles);
    for (unsigned m = 0; m < scene_->mNumMeshes; ++m) {
      const aiMesh& mesh = *scene_->mMeshes[m];
      const auto first = static_cast<VertexId>(surface.vertices.size());
      for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
        const aiVector3D& p = mesh.mVertices[v];
        surface.vertices.emplace_back(p.x, p.y, p.z);
      }
      for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
        const aiFace& face = mesh.mFaces[f];
        if (face.mNumIndices != 3) fail("a polygon could not be cut into triangles");
        surface.triangles.push_back(
            {first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]});
      }
    }
    if (surface.triangles.size() != screened_.triangles) {
      fail("a polygon could not be cut into triangles");
    }
    return surface;
  }

  const std::string& file_;
  const Screened& screened_;
  const Messages& messages_;
  Assimp::Importer importer_;
  const aiScene* scene_ = nullptr;
};

}  // namespace

Screened screen(MeshFormat format, std::string_view contents, const std::string& file) {
  switch (format) {
    case MeshFormat::stl:
      return screen_stl(contents, file);
    case MeshFormat::ply:
      return screen_ply(contents, file);
    case MeshFormat::obj:
      return screen_obj(contents, file);
    case MeshFormat::off:
      return screen_off(contents, file);
  }
  return {};
}

Surface read_with_assimp(MeshFormat format, std::string_view contents, const std::string& file,
                         std::vector<std::string>& warnings) {
  Screened screened = screen(format, contents, file);
  if (screened.faces == 0) {
    throw Error(file +
                ": has no faces, only points or lines; a surface must be made of them first");
  }
  // Ids are 32 bits wide, and a reader may give each corner its own vertex.
  if (screened.vertices >= no_triangle || screened.triangles > no_triangle / 3) {
    throw Error(file + ": has too many triangles to read; split or decimate it");
  }
  Messages messages;
  Surface surface;
  {
    const LogCapture capture(messages);
    surface = Reading(file, screened, messages).read(format);
  }
  warnings.insert(warnings.end(), screened.warnings.begin(), screened.warnings.end());
  warnings.insert(warnings.end(), messages.warnings.begin(), messages.warnings.end());
  return surface;
}

}  // namespace keepout
