// SPDX-License-Identifier: BSD-3-Clause
// RAS and LPS: the space that a file states, and conversion on request.

#include "engine/mesh/mesh_files.h"
#include "trials.h"

namespace keepout {
namespace {

using enum AnatomicalSpace;

// Writers in the style of 3D Slicer.

std::string slicer_binary_stl(const Surface& surface, std::string header) {
  header.resize(80, '\0');
  return as_binary_stl(surface).replace(0, 80, header);
}

std::string slicer_text_stl(const Surface& surface, const std::string& header) {
  return replaced(as_text_stl(surface), "a name with facet in it", header);
}

std::string slicer_ply(std::string contents, const std::string& comment) {
  return replaced(
      std::move(contents), "comment made by hand",
      "comment VTK generated PLY File\nobj_info vtkPolyData points and polygons: vtk4.0\n"
      "comment " +
          comment);
}

std::string slicer_obj(const Surface& surface, const std::string& comment) {
  return "# " + comment + "\n\n" + as_obj(surface);
}

struct Tagged {
  std::string name, file;
  std::function<std::string(const Surface&, const std::string&)> write;
};

void PrintTo(const Tagged& format, std::ostream* out) { *out << format.name; }

class TaggedMesh : public LoadMesh, public testing::WithParamInterface<Tagged> {
 protected:
  LoadedMesh load_tagged(const std::string& tag, const LoadOptions& options = {}) const {
    return load_mesh(write(tag), options);
  }
  std::string complaint_about(const std::string& tag, const LoadOptions& options = {}) const {
    return error_of([&] { load_mesh(write(tag), options); });
  }
  fs::path write(const std::string& tag) const {
    return folder.write(GetParam().file, GetParam().write(round_torus(), tag));
  }
};

const std::vector<Tagged>& tagged_formats() {
  static const std::vector<Tagged> all{
      {"BinaryStl", "mesh.stl", slicer_binary_stl},
      {"TextStl", "mesh.stl", slicer_text_stl},
      {"TextPly", "mesh.ply",
       [](const Surface& s, const std::string& tag) { return slicer_ply(as_text_ply(s), tag); }},
      {"BinaryPly", "mesh.ply",
       [](const Surface& s, const std::string& tag) {
         return slicer_ply(as_binary_ply<float>(s, false), tag);
       }},
      {"Obj", "mesh.obj", slicer_obj},
      {"Off", "mesh.off",
       [](const Surface& s, const std::string& tag) {
         return replaced(as_off(s), "OFF\n", "OFF\n# " + tag + "\n");
       }},
      {"Vtk", "mesh.vtk", [](const Surface& s, const std::string& tag) {
         return replaced(as_text_vtk(s), "made by hand", tag);
       }}};
  return all;
}

INSTANTIATE_TEST_SUITE_P(Formats, TaggedMesh, testing::ValuesIn(tagged_formats()), by_name);

TEST_P(TaggedMesh, WhatTheFileStatesIsFound) {
  EXPECT_EQ(load_tagged("3D Slicer output. SPACE=LPS").stated, lps);
  EXPECT_EQ(load_tagged("3D Slicer output. SPACE=RAS").stated, ras);
  EXPECT_EQ(load_tagged("SPACE=LPS").space, lps);
  EXPECT_EQ(load_tagged("nothing of the kind").space, unstated);
}

TEST_P(TaggedMesh, WithoutADemandItIsTakenAsItStandsAndWarnedOf) {
  const LoadedMesh plain = load_tagged("made by hand");
  const LoadedMesh tagged = load_tagged("SPACE=LPS");
  EXPECT_TRUE(plain.warnings.empty());
  ASSERT_EQ(tagged.warnings.size(), 1u);
  EXPECT_CONTAINS(tagged.warnings[0], "SPACE=LPS: taken as it stands");
  EXPECT_TRUE(std::ranges::equal(plain.mesh->vertices(), tagged.mesh->vertices()));
}

TEST_P(TaggedMesh, OnDemandItIsTurnedByHalfATurnAboutZExactly) {
  const LoadedMesh as_is = load_tagged("SPACE=LPS", {.space = lps});
  const LoadedMesh turned = load_tagged("SPACE=LPS", {.space = ras});
  EXPECT_EQ(as_is.space, lps);
  EXPECT_EQ(turned.space, ras);
  EXPECT_EQ(turned.stated, lps);
  EXPECT_TRUE(as_is.warnings.empty());
  EXPECT_TRUE(turned.warnings.empty());
  EXPECT_TRUE(as_is.notices.empty());
  EXPECT_EQ(turned.notices,
            std::vector<std::string>{GetParam().file + ": turned from LPS to RAS: x and y have "
                                                       "changed their signs"});
  ASSERT_EQ(turned.mesh->vertex_count(), as_is.mesh->vertex_count());
  EXPECT_TRUE(std::ranges::equal(turned.mesh->triangles(), as_is.mesh->triangles()));
  for (VertexId v = 0; v < turned.mesh->vertex_count(); ++v) {
    const Vec3& before = as_is.mesh->vertex(v);
    const Vec3& after = turned.mesh->vertex(v);
    EXPECT_EQ(after, Vec3(-before.x(), -before.y(), before.z()));
    EXPECT_FALSE(after.x() == 0.0 && std::signbit(after.x()));
  }
  for (TriangleId t = 0; t < turned.mesh->triangle_count(); ++t) {
    const Vec3 before = as_is.mesh->normal(t);
    EXPECT_EQ(turned.mesh->normal(t), Vec3(-before.x(), -before.y(), before.z()))
        << "outwards still";
  }
  // A file that already states RAS is not converted.
  EXPECT_TRUE(std::ranges::equal(load_tagged("SPACE=RAS", {.space = ras}).mesh->vertices(),
                                 as_is.mesh->vertices()));
}

TEST_P(TaggedMesh, ADemandOnAFileThatDoesNotSayIsAnErrorThatAsksForTheSpace) {
  const std::string text = complaint_about("made by hand", {.space = ras});
  EXPECT_CONTAINS(text, "does not state its space");
  EXPECT_CONTAINS(text, "--untagged");
  EXPECT_EQ(load_tagged("made by hand", {.space = ras, .untagged = ras}).space, ras);
  const LoadedMesh turned = load_tagged("made by hand", {.space = ras, .untagged = lps});
  EXPECT_EQ(turned.mesh->vertex(0).x(), -load_tagged("made by hand").mesh->vertex(0).x());
  EXPECT_EQ(turned.stated, unstated);
  EXPECT_EQ(load_tagged("made by hand", {.untagged = lps}).space, lps);
  // A stated space has priority over `untagged`.
  EXPECT_EQ(load_tagged("SPACE=RAS", {.untagged = lps}).space, ras);
}

TEST_P(TaggedMesh, TagsAreFoundInAnyCaseAndWithBlanks) {
  for (const char* tag :
       {"space=lps", "Space = LPS", "SPACE\t=\tlps", "x,SPACE=LPS,COLOR=rgba", "SPACE=LPS.",
        "(SPACE=LPS)", "COLORSPACE=RGB SPACE=LPS", "SPACE SPACE=LPS",
        "space=left-posterior-superior", "SPACE=LPS SPACE=lps"}) {
    EXPECT_EQ(load_tagged(tag).stated, lps) << tag;
  }
}

TEST_P(TaggedMesh, WhatLooksLikeATagButIsNoneIsPassedOver) {
  for (const char* tag :
       {"COLORSPACE=RAS", "WORK_SPACE=RAS", "SPACE RAS", "SPACE:RAS", "SPACE=", "SPACE",
        "SPACE==RAS", "SPACE=RASTER", "SPACE=R", "SPACE=4", "aspace=lps", "SPACE=RAR", "=RAS"}) {
    const LoadedMesh loaded = load_tagged(tag);
    EXPECT_EQ(loaded.stated, unstated) << tag;
    EXPECT_TRUE(loaded.warnings.empty()) << tag;
  }
}

TEST_P(TaggedMesh, ContradictingTagsAreRefused) {
  EXPECT_CONTAINS(complaint_about("SPACE=LPS SPACE=RAS"), "LPS and RAS, which cannot both be");
  EXPECT_CONTAINS(complaint_about("SPACE=LPS, space = las", {.space = lps}), "LPS and LAS");
}

TEST_P(TaggedMesh, AnotherSpaceIsWarnedOfAndNeverTurned) {
  const LoadedMesh loaded = load_tagged("SPACE=LAS", {.untagged = ras});
  EXPECT_EQ(loaded.space, unstated);
  ASSERT_EQ(loaded.warnings.size(), 1u);
  EXPECT_CONTAINS(loaded.warnings[0], "SPACE=LAS, which is neither RAS nor LPS");
  EXPECT_CONTAINS(complaint_about("SPACE=LAS", {.space = ras, .untagged = ras}), "SPACE=LAS");
}

TEST_F(LoadMesh, ATagAtTheEndOfAnStlHeaderCountsAndBeyondItDoesNot) {
  const std::string tag = "SPACE=LPS";
  const std::string at_the_end = std::string(80 - tag.size(), 'x');
  const Surface surface = tetrahedron();
  EXPECT_EQ(load("a.stl", slicer_binary_stl(surface, at_the_end.substr(1) + " " + tag)).stated,
            lps);
  EXPECT_EQ(load("b.stl", slicer_binary_stl(surface, at_the_end + tag)).stated, unstated)
      << "part of a word";
  EXPECT_EQ(load("c.stl", slicer_binary_stl(surface, at_the_end + "  SPACE=L")).stated, unstated);
  // A binary file may begin with "solid".
  EXPECT_EQ(load("d.stl", slicer_binary_stl(surface, "solid x SPACE=RAS")).stated, ras);
}

TEST_F(LoadMesh, ATagBehindAVeryLongCommentIsFound) {
  const std::string far = std::string(200'000, 'y') + " SPACE=LPS";
  const Surface surface = tetrahedron();
  EXPECT_EQ(load("a.stl", slicer_text_stl(surface, far)).stated, lps);
  EXPECT_EQ(load("b.ply", slicer_ply(as_text_ply(surface), far)).stated, lps);
  EXPECT_EQ(load("c.ply", slicer_ply(as_binary_ply<double>(surface, true), far)).stated, lps);
  EXPECT_EQ(load("d.obj", slicer_obj(surface, far)).stated, lps);
}

TEST_F(LoadMesh, TagsInOddPlacesAreFound) {
  const Surface surface = tetrahedron();
  EXPECT_EQ(load("end.obj", as_obj(surface) + "# SPACE=RAS\n").stated, ras);
  EXPECT_EQ(load("behind.obj", replaced(as_obj(surface), "o thing", "o thing #SPACE=RAS")).stated,
            ras);
  EXPECT_EQ(load("no_hash.obj", replaced(as_obj(surface), "o thing", "o SPACE=RAS")).stated,
            unstated);
  const std::string text = as_text_stl(surface);
  const std::string end = "endsolid SPACE=RAS\n";
  EXPECT_EQ(load("end.stl", replaced(text, "endsolid a name with facet in it\n", end)).stated, ras);
  EXPECT_EQ(load("upper.stl", replaced(text, "solid a name", "SOLID SPACE=RAS a name")).stated,
            ras);
  // Two solids state different spaces.
  EXPECT_CONTAINS(complaint("two.stl", slicer_text_stl(surface, "one SPACE=LPS") +
                                           slicer_text_stl(surface, "two SPACE=RAS")),
                  "which cannot both be");
  std::string windows = replaced(slicer_text_stl(surface, "SPACE=LPS"), "\n", "\r\n");
  EXPECT_EQ(load("windows.stl", windows).stated, lps);
  windows = replaced(slicer_ply(as_text_ply(surface), "SPACE=LPS"), "\n", "\r\n");
  EXPECT_EQ(load("windows.ply", windows).stated, lps);
  EXPECT_EQ(load("mac.obj", replaced(slicer_obj(surface, "SPACE=LPS"), "\n", "\r")).stated, lps);
}

TEST_F(LoadMesh, AUnitOtherThanMillimetresThatTheFileStatesIsWarnedOf) {
  const std::string start = "vertex coordinates are measured in units, where 1 unit = ";
  const Surface surface = tetrahedron();
  const LoadedMesh metres = load_unchecked("a.obj", slicer_obj(surface, start + "1000.000000 mm"));
  ASSERT_EQ(metres.warnings.size(), 1u);
  EXPECT_CONTAINS(metres.warnings[0],
                  "a.obj: the file states that 1 unit is 1000 mm, but nothing is scaled");
  EXPECT_EQ(metres.mesh->bounds().high.x(), 1.0);
  EXPECT_TRUE(load_unchecked("b.obj", slicer_obj(surface, start + "1.000000 mm")).warnings.empty());
  for (const char* odd : {"-3 mm", "nan mm", "1000 parsecs", "mm", "1e999 mm", ""}) {
    EXPECT_TRUE(load_unchecked("c.obj", slicer_obj(surface, start + odd)).warnings.empty()) << odd;
  }
}

}  // namespace
}  // namespace keepout
