// SPDX-License-Identifier: BSD-3-Clause
// Legacy VTK and VTP: valid content, and errors.
#include <sys/resource.h>

#include "engine/mesh/mesh_files.h"

namespace keepout {
namespace {

using Mode = VtpStyle::Format;

// Legacy VTK.

const std::string points = "POINTS 4 float\n0 0 0 1 0 0\n0 1 0 0 0 1\n";
const std::string faces = "POLYGONS 4 16\n3 0 2 1\n3 0 1 3 3 1 2 3\n3 2 0 3\n";

std::string text_vtk(const std::string& body, const std::string& version = "3.0") {
  return vtk_title("ASCII", version) + body;
}

TEST_F(LoadMesh, VtkNumbersMayStandOnAnyLines) {
  const LoadedMesh loaded = load_unchecked("mesh.vtk", text_vtk(points + faces));
  EXPECT_EQ(loaded.mesh->triangle_count(), 4u);
  EXPECT_TRUE(loaded.warnings.empty());
  for (const char* version : {"1.0", "2.0", "3.0", "4.2"}) {
    EXPECT_EQ(load("mesh.vtk", text_vtk(points + faces, version)).mesh->triangle_count(), 4u);
  }
}

TEST_F(LoadMesh, VtkStripsAlternateTheirWinding) {
  for (const auto& [version, strip] :
       {std::pair("4.2", "TRIANGLE_STRIPS 1 6\n5 0 1 2 3 4\n"),
        std::pair("5.1",
                  "TRIANGLE_STRIPS 2 5\nOFFSETS vtktypeint64\n0 5\nCONNECTIVITY "
                  "vtktypeint64\n0 1 2 3 4\n")}) {
    const LoadedMesh loaded = load_unchecked(
        "mesh.vtk",
        text_vtk("POINTS 5 float\n0 0 0 1 0 0 0 1 0 1 1 0 0 2 0\n" + std::string(strip), version));
    ASSERT_EQ(loaded.mesh->triangle_count(), 3u);
    for (TriangleId t = 0; t < 3; ++t) EXPECT_EQ(loaded.mesh->normal(t), Vec3(0, 0, 1)) << t;
  }
}

TEST_F(LoadMesh, VtkPolygonsAreCutAndLinesAndDataAreLeftOut) {
  const std::string body =
      "METADATA\nCOMPONENT_NAMES\nX\nPOLYGONS\n\nVERTICES 1 2\n1 0\nLINES 2 6\n2 0 1 2 1 2\n"
      "POLYGONS 1 5\n4 0 1 2 3\nCELL_DATA 1\nSCALARS s float 1\nLOOKUP_TABLE default\nnan\n";
  const LoadedMesh loaded = load_unchecked("mesh.vtk", text_vtk(points + body));
  EXPECT_EQ(loaded.mesh->triangle_count(), 2u);
  EXPECT_EQ(loaded.warnings, std::vector<std::string>{"mesh.vtk: 3 lines or points are left out"});
}

TEST_F(LoadMesh, AVtkFieldMayNameTheSpace) {
  const std::string text =
      text_vtk("FIELD FieldData 2\nTime 1 2 double\n1 2\nSPACE 1 1 string\nLPS\n" + points + faces);
  EXPECT_EQ(load("mesh.vtk", text).stated, AnatomicalSpace::lps);
  std::string binary = as_binary_vtk<float>(tetrahedron());
  std::string field = "FIELD FieldData 2\nSPACE 1 1 string\n\xc3LPS\nbytes 2 2 unsigned_char\n";
  field += std::string("\0\n\xff\r", 4) + "\n";
  binary.insert(binary.find("POINTS"), field);
  const LoadedMesh loaded = load("mesh.vtk", binary);
  EXPECT_EQ(loaded.stated, AnatomicalSpace::lps);
  EXPECT_EQ(loaded.mesh->triangle_count(), 4u);
}

TEST_F(LoadMesh, VtkFieldsMayHoldAnyTypeOfVtk) {
  // The text is as VTK 9.1 writes it.
  const std::string text =
      "FIELD FieldData 6\nbits 1 11 bit\n0 1 0 1 0 1 0 1\n0 1 0 \nsmall 1 2 signed_char\n-3 7 \n"
      "any 1 3 variant\n6 3\n13 a%20b%0Ac\n0 \nMETADATA\nCOMPONENT_NAMES\n\n\n"
      "unicode 1 2 utf8_string\nh%C3%A9%20llo\n\n\nnull 1 1 double\n7\n"
      "SPACE 1 1 string\nLPS\n";
  const LoadedMesh loaded = load("mesh.vtk", text_vtk(text + points + faces));
  EXPECT_EQ(loaded.stated, AnatomicalSpace::lps);
  EXPECT_EQ(loaded.mesh->triangle_count(), 4u);
  std::string field = "FIELD FieldData 5\nbits 1 11 bit\n";
  field += std::string("\n\0\n", 3) + "small 1 2 signed_char\n\xfd\n\n";
  field += "any 1 3 variant\n6 3\n13 a%20b%0Ac\n0 \n";
  field += "unicode 1 2 utf8_string\n\xc7h\xc3\xa9\nllo\xc0\nSPACE 1 1 string\n\xc3LPS\n";
  std::string binary = as_binary_vtk<float>(tetrahedron());
  binary.insert(binary.find("POINTS"), field);
  EXPECT_EQ(load("mesh.vtk", binary).stated, AnatomicalSpace::lps);
}

TEST_F(LoadMesh, VtkMetadataMayHaveComponentsWithoutANameAndNoBlankLine) {
  const std::string information =
      "INFORMATION 1\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 0 1\n";
  const std::string strip = "TRIANGLE_STRIPS 1 4\n3 0 1 2\n";
  for (const std::string& metadata :
       std::vector<std::string>{"METADATA\nCOMPONENT_NAMES\nX\n\n\n\n",
                                "METADATA\nCOMPONENT_NAMES\nX\n\n\n" + information + "\n",
                                "METADATA\nCOMPONENT_NAMES\nX\n\nlines\n\n",
                                "METADATA\n" + information, "METADATA\nCOMPONENT_NAMES\nX\n"}) {
    const LoadedMesh loaded =
        load_unchecked("mesh.vtk", text_vtk(points + metadata + faces + metadata + strip));
    EXPECT_EQ(loaded.mesh->triangle_count(), 5u) << metadata;
  }
}

TEST_F(LoadMesh, VtkThatIsMalformedIsAnErrorWithItsLine) {
  const std::string good = text_vtk(points + faces);
  expect_faults("mesh.vtk", good,
                {{"3.0", "6.0", "line 1: expected '# vtk DataFile Version'"},
                 {"ASCII", "MORSE", "line 3: expected 'ASCII' or 'BINARY'"},
                 {"POLYDATA", "UNSTRUCTURED_GRID", "only POLYDATA is a surface"},
                 {"POINTS 4", "POINTS 3", "line 7: more numbers than the 9"},
                 {"POINTS 4", "POINTS 5", "only 12 before 'POLYGONS'"},
                 {"POINTS 4", "POINTS 40000000000", "more than the file has room for"},
                 {"POINTS 4", "POINTS 18446744073709551615", "more than the file has room"},
                 {"POINTS 4 float", "POINTS 4", "needs 2 words"},
                 {"float", "quaternion", "unknown type 'quaternion'"},
                 {"POLYGONS 4 16", "POLYGONS 3 16", "declares 3 cells, but has 4"},
                 {"3 1 2 3\n3 2 0 3\n", "3 1 200000 3\n3 2 0", "ends within its 'POLYGONS'"},
                 {"POLYGONS 4 16", "POLYGONS 4 17", "more than the file has room for"},
                 {"3 2 0 3", "4 2 0 3", "fewer corners than it declares"},
                 {"3 2 0 3", "3 2 0 4", "names vertex 4"},
                 {"3 2 0 3", "3 2 0 -1", "expected a whole number, found '-1'"},
                 {"0 0 1\n", "0 0 nan\n", "not finite"},
                 {"POLYGONS", "HEXAGONS", "not understood: 'HEXAGONS'"}});
  EXPECT_CONTAINS(complaint("mesh.vtk", text_vtk(faces + points)), "before the POINTS");
  EXPECT_CONTAINS(complaint("mesh.vtk", text_vtk(points + points)), "twice");
  EXPECT_CONTAINS(complaint("mesh.vtk", text_vtk(points)), "no faces");
  EXPECT_CONTAINS(complaint("mesh.stl", good), "its content is .vtk");
}

TEST_F(LoadMesh, OffsetsOfVtkThatDoNotFitAreErrors) {
  const std::string good = text_vtk(
      points + "POLYGONS 2 3\nOFFSETS vtktypeint64\n0 3\nCONNECTIVITY vtktypeint64\n0 1 2\n",
      "5.1");
  EXPECT_EQ(load("mesh.vtk", good).mesh->triangle_count(), 1u);
  expect_faults("mesh.vtk", good,
                {{"0 3\n", "1 3\n", "first offset"},
                 {"0 3\n", "0 4\n", "from corner 0 to 4 of 3"},
                 {"0 3\n", "0 2\n", "there are 3 corners, but the cells have 2"},
                 {"CONNECTIVITY", "CONNECTION", "expected 'connectivity' and a type"},
                 {"vtktypeint64", "double", "must have integers"}});
}

TEST_F(LoadMesh, BinaryVtkWithACoordinateOrAnIdThatIsNoneIsAnError) {
  std::string vtk = as_binary_vtk<float>(tetrahedron());
  const std::size_t first = vtk.find("float\n") + 6;
  EXPECT_CONTAINS(complaint("mesh.vtk", std::string(vtk).replace(first, 4, "\x7f\xc0\0\0", 4)),
                  "point 0 has a coordinate that is not finite");
  const std::size_t id = vtk.find("CONNECTIVITY vtktypeint64\n") + 26;
  EXPECT_CONTAINS(complaint("mesh.vtk", std::string(vtk).replace(id, 1, "\xff")), "below 0");
}

// VTP.

/// Returns the space that a file by VTK 9.1 states (tests/python/write_vtk_files.py). Files with a
/// title in the style of 3D Slicer state LPS.
AnatomicalSpace space_of(const std::string& name) {
  const bool is_titled = name.ends_with(".vtk") && !name.starts_with("field");
  return is_titled || name == "slicer.vtp" ? AnatomicalSpace::lps : AnatomicalSpace::ras;
}

TEST_F(LoadMesh, FilesThatVtkWroteAreTheSameSphere) {
  const fs::path files = KEEPOUT_VTK_FILES;
  const auto load_file = [&](const fs::path& file) {
    return load_mesh(file, {.check = MeshCheck::none});
  };
  const LoadedMesh expected = load_file(files / "binary42.vtk");
  ASSERT_EQ(expected.mesh->triangle_count(), 20u);
  std::size_t count = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(files)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with('.')) continue;
    SCOPED_TRACE(name);
    ++count;
    const LoadedMesh loaded = load_file(entry.path());
    EXPECT_EQ(loaded.stated, space_of(name));
    EXPECT_EQ(loaded.warnings.size(), 1u);
    ASSERT_EQ(loaded.mesh->triangle_count(), 20u);
    EXPECT_EQ(loaded.mesh->vertex_count(), 12u);
    // Strips change the order. Texts have six digits.
    double farthest = 0.0;
    for (const Vec3& vertex : loaded.mesh->vertices()) {
      double nearest = 1e9;
      for (const Vec3& other : expected.mesh->vertices()) {
        nearest = std::min(nearest, (vertex - other).norm());
      }
      farthest = std::max(farthest, nearest);
    }
    EXPECT_LT(farthest, 1e-4);
    for (TriangleId t = 0; t < 20; ++t) {
      EXPECT_GT(loaded.mesh->normal(t).dot(loaded.mesh->triangle(t)[0]), 0.0) << "outwards";
    }
  }
  EXPECT_EQ(count, 15u);
}

