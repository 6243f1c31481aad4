// SPDX-License-Identifier: BSD-3-Clause
// Requirements on every format.
#include <sys/stat.h>
#include <unistd.h>

#include <thread>

#include "engine/mesh/mesh_files.h"

namespace keepout {
namespace {

class LoadMeshFormat : public LoadMesh, public testing::WithParamInterface<Format> {};

INSTANTIATE_TEST_SUITE_P(Formats, LoadMeshFormat, testing::ValuesIn(formats()), format_name);

TEST_P(LoadMeshFormat, GivesTheSameTrianglesInTheSameOrder) {
  const Surface surface = weld(round_torus());
  const LoadedMesh loaded = load(GetParam().file, GetParam().write(surface));
  ASSERT_EQ(loaded.mesh->triangle_count(), surface.triangles.size());
  EXPECT_EQ(loaded.mesh->vertex_count(), surface.vertices.size());
  for (TriangleId t = 0; t < surface.triangles.size(); ++t) {
    ASSERT_EQ(loaded.mesh->corners(t), surface.triangles[t]) << t;
    for (int i = 0; i < 3; ++i) {
      ASSERT_EQ(loaded.mesh->triangle(t)[i], surface.vertices[surface.triangles[t][i]]) << t;
    }
  }
  EXPECT_TRUE(loaded.warnings.empty()) << loaded.warnings.front();
}

TEST_P(LoadMeshFormat, ReadsAFileOfOneTriangle) {
  EXPECT_EQ(load(GetParam().file, GetParam().write(single_triangle())).mesh->triangle_count(), 1u);
}

TEST_P(LoadMeshFormat, TakesTheExtensionInAnyCase) {
  std::string name = GetParam().file;
  for (char& c : name) c = static_cast<char>(std::toupper(c));
  EXPECT_EQ(load(name, GetParam().write(tetrahedron())).mesh->triangle_count(), 4u);
}

TEST_P(LoadMeshFormat, CutShortAnywhereItIsAnErrorOrWarnsOfIt) {
  const std::string whole = GetParam().write(tetrahedron());
  const bool has_counts = GetParam().name != "Obj";
  const bool ends_with_a_number = !has_counts || GetParam().name == "Off" ||
                                  GetParam().name == "TextPly" || GetParam().name == "TextVtk";
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const std::string contents = whole.substr(0, length);
    // Only white space may be missing from a text without an error.
    const std::string_view lacking = std::string_view(whole).substr(length);
    const bool lacks_nothing = lacking.find_first_not_of(" \n") == std::string_view::npos;
    std::size_t triangles = 0;
    try {
      const LoadedMesh loaded = load_unchecked(GetParam().file, contents);
      triangles = loaded.mesh->triangle_count();
      // OBJ has no counts: cuts within a line cause a warning, cuts between lines are unnoticed.
      if (ends_with_a_number && !contents.ends_with('\n')) {
        ASSERT_FALSE(loaded.warnings.empty()) << length;
      }
    } catch (const Error& error) {
      ASSERT_GT(std::strlen(error.what()), folder.path().string().size() + 10) << length;
    }
    if (has_counts && triangles > 0) {
      // The cut may be within the last number of a text, or within the name after "endsolid".
      const bool within_last_word = lacking.find_first_of(" \n") == lacking.size() - 1;
      const bool within_name = whole.substr(0, length).find("endsolid") != std::string::npos;
      ASSERT_TRUE(lacks_nothing || within_last_word || within_name) << length;
      ASSERT_EQ(triangles, 4u) << length;
    }
  }
}

TEST_P(LoadMeshFormat, WithBytesChangedItLoadsOrIsAnErrorNamingTheFile) {
  const std::string whole = GetParam().write(tetrahedron());
  std::mt19937 random(7);
  constexpr std::string_view hostile("\0\n\r -.e/#\\0913xf\xff\x80", 19);
  int loaded = 0, refused = 0;
  for (int i = 0; i < 1500; ++i) {
    std::string contents = whole;
    for (auto changes = 1 + random() % 3; changes > 0; --changes) {
      const std::size_t at = random() % contents.size();
      switch (random() % 4) {
        case 0:
          contents[at] = hostile[random() % hostile.size()];
          break;
        case 1:
          contents[at] = static_cast<char>(random());
          break;
        case 2:
          contents.erase(at, 1 + random() % 8);
          break;
        default:
          contents.insert(at, contents.substr(random() % contents.size(), random() % 12));
      }
      if (contents.empty()) contents = "x";
    }
    const fs::path path = folder.write(GetParam().file, contents);
    try {
      ASSERT_GE(load_mesh(path).mesh->triangle_count(), 1u);
      ++loaded;
    } catch (const Error& error) {
      ASSERT_TRUE(std::string_view(error.what()).starts_with(path.string())) << error.what();
      ++refused;
    }
  }
  EXPECT_GT(loaded, 0);
  EXPECT_GT(refused, 0);
}

/// Text formats with free layout, without VTK and VTP.
class LoadMeshText : public LoadMeshFormat {};

INSTANTIATE_TEST_SUITE_P(Formats, LoadMeshText,
                         testing::Values(formats()[1], formats()[2], formats()[6], formats()[7]),
                         format_name);

TEST_P(LoadMeshText, LineEndsMayBeThoseOfAnySystem) {
  const std::string text = GetParam().write(tetrahedron());
  for (const std::string_view line_end : {"\r\n", "\r", "\n\n", " \t\r\n  \r\n"}) {
    const LoadedMesh loaded = load(GetParam().file, replaced(text, "\n", line_end));
    EXPECT_EQ(loaded.mesh->triangle_count(), 4u);
    EXPECT_EQ(loaded.mesh->vertex_count(), 4u);
  }
}

TEST_P(LoadMeshText, TheLastLineNeedsNoEnd) {
  std::string text = GetParam().write(tetrahedron());
  text.pop_back();
  EXPECT_EQ(load(GetParam().file, text).mesh->triangle_count(), 4u);
}

TEST_P(LoadMeshText, AByteOrderMarkIsNoMatter) {
  const std::string text = "\xEF\xBB\xBF" + GetParam().write(tetrahedron());
  EXPECT_EQ(load(GetParam().file, text).mesh->triangle_count(), 4u);
}

TEST_P(LoadMeshText, NumbersThatAreNotFiniteAreErrorsWithTheirLine) {
  const Surface surface = moved(tetrahedron(), {0.25, 0, 0});
  const std::string text = GetParam().write(surface);
  for (const std::string_view bad : {"nan", "NaN", "-nan", "inf", "-Infinity"}) {
    const std::string message = complaint(GetParam().file, replaced(text, "0.25", bad));
    EXPECT_CONTAINS(message, ": line ");
    EXPECT_CONTAINS(message, "not finite");
  }
}

TEST_P(LoadMeshText, WhatIsNoNumberIsAnErrorWithItsLine) {
  const std::string text = GetParam().write(moved(tetrahedron(), {0.25, 0, 0}));
  for (const std::string_view bad :
       {"0,25", "0.2.5", "0x1p3", "1e", "1d5", "--1", "+-1", "1e99999", "."}) {
    const std::string message = complaint(GetParam().file, replaced(text, "0.25", bad));
    EXPECT_CONTAINS(message, ": line ");
    EXPECT_CONTAINS(message, "expected a number, found '" + std::string(bad) + "'");
  }
}

TEST_P(LoadMeshText, ANumberBeyondSinglePrecisionIsAnError) {
  const std::string text = GetParam().write(moved(tetrahedron(), {0.25, 0, 0}));
  EXPECT_CONTAINS(complaint(GetParam().file, replaced(text, "0.25", "1e39")), "not finite");
}

TEST_P(LoadMeshText, NumbersMayBeWrittenInAnyCommonWay) {
  const std::string text = GetParam().write(moved(tetrahedron(), {0.25, 0, 0}));
  for (const std::string_view same :
       {".25", "+.25", "+0.25", "0.250", "25e-2", "2.5E-01", "00.25", "250.e-3", "0.025e+1"}) {
    const LoadedMesh loaded = load(GetParam().file, replaced(text, "0.25", same));
    EXPECT_NEAR(loaded.mesh->bounds().low.x(), 0.25, 1e-7) << same;
    EXPECT_EQ(loaded.mesh->vertex_count(), 4u) << same;
  }
  // A decimal point may follow the sign.
  const LoadedMesh loaded = load(GetParam().file, replaced(text, "0.25", "-.25"));
  EXPECT_EQ(loaded.mesh->bounds().low.x(), -0.25);
}

TEST_P(LoadMeshText, ANumberMayHaveAnyNumberOfDigits) {
  const std::string text = GetParam().write(moved(tetrahedron(), {0.25, 0, 0}));
  const std::string digits = "0.25" + std::string(200, '0') + "1";
  EXPECT_EQ(load(GetParam().file, replaced(text, "0.25", digits)).mesh->bounds().low.x(), 0.25);
  const LoadedMesh far =
      load_unchecked(GetParam().file, replaced(text, "0.25", "-12345678901234567890"));
  EXPECT_NEAR(far.mesh->bounds().low.x(), -12345678901234567890.0, 1e12);
}

TEST_P(LoadMeshText, ANumberTooSmallForItsTypeIsZero) {
  const std::string text = GetParam().write(moved(tetrahedron(), {0.25, 0, 0}));
  for (const std::string_view tiny : {"1e-400", "-1e-400", "0e400"}) {
    const LoadedMesh loaded = load(GetParam().file, replaced(text, "0.25", tiny));
    EXPECT_EQ(loaded.mesh->bounds().low.x(), 0.0) << tiny;
  }
}

TEST_P(LoadMeshText, TextIsReadToTheNearestNumberAsDocumented) {
  // As load_mesh.h specifies: the text PLY here declares floats, the other formats declare no type.
  const bool is_ply = GetParam().name == "TextPly";
  for (const double scale : {0.01, 1.0, 100.0}) {
    const Surface surface = enlarged(torus(40), scale);
    for (const auto style : {std::ios_base::fixed, std::ios_base::scientific}) {
      notation = style;
      const std::string contents = GetParam().write(surface);
      const auto written = [&](double x) {
        return is_ply ? std::strtof(number(x).c_str(), nullptr)
                      : std::strtod(number(x).c_str(), nullptr);
      };
      const LoadedMesh loaded = load_unchecked(GetParam().file, contents);
      for (TriangleId t = 0; t < surface.triangles.size(); ++t) {
        for (int i = 0; i < 3; ++i) {
          for (int axis = 0; axis < 3; ++axis) {
            ASSERT_EQ(loaded.mesh->triangle(t)[i][axis],
                      written(surface.vertices[surface.triangles[t][i]][axis]))
                << "scale " << scale << ", notation " << style;
          }
        }
      }
      notation = {};
    }
  }
}

TEST_P(LoadMeshText, WhatWasPrintedFromFloatsIsReadAsFloats) {
  for (const int some : {3, 6, 7, 8, 9, 12, 17}) {
    for (const double scale : {1e-3, 1.0, 320.0}) {
      const Surface surface = as_floats(enlarged(torus(20), scale));
      digits = some;
      const std::string contents = GetParam().write(surface);
      digits = 9;
      const LoadedMesh loaded = load_unchecked(GetParam().file, contents);
      for (TriangleId t = 0; t < surface.triangles.size(); ++t) {
        for (int i = 0; i < 3; ++i) {
          const Vec3 read = loaded.mesh->triangle(t)[i];
          ASSERT_EQ(read, (read.cast<float>().cast<double>().eval())) << some;
          if (some < 9) continue;  // fewer than 9 digits do not identify a float
          ASSERT_EQ(read, surface.vertices[surface.triangles[t][i]]) << some;
        }
      }
    }
  }
}

TEST_P(LoadMeshText, ANumeralThatNoFloatIsPrintedInIsReadAsADouble) {
  const std::string text = GetParam().write(moved(tetrahedron(), {0.25, 0, 0}));
  const bool declares_floats = GetParam().name == "TextPly";
  for (const std::string_view numeral :
       {"-100.33333333", "-1003333.3333e-4", "-1.0033333333E+02"}) {
    const double exact = std::strtod(numeral.data(), nullptr);
    const LoadedMesh loaded = load(GetParam().file, replaced(text, "0.25", numeral));
    EXPECT_EQ(loaded.mesh->bounds().low.x(), declares_floats ? static_cast<float>(exact) : exact);
  }
}

TEST_F(LoadMesh, BinaryCoordinatesAreExact) {
  const Surface surface = weld(as_floats(torus(30)));
  for (const int f : {0, 3, 4, 5}) {
    const LoadedMesh loaded = load(formats()[f].file, formats()[f].write(surface));
    ASSERT_EQ(loaded.mesh->vertex_count(), surface.vertices.size());
    for (VertexId v = 0; v < surface.vertices.size(); ++v) {
      ASSERT_EQ(loaded.mesh->vertex(v), surface.vertices[v]) << formats()[f].name;
    }
  }
}

TEST_F(LoadMesh, DoublesInBinaryPlyAreExact) {
  Surface surface = single_triangle();
  surface.vertices[1].x() = 0.1;
  surface.vertices[2].y() = 1e-300;
  for (const bool big_endian : {false, true}) {
    const LoadedMesh loaded = load("mesh.ply", as_binary_ply<double>(surface, big_endian));
    EXPECT_EQ(loaded.mesh->vertex(1).x(), 0.1);
    EXPECT_EQ(loaded.mesh->vertex(2).y(), 1e-300);
  }
}

TEST_F(LoadMesh, ABinaryPlyWithACoordinateThatIsNotFiniteIsAnErrorNamingTheVertex) {
  for (const double bad : {std::nan(""), -HUGE_VAL}) {
    Surface surface = tetrahedron();
    surface.vertices[2].z() = bad;
    EXPECT_CONTAINS(complaint("mesh.ply", as_binary_ply<double>(surface, false)), "vertex 2");
    EXPECT_CONTAINS(complaint("mesh.ply", as_binary_ply<float>(surface, true)), "not finite");
  }
}

TEST_F(LoadMesh, ABinaryPlyWhoseFirstByteIsALineFeedIsReadInPlace) {
  // The byte follows the line feed that ends the header.
  Surface surface = single_triangle();
  surface.vertices[0].x() = double{std::bit_cast<float>(0x3F80000Au)};
  const LoadedMesh loaded = load("mesh.ply", as_binary_ply<float>(surface, false));
  EXPECT_EQ(loaded.mesh->vertex(0).x(), surface.vertices[0].x());
  EXPECT_EQ(loaded.mesh->vertex(2).y(), 1.0);
}

TEST_F(LoadMesh, LargeFilesAreReadToTheirEnd) {
  const Surface surface = weld(torus(420));
  for (const int f : {2, 3, 6}) {
    const std::string contents = formats()[f].write(surface);
    if (f == 6) {
      ASSERT_GT(contents.size(), 17u << 20);
    }
    const LoadedMesh loaded = load(formats()[f].file, contents);
    ASSERT_EQ(loaded.mesh->triangle_count(), surface.triangles.size());
    ASSERT_EQ(loaded.mesh->vertex_count(), surface.vertices.size());
    for (VertexId v = 0; v < surface.vertices.size(); ++v) {
      ASSERT_LT((loaded.mesh->vertex(v) - surface.vertices[v]).norm(), 1e-6);
    }
  }
}

// Files that cannot be read, or whose content contradicts their name.

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
  for (const std::string_view name : {"mesh.vtu", "mesh", "stl", "mesh.stl.bak"}) {
    const std::string message = complaint(name, square_off);
    EXPECT_CONTAINS(message, ".stl, .ply, .obj, .off, .vtk, .vtp");
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
