// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/mesh/binary_ply.h"

#include <sstream>

#include "keepout/mesh/binary_stl.h"
#include "meshes.h"
#include "temporary_folder.h"

namespace keepout {
namespace {

template <class Write>
std::string written(const Write& write, const Surface& surface, AnatomicalSpace space) {
  std::ostringstream out;
  write(out, surface, space);
  return out.str();
}

std::string ply_of(const Surface& surface, AnatomicalSpace space = AnatomicalSpace::unstated) {
  return written(write_binary_ply, surface, space);
}

TEST(WriteBinaryPly, AllDigitsComeBack) {
  const TemporaryFolder folder;
  for (const double scale : {1.0, 1.0 / 3.0}) {
    Surface surface = weld(torus(12));
    for (Vec3& v : surface.vertices) {
      v = (scale == 1.0 ? v.cast<float>().cast<double>() : Vec3(scale * v)).eval();
    }
    const std::string bytes = ply_of(surface);
    EXPECT_EQ(bytes.find("property float x") != std::string::npos, scale == 1.0);
    const LoadedMesh loaded = load_mesh(folder.write("mesh.ply", bytes));
    EXPECT_EQ(loaded.vertices_in_file, surface.vertices.size());
    EXPECT_TRUE(std::ranges::equal(loaded.mesh->vertices(), surface.vertices));
    EXPECT_TRUE(std::ranges::equal(loaded.mesh->triangles(), surface.triangles));
  }
}

TEST(WriteBinaryPly, TheSpaceComesBackOfStlToo) {
  const TemporaryFolder folder;
  const Surface surface = tetrahedron();
  const auto stl = [](std::ostream& out, const Surface& of, AnatomicalSpace space) {
    write_binary_stl(out, of, space);
  };
  for (const AnatomicalSpace space :
       {AnatomicalSpace::unstated, AnatomicalSpace::ras, AnatomicalSpace::lps}) {
    EXPECT_EQ(load_mesh(folder.write("a.ply", ply_of(surface, space))).stated, space);
    const LoadedMesh read = load_mesh(folder.write("a.stl", written(stl, surface, space)));
    EXPECT_EQ(read.stated, space);
    EXPECT_EQ(read.vertices_in_file, 12u);
  }
}

}  // namespace
}  // namespace keepout