TEST_F(LoadMesh, AVtpFieldNamesTheSpace) {
  for (const Mode mode : {Mode::text, Mode::base64, Mode::appended_base64, Mode::appended_raw}) {
    for (const bool is_compressed : {false, true}) {
      for (const bool has_long_counts : {false, true}) {
        const LoadedMesh loaded =
            load("mesh.vtp", as_vtp(tetrahedron(), {.format = mode,
                                                    .is_compressed = is_compressed,
                                                    .has_long_counts = has_long_counts,
                                                    .space = "RAS"}));
        EXPECT_EQ(loaded.stated, AnatomicalSpace::ras);
        EXPECT_EQ(loaded.mesh->triangle_count(), 4u);
      }
    }
  }
}

TEST_F(LoadMesh, AVtpFieldNamesTheSpaceInAnyCaseAndMayContradictItself) {
  const std::string vtp = as_vtp(tetrahedron(), {.space = "LPS"});
  EXPECT_EQ(load("mesh.vtp", replaced(vtp, "\"SPACE\"", "\"Space\"")).stated, AnatomicalSpace::lps);
  // A number with that name is not a space.
  EXPECT_EQ(load("mesh.vtp", replaced(vtp, "type=\"String\"", "type=\"Int8\"")).stated,
            AnatomicalSpace::unstated);
  const std::string contradiction = "states that its space is LPS and RAS";
  const std::string two_strings = as_vtp(tetrahedron(), {.space = std::string("LPS\0RAS", 7)});
  EXPECT_CONTAINS(complaint("mesh.vtp", two_strings), contradiction);
  const std::string other = as_vtp(tetrahedron(), {.space = "RAS"});
  const std::size_t begin = other.find("<FieldData>");
  const std::size_t end = other.find("<Piece");
  std::string two_fields = vtp;
  two_fields.insert(two_fields.find("<Piece"), other.substr(begin, end - begin));
  EXPECT_CONTAINS(complaint("mesh.vtp", two_fields), contradiction);
  EXPECT_EQ(load("mesh.vtp", replaced(two_fields, "82 65 83", "76 80 83")).stated,
            AnatomicalSpace::lps);
}

