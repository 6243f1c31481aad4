// SPDX-FileCopyrightText: 2026 the keepout authors
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
#include "../file_replacement.h"
#include "../read_only_file.h"
#include "keepout/error.h"

namespace keepout {
namespace {

/// Counted up with every change of what is in the file, or of what it means.
constexpr std::uint32_t version = 1;

constexpr std::string_view magic = "keepout wide_bvh";

/// What a file begins with; nodes and leaves follow, as they are in memory.
struct Header {
  std::array<char, magic.size()> magic_bytes{};
  std::uint32_t file_version = version;
  std::uint32_t byte_order = 0x01020304;  // read as another number where bytes are swapped
  std::uint32_t node_size = sizeof(NodeBlock);
  std::uint32_t leaf_size = sizeof(LeafBlock);
  std::uint64_t nodes = 0;
  std::uint64_t leaves = 0;
  Digest mesh;
  Digest node_digest;
  Digest leaf_digest;
  Digest header;  // of all above

  explicit Header(const Digest& of_mesh) : mesh(of_mesh) {
    std::memcpy(magic_bytes.data(), magic.data(), magic.size());
  }

  Digest own_digest() const {
    return digest_of(std::as_bytes(std::span(this, 1)).first(offsetof(Header, header)));
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

/// The header of a file that is what it says, as far as its length; its body is still to be
/// checked.
bool read_header(const ReadOnlyFile& file, Header& header) {
  const Header expected = header;
  if (!file.is_open() || file.size() < sizeof header) return false;
  if (!file.read(0, &header, sizeof header)) return false;
  // What must be as it is here, is compared at once.
  if (std::memcmp(&header, &expected, offsetof(Header, nodes)) != 0) return false;
  if (header.mesh != expected.mesh) return false;
  if (header.header != header.own_digest()) return false;
  const std::uint64_t room = file.size() - sizeof header;
  return header.nodes <= room / sizeof(NodeBlock) && header.leaves <= room / sizeof(LeafBlock) &&
         header.nodes * sizeof(NodeBlock) + header.leaves * sizeof(LeafBlock) == room;
}

template <class Block>
bool read_blocks(const ReadOnlyFile& file, std::uint64_t offset, const Digest& expected,
                 BlockVector<Block>& blocks) {
  Digest digest;
  return read_with_digest(file, offset, std::as_writable_bytes(std::span(blocks)), digest) &&
         digest == expected;
}

std::unique_ptr<WideBvh> load(std::shared_ptr<const Mesh> mesh, const Digest& digest,
                              const std::filesystem::path& path) {
  const ReadOnlyFile file(path);
  Header header(digest);
  if (!read_header(file, header)) return nullptr;
  BlockVector<NodeBlock> nodes(header.nodes);
  BlockVector<LeafBlock> leaves(header.leaves);
  const std::uint64_t after_nodes = sizeof header + header.nodes * sizeof(NodeBlock);
  if (!read_blocks(file, sizeof header, header.node_digest, nodes)) return nullptr;
  if (!read_blocks(file, after_nodes, header.leaf_digest, leaves)) return nullptr;
  try {
    return std::make_unique<WideBvh>(std::move(mesh), std::move(nodes), std::move(leaves));
  } catch (const Error&) {
    return nullptr;
  }
}

/// Why it could not be written; no error if it was.
std::error_code save(const WideBvh& index, const Digest& mesh, const std::filesystem::path& path) {
  const auto nodes = std::as_bytes(index.nodes());
  const auto leaves = std::as_bytes(index.leaves());
  Header header(mesh);
  header.nodes = index.nodes().size();
  header.leaves = index.leaves().size();
  header.node_digest = shared_digest_of(nodes);
  header.leaf_digest = shared_digest_of(leaves);
  header.header = header.own_digest();
  FileReplacement file(path);
  file.write(&header, sizeof header);
  file.write(nodes.data(), nodes.size());
  file.write(leaves.data(), leaves.size());
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
    warn("the index is not kept for the next time: " + file.string() + " cannot be written (" +
         error.message() + ")");
  }
  return index;
}

}  // namespace keepout
