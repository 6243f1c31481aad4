// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/index/index_cache.h"

#include <array>
#include <cstdio>
#include <cstring>
#include <new>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "../digest.h"
#include "../read_only_file.h"
#include "keepout/error.h"
#include "keepout/file_replacement.h"
#include "tree_parts/block_memory.h"

namespace keepout {
namespace {

/// The version of the file format. Increase it with every change of the contents of the file, or of
/// their meaning.
constexpr std::uint32_t version = 2;

constexpr std::string_view magic = "keepout wide_bvh";

/// The head of a file; the order of the triangles follows.
struct Header {
  std::array<char, magic.size()> magic_bytes{};
  std::uint32_t file_version = version;
  std::uint32_t byte_order = 0x01020304;  // reads as another number if the bytes are swapped
  Digest mesh;
  Digest order;

  explicit Header(const Digest& of_mesh) : mesh(of_mesh) {
    std::memcpy(magic_bytes.data(), magic.data(), magic.size());
  }
};
static_assert(std::has_unique_object_representations_v<Header>, "padding would go to the file");

Digest mesh_digest(const Mesh& mesh) {
  const std::array<Digest, 2> parts{shared_digest_of(std::as_bytes(mesh.vertices())),
                                    shared_digest_of(std::as_bytes(mesh.triangles()))};
  return digest_of(std::as_bytes(std::span(parts)));
}

std::filesystem::path file_of(const Digest& mesh, const std::filesystem::path& folder) {
  std::array<char, 33> name;
  std::snprintf(name.data(), name.size(), "%016llx%016llx",
                static_cast<unsigned long long>(mesh.high),
                static_cast<unsigned long long>(mesh.low));
  return folder / (std::string(name.data()) + ".wide_bvh");
}

std::unique_ptr<WideBvh> load(std::shared_ptr<const Mesh> mesh, const Digest& digest,
                              const std::filesystem::path& path) {
  const ReadOnlyFile file(path);
  const Header expected(digest);
  Header header = expected;
  Digest read;
  BlockVector<TriangleId> order(mesh->triangle_count());
  const auto bytes = std::as_writable_bytes(std::span(order));
  if (!file.is_open() || file.size() != sizeof header + bytes.size() ||
      !file.read(0, &header, sizeof header) ||
      std::memcmp(&header, &expected, offsetof(Header, order)) != 0 ||
      !read_with_digest(file, sizeof header, bytes, read) || read != header.order) {
    return nullptr;
  }
  try {
    return std::make_unique<WideBvh>(std::move(mesh), order);
  } catch (const Error&) {
    return nullptr;
  }
}

/// Writes the file. Returns the reason if that fails, else no error.
std::error_code save(const WideBvh& index, const Digest& mesh, const std::filesystem::path& path) {
  const std::vector<TriangleId> order = index.order();
  const auto bytes = std::as_bytes(std::span(order));
  Header header(mesh);
  header.order = shared_digest_of(bytes);
  FileReplacement file(path);
  file.write(&header, sizeof header);
  file.write(bytes.data(), bytes.size());
  return file.commit();
}

}  // namespace

std::filesystem::path index_cache_file(const Mesh& mesh, const std::filesystem::path& folder) {
  return file_of(mesh_digest(mesh), folder);
}

std::unique_ptr<WideBvh> load_index(std::shared_ptr<const Mesh> mesh,
                                    const std::filesystem::path& file) {
  const Digest digest = mesh_digest(*mesh);
  return load(std::move(mesh), digest, file);
}

bool save_index(const WideBvh& index, const std::filesystem::path& file) {
  return !save(index, mesh_digest(index.mesh()), file);
}

std::unique_ptr<WideBvh> load_or_build(std::shared_ptr<const Mesh> mesh,
                                       const std::filesystem::path& folder,
                                       const std::function<void(const std::string&)>& warn) {
  const Digest digest = mesh_digest(*mesh);
  const std::filesystem::path file = file_of(digest, folder);
  if (std::unique_ptr<WideBvh> index = load(mesh, digest, file)) return index;
  auto index = std::make_unique<WideBvh>(std::move(mesh));
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!error) error = save(*index, digest, file);
  if (error && warn) {
    warn("the index is not stored for the next start: " + file.string() + " cannot be written (" +
         error.message() + ")");
  }
  return index;
}

}  // namespace keepout