/// Returns the part of a VTP file that holds its mesh.
std::string piece_of(const std::string& vtp) {
  const std::size_t begin = vtp.find("<Piece");
  return vtp.substr(begin, vtp.find("</PolyData>") - begin);
}

TEST_F(LoadMesh, VtpPiecesAreJoined) {
  const std::string one = as_vtp(single_triangle(), {});
  const std::string piece = piece_of(one);
  const std::string other = replaced(piece, "0 1 2 ", "2 0 1 ");
  const LoadedMesh loaded = load_unchecked("mesh.vtp", replaced(one, piece, piece + other));
  ASSERT_EQ(loaded.mesh->triangle_count(), 2u);
  EXPECT_EQ(loaded.mesh->triangle(1)[0], loaded.mesh->triangle(0)[2]);
}

/// Returns a VTP file of type Float64, with a piece for each triangle.
std::string vtp_of_triangles(const std::vector<std::string>& triangles) {
  std::string text = "<VTKFile type=\"PolyData\"><PolyData>\n";
  for (const std::string& coordinates : triangles) {
    text +=
        "<Piece NumberOfPoints=\"3\" NumberOfPolys=\"1\"><Points><DataArray type=\"Float64\">" +
        coordinates +
        "</DataArray></Points>\n<Polys><DataArray type=\"Int32\" Name=\"connectivity\">0 1 2"
        "</DataArray><DataArray type=\"Int32\" Name=\"offsets\">3</DataArray></Polys></Piece>\n";
  }
  return text + "</PolyData></VTKFile>\n";
}

