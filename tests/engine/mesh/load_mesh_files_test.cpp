// SPDX-License-Identifier: BSD-3-Clause
// Files that are not what they seem, or cannot be read.
#include <sys/stat.h>
#include <unistd.h>

#include <thread>

#include "engine/mesh/mesh_files.h"

namespace keepout {
namespace {

TEST_F(LoadMesh, WhatIsNotAReadableFileIsAnError) {
  EXPECT_CONTAINS(complaint(folder.path() / "absent.stl"), "no such file");
  EXPECT_CONTAINS(complaint(folder.path()), "directory");
  EXPECT_CONTAINS(complaint("mesh.obj", ""), "empty");
  const fs::path pipe = folder.path() / "pipe.stl";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_CONTAINS(complaint(pipe), "not a regular file; copy");
  const fs::path circle = folder.path() / "circle.stl";
  fs::create_symlink(circle, circle);
  EXPECT_CONTAINS(complaint(circle), "symbolic links");
}

TEST_F(LoadMesh, WhatAFileSaysIsQuotedWithoutControlCharacters) {
  const std::string name = "\x1b[2J" + std::string(1000, 'n');
  const Surface triangle = single_triangle();
  for (const std::string& ply : {as_text_ply(triangle), as_binary_ply<float>(triangle, false)}) {
    const std::string element = "element " + name + " 9\nproperty list uint double q\n";
    const std::string message =
        complaint("mesh.ply", replaced(ply, "element vertex", element + "element vertex"));
    EXPECT_CONTAINS(message, "'?[2Jnnn");
    EXPECT_LT(message.size(), 200u);
  }
}

TEST_F(LoadMesh, AFileWithoutPermissionIsAnError) {
  if (geteuid() == 0) GTEST_SKIP() << "root may read everything";
  const fs::path path = folder.write("mesh.off", square_off);
  fs::permissions(path, fs::perms::none);
  EXPECT_CONTAINS(complaint(path), "permissions");
}

TEST_F(LoadMesh, AnUnknownExtensionIsAnErrorListingTheKnown) {
  for (const std::string_view name : {"mesh.vtk", "mesh", "stl", "mesh.stl.bak"}) {
    const std::string message = complaint(name, square_off);
    EXPECT_CONTAINS(message, ".stl, .ply, .obj, .off");
  }
}

TEST_F(LoadMesh, ACompressedFileIsAnErrorWhateverItsExtension) {
  for (const std::string_view name : {"mesh.stl", "mesh.obj", "mesh.stl.gz"}) {
    EXPECT_CONTAINS(complaint(name, "\x1f\x8b\x08 and so on"), "unpack");
  }
}

TEST_F(LoadMesh, ContentOfAnotherFormatIsAnErrorNamingIt) {
  EXPECT_CONTAINS(complaint("mesh.stl", as_text_ply(tetrahedron())), ".ply");
  EXPECT_CONTAINS(complaint("mesh.obj", square_off), ".off");
  EXPECT_CONTAINS(complaint("mesh.ply", as_text_stl(tetrahedron())), ".stl");
  EXPECT_CONTAINS(complaint("mesh.off", as_obj(tetrahedron())), "expected 'OFF'");
  EXPECT_CONTAINS(complaint("mesh.obj", "Dear diary,\nnothing today.\n"), "hardly an OBJ file");
}

TEST_F(LoadMesh, SeveralThreadsMayLoadAtOnce) {
  std::vector<fs::path> paths;
  for (const Format& format : formats()) {
    paths.push_back(folder.write(format.name + format.file, format.write(round_torus())));
  }
  std::vector<std::size_t> counts(4, 0);
  std::vector<std::thread> threads;
  for (std::size_t& count : counts) {
    threads.emplace_back([&] {
      for (const fs::path& path : paths) count += load_mesh(path).mesh->triangle_count();
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::size_t count : counts) EXPECT_EQ(count, formats().size() * 128u);
}

}  // namespace
}  // namespace keepout
