// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstring>
#include <functional>
#include <iomanip>
#include <ostream>
#include <sstream>

#include "keepout/mesh/binary_stl.h"
#include "keepout/mesh/load_mesh.h"
#include "meshes.h"
#include "temporary_folder.h"

namespace keepout {

namespace fs = std::filesystem;

// Writers of our own: no reader is tested with its own library's idea of a format.

/// How the writers write numbers: as short as 9 digits allow, unless told otherwise.
inline std::ios_base::fmtflags notation{};
inline int digits = 9;

inline std::string number(double value) {
  std::ostringstream text;
  text.setf(notation, std::ios_base::floatfield);
  text << std::setprecision(notation == std::ios_base::fixed ? 14 : digits) << value;
  return text.str();
}

inline std::string row(const Vec3& v) {
  return number(v.x()) + " " + number(v.y()) + " " + number(v.z()) + "\n";
}

inline std::string as_text_stl(const Surface& surface) {
  std::string text = "solid a name with facet in it\n";
  for (const Corners& corners : surface.triangles) {
    text += "facet normal 0 0 1\n  outer loop\n";
    for (const VertexId v : corners) text += "    vertex " + row(surface.vertices[v]);
    text += "  endloop\nendfacet\n";
  }
  return text + "endsolid a name with facet in it\n";
}

inline std::string as_off(const Surface& surface) {
  std::string text = "OFF\n" + std::to_string(surface.vertices.size()) + " " +
                     std::to_string(surface.triangles.size()) + " 0\n";
  for (const Vec3& v : surface.vertices) text += row(v);
  for (const Corners& c : surface.triangles) {
    text += "3 " + std::to_string(c[0]) + " " + std::to_string(c[1]) + " " + std::to_string(c[2]) +
            "\n";
  }
  return text;
}

inline std::string as_obj(const Surface& surface) {
  std::string text = "mtllib nothing.mtl\no thing\n";
  for (const Vec3& v : surface.vertices) text += "v " + row(v);
  bool other = false;
  for (const Corners& c : surface.triangles) {
    // Materials change all the time: no reason to reorder the triangles.
    text += (other = !other) ? "usemtl one\n" : "usemtl two\n";
    text += "f " + std::to_string(c[0] + 1) + " " + std::to_string(c[1] + 1) + "//1 " +
            std::to_string(c[2] + 1) + "/2/3\n";
  }
  return text;
}

inline std::string ply_header(const std::string& format, const Surface& surface, const char* real) {
  const std::string type = std::string("property ") + real;
  return "ply\nformat " + format + " 1.0\ncomment made by hand\nelement vertex " +
         std::to_string(surface.vertices.size()) + "\n" + type + " x\n" + type + " y\n" + type +
         " z\nproperty uchar red\nelement face " + std::to_string(surface.triangles.size()) +
         "\nproperty list uchar int vertex_indices\nproperty short quality\nend_header\n";
}

inline std::string as_text_ply(const Surface& surface) {
  std::string text = ply_header("ascii", surface, "float");
  for (const Vec3& v : surface.vertices) {
    text += number(v.x()) + " " + number(v.y()) + " " + number(v.z()) + " 255\n";
  }
  for (const Corners& c : surface.triangles) {
    text += "3 " + std::to_string(c[0]) + " " + std::to_string(c[1]) + " " + std::to_string(c[2]) +
            " -7\n";
  }
  return text;
}

template <class T>
void append_bytes(std::string& to, T value, bool big_endian) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  if (big_endian) std::reverse(bytes.begin(), bytes.end());
  to += bytes;
}

template <class Real>
std::string as_binary_ply(const Surface& surface, bool big_endian) {
  std::string text = ply_header(big_endian ? "binary_big_endian" : "binary_little_endian", surface,
                                sizeof(Real) == sizeof(float) ? "float" : "double");
  for (const Vec3& v : surface.vertices) {
    for (int axis = 0; axis < 3; ++axis) {
      append_bytes(text, static_cast<Real>(v[axis]), big_endian);
    }
    text += '\x0a';
  }
  for (const Corners& c : surface.triangles) {
    text += '\x03';
    for (const VertexId v : c) append_bytes(text, v, big_endian);
    append_bytes(text, std::int16_t{-7}, big_endian);
  }
  return text;
}

inline std::string as_binary_stl(const Surface& surface) {
  const TemporaryFolder folder;
  write_binary_stl(folder.path() / "mesh.stl", surface);
  return folder.contents("mesh.stl");
}

struct Format {
  std::string name, file;
  std::function<std::string(const Surface&)> write;
};

/// What a test prints of one.
inline void PrintTo(const Format& format, std::ostream* out) { *out << format.name; }

inline const std::vector<Format>& formats() {
  static const std::vector<Format> all{
      {"BinaryStl", "mesh.stl", as_binary_stl},
      {"TextStl", "mesh.stl", as_text_stl},
      {"TextPly", "mesh.ply", as_text_ply},
      {"LittleEndianPly", "mesh.ply",
       [](const Surface& s) { return as_binary_ply<float>(s, false); }},
      {"BigEndianPly", "mesh.ply", [](const Surface& s) { return as_binary_ply<float>(s, true); }},
      {"DoublePly", "mesh.ply", [](const Surface& s) { return as_binary_ply<double>(s, false); }},
      {"Obj", "mesh.obj", as_obj},
      {"Off", "mesh.off", as_off}};
  return all;
}

/// A torus whose coordinates are short numbers, which every format holds exactly.
inline Surface round_torus() {
  Surface surface = torus(8);
  for (Vec3& v : surface.vertices) v = (64.0 * v.array()).round() / 64.0;
  return surface;
}

inline std::string format_name(const testing::TestParamInfo<Format>& format) {
  return format.param.name;
}

inline std::string replaced(std::string text, std::string_view from, std::string_view to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
  return text;
}

/// A polygon of four corners.
inline const char* const square_off = "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";

class LoadMesh : public testing::Test {
 protected:
  LoadedMesh load(std::string_view name, std::string_view contents) const {
    return load_mesh(folder.write(name, contents));
  }
  /// Warnings are of the file then, and not of the small, open surface in it.
  LoadedMesh load_unchecked(std::string_view name, std::string_view contents) const {
    return load_mesh(folder.write(name, contents), {.check = MeshCheck::none});
  }

  /// What load_mesh says against the file; the test fails if it says nothing or not which file.
  std::string complaint(std::string_view name, std::string_view contents) const {
    return complaint(folder.write(name, contents));
  }
  static std::string complaint(const fs::path& path) {
    const std::string message = error_of([&] { load_mesh(path); });
    EXPECT_TRUE(message.starts_with(path.string())) << message;
    return message.substr(std::min(message.size(), path.string().size()));
  }

  TemporaryFolder folder;
};

}  // namespace keepout