TEST_F(LoadMesh, VtpPiecesAreRoundedTogether) {
  const std::string seam = "0.1 0.2 0.3 40.1 0.2 0.3 ";
  // Alone, the numerals of the first piece could come from floats.
  const LoadedMesh doubles = load_unchecked(
      "mesh.vtp", vtp_of_triangles({seam + "0.1 40.2 0.3", seam + "0.1 40.2 0.300000000001"}));
  EXPECT_EQ(doubles.mesh->vertex_count(), 4u);
  EXPECT_EQ(doubles.mesh->vertex(0), Vec3(0.1, 0.2, 0.3));
  const LoadedMesh floats =
      load_unchecked("mesh.vtp", vtp_of_triangles({seam + "0.1 40.2 0.3", seam + "0.1 40.2 0.7"}));
  EXPECT_EQ(floats.mesh->vertex_count(), 4u);
  EXPECT_EQ(floats.mesh->vertex(0), Vec3(0.1f, 0.2f, 0.3f));
}

TEST_F(LoadMesh, VtpThatIsMalformedIsAnErrorThatSaysWhere) {
  const std::string good = as_vtp(tetrahedron(), {});
  expect_faults("mesh.vtp", good,
                {{"</Points>", "</Point>", "XML that is not well-formed, mismatched tag"},
                 {"PolyData", "UnstructuredGrid", "only PolyData is a surface"},
                 {"<VTKFile", "<KTVFile", "line 2: expected 'VTKFile'"},
                 {"NumberOfPoints=\"4", "NumberOfPoints=\"5", "three for each of 5 points"},
                 {"NumberOfPoints=\"4", "NumberOfPoints=\"-4", "must be a whole number"},
                 {"NumberOfPolys=\"4", "NumberOfPolys=\"5", "4 numbers for 5 cells"},
                 {"NumberOfComponents=\"3", "NumberOfComponents=\"2", "line 5: points have 3"},
                 {"Float32", "Float16", "unknown type 'Float16'"},
                 {"type=\"Int64\"", "type=\"Float64\"", "must have integers"},
                 {"\"offsets\"", "\"onsets\"", "not both of their arrays"},
                 {"\"ascii\"", "\"morse\"", "must be ascii, binary or appended"},
                 {"UInt64", "UInt16", "header_type"},
                 {"3 6 9 12", "3 6 9 13", "from corner 9 to 13 of 12"},
                 {"3 6 9 12", "3 6 9 x", "line 11: expected a whole number, found 'x'"},
                 {"Piece", "Peace", "no Piece"},
                 {"LittleEndian", "MiddleEndian",
                  "byte_order must be LittleEndian or BigEndian, not 'MiddleEndian'"}});
  std::string utf16 = "\xFF\xFE";
  for (const char c : good) utf16 += {c, '\0'};
  EXPECT_CONTAINS(complaint("mesh.vtp", utf16), "UTF-16");
}

