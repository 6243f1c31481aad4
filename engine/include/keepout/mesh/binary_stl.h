// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "keepout/mesh/mesh.h"

namespace keepout {

/// True if the file is as long as the binary STL that its header declares: 84 + 50 n bytes. What it
/// begins with does not matter, for many a binary file begins with "solid". False if there is no
/// such file, or if it cannot be read.
bool is_binary_stl(const std::filesystem::path& path);

/// Reads a binary STL file as it stands: three vertices for each triangle, not welded; normals and
/// attributes are ignored. Throws Error when it is not one, has no triangles, or holds a coordinate
/// that is not finite.
Surface read_binary_stl(const std::filesystem::path& path);

/// weld(read_binary_stl(path)), at once: faster, and in little more memory than the result takes.
///
/// `threads`: at most; 0 for as many as there are processors. The result is the same.
Surface read_welded_stl(const std::filesystem::path& path, unsigned threads = 0);

/// Writes a binary STL file: whole or not at all, for it is renamed into place when complete.
/// Coordinates are rounded to single precision, which is all that the format holds. Throws Error,
/// also when a coordinate does not fit.
void write_binary_stl(const std::filesystem::path& path, const Surface& surface);
/// The same for a mesh.
void write_binary_stl(const std::filesystem::path& path, const Mesh& mesh);

/// The same, triangle by triangle: for surfaces that no memory holds.
class BinaryStlWriter {
 public:
  /// Of a file of so many triangles.
  BinaryStlWriter(const std::filesystem::path& path, std::uint64_t triangles);
  /// Without a commit nothing is left.
  ~BinaryStlWriter();
  BinaryStlWriter(const BinaryStlWriter&) = delete;
  BinaryStlWriter& operator=(const BinaryStlWriter&) = delete;

  /// The next triangle, and its normal.
  void write(const Triangle& corners);

  /// Puts the file into its place. Precondition: as many triangles were written as declared.
  void commit();

 private:
  class File;
  std::unique_ptr<File> file_;
};

}  // namespace keepout