TEST_F(LoadMesh, VtpInACompressionOtherThanZlibIsAnError) {
  const std::string vtp = as_vtp(tetrahedron(), {.format = Mode::base64, .is_compressed = true});
  EXPECT_CONTAINS(complaint("mesh.vtp", replaced(vtp, "vtkZLib", "vtkLZ4")), "only zlib is read");
}

TEST_F(LoadMesh, VtpDataThatAreDamagedAreErrors) {
  const std::string raw = as_vtp(tetrahedron(), {.format = Mode::appended_raw});
  const std::size_t data = raw.find("  _") + 3;
  const auto changed = [](std::string text, std::size_t at, std::string_view bytes) {
    return text.replace(at, bytes.size(), bytes);
  };
  const std::string huge(8, '\x7f');
  EXPECT_CONTAINS(complaint("mesh.vtp", changed(raw, data, huge)), "more than the file has room");
  EXPECT_CONTAINS(complaint("mesh.vtp", replaced(raw, "offset=\"0\"", "offset=\"99999\"")),
                  "not in the file");
  EXPECT_CONTAINS(complaint("mesh.vtp", replaced(raw, "  _", "   ")), "do not begin with '_'");
  EXPECT_CONTAINS(complaint("mesh.vtp", raw.substr(0, raw.size() - 20)), "cut short");

  const std::string packed =
      as_vtp(tetrahedron(), {.format = Mode::appended_raw, .is_compressed = true});
  const std::size_t counts = packed.find("  _") + 3;
  EXPECT_CONTAINS(complaint("mesh.vtp", changed(packed, counts, huge)),
                  "blocks, more than the file");
  EXPECT_CONTAINS(complaint("mesh.vtp", changed(packed, counts + 16, huge)), "an impossible size");
  EXPECT_CONTAINS(complaint("mesh.vtp", changed(packed, counts + 24, huge)), "an impossible size");
  EXPECT_CONTAINS(complaint("mesh.vtp", changed(packed, counts + 34, "xx")), "cannot be unpacked");

  const std::string letters = as_vtp(tetrahedron(), {.format = Mode::base64});
  EXPECT_CONTAINS(complaint("mesh.vtp", replaced(letters, "AAAA", "A*AA")), "'*' is not of base64");
}

TEST_F(LoadMesh, MoreBase64ThanAVtpArrayDeclaresIsAnError) {
  for (const bool is_compressed : {false, true}) {
    const std::string vtp =
        as_vtp(tetrahedron(), {.format = Mode::base64, .is_compressed = is_compressed});
    EXPECT_EQ(load("mesh.vtp", replaced(vtp, "\n</DataArray>", " \n\t </DataArray>"))
                  .mesh->triangle_count(),
              4u);
    EXPECT_CONTAINS(complaint("mesh.vtp", replaced(vtp, "\n</DataArray>", "AAAA\n</DataArray>")),
                    "array 'Points Points': has more base64 than the 48 bytes that it declares");
  }
}

TEST_F(LoadMesh, AVtpPieceThatHoldsMoreThanItDeclaresIsAnError) {
  for (const Mode mode : {Mode::text, Mode::base64, Mode::appended_base64, Mode::appended_raw}) {
    for (const bool is_compressed : {false, true}) {
      const std::string piece =
          as_vtp(tetrahedron(), {.format = mode, .is_compressed = is_compressed});
      for (const std::string count : {"NumberOfPoints", "NumberOfPolys"}) {
        const std::string missing = "the " + count + " of its Piece is 0 or missing";
        EXPECT_CONTAINS(complaint("mesh.vtp", replaced(piece, count + "=\"4", count + "=\"0")),
                        missing);
        EXPECT_CONTAINS(complaint("mesh.vtp", replaced(piece, count + "=\"4\"", "")), missing);
      }
    }
  }
}

TEST_F(LoadMesh, AVtpPieceMayBeEmpty) {
  for (const Mode mode : {Mode::text, Mode::base64, Mode::appended_base64, Mode::appended_raw}) {
    const std::string empty = as_vtp({}, {.format = mode});
    EXPECT_CONTAINS(complaint("mesh.vtp", empty), "no faces");
  }
  std::string vtp = as_vtp(tetrahedron(), {});
  vtp.insert(vtp.find("<Piece"), piece_of(as_vtp({}, {})));
  EXPECT_EQ(load("mesh.vtp", vtp).mesh->triangle_count(), 4u);
}

TEST_F(LoadMesh, AVtpArrayIsNotUnpackedIfItHoldsMoreThanItsPieceDeclares) {
  // A thousand vertices, which compress well. The file declares three.
  Surface surface = single_triangle();
  surface.vertices.resize(1000, Vec3::Zero());
  for (const bool is_compressed : {false, true}) {
    const std::string vtp =
        as_vtp(surface, {.format = Mode::appended_raw, .is_compressed = is_compressed});
    EXPECT_EQ(load_unchecked("mesh.vtp", vtp).mesh->triangle_count(), 1u);
    EXPECT_CONTAINS(
        complaint("mesh.vtp", replaced(vtp, "NumberOfPoints=\"1000", "NumberOfPoints=\"3")),
        "array 'Points Points': holds more than the 36 bytes that belong in it");
  }
  EXPECT_CONTAINS(complaint("mesh.vtp", replaced(as_vtp(surface, {}), "NumberOfPoints=\"1000",
                                                 "NumberOfPoints=\"1000000000000000")),
                  "NumberOfPoints is 1000000000000000, more than the file has room for");
}

/// Returns the peak memory of this process. [bytes]
std::size_t most_memory() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return std::size_t{1024} * static_cast<std::size_t>(usage.ru_maxrss);
}

TEST_F(LoadMesh, AFalseSizeOfAVtpBlockTakesNoMemory) {
  constexpr std::uint64_t claimed = 90'000'000;
  std::string vtp =
      replaced(as_vtp(tetrahedron(), {.format = Mode::appended_raw, .is_compressed = true}),
               "NumberOfPoints=\"4", "NumberOfPoints=\"" + std::to_string(claimed));
  // The points are one block of a few bytes, which claims a size of 2 MB and 1 GB unpacked.
  const std::string offset = vtp.substr(vtp.find("offset=\"", vtp.find("\"Points\"")) + 8);
  const std::size_t counts = vtp.find("  _") + 3 + std::stoull(offset);
  std::string size, packed;
  append_bytes(size, 12 * claimed, false);
  append_bytes(packed, std::uint64_t{1} << 21, false);
  vtp.replace(counts + 16, 8, size).replace(counts + 24, 8, packed);
  vtp.insert(vtp.find("\n  </AppendedData>"), std::size_t{1} << 21, '\0');
  const std::size_t before = most_memory();
  EXPECT_CONTAINS(complaint("mesh.vtp", vtp), "block 0 cannot be unpacked");
  EXPECT_LT(most_memory() - before, std::size_t{1} << 28);
}

TEST_F(LoadMesh, VtpArraysThatOverlapAreAnError) {
  // Otherwise, a small file with many pieces could exhaust the memory.
  const std::string raw = as_vtp(torus(20), {.format = Mode::appended_raw});
  const std::string piece = piece_of(raw);
  EXPECT_CONTAINS(complaint("mesh.vtp", replaced(raw, piece, piece + piece + piece + piece)),
                  "overlaps another one");
}

TEST_F(LoadMesh, EntitiesOfAVtpFileDoNotTakeMemory) {
  std::string bomb =
      "<?xml version=\"1.0\"?>\n<!DOCTYPE V [<!ENTITY a \"aaaaaaaaaaaaaaaaaaaaaaaaa\">\n";
  for (char c = 'b'; c < 'm'; ++c) {
    std::string last;
    for (int i = 0; i < 10; ++i) last += std::string("&") + static_cast<char>(c - 1) + ";";
    bomb += std::string("<!ENTITY ") + c + " \"" + last + "\">\n";
  }
  bomb += "]>\n<VTKFile type=\"&l;\"></VTKFile>\n";
  EXPECT_CONTAINS(complaint("mesh.vtp", bomb), "line ");
}

}  // namespace
}  // namespace keepout
