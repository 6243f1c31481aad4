// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <zlib.h>

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

// Independent writers, so that no reader is tested with its own library's idea of a format.

/// The format of written numbers. By default, they are as short as 9 digits allow.
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
    // Alternating materials must not reorder the triangles.
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

inline std::string vtk_title(const std::string& encoding, const std::string& version) {
  return "# vtk DataFile Version " + version + "\nmade by hand\n" + encoding +
         "\nDATASET POLYDATA\n";
}

inline std::string as_text_vtk(const Surface& surface) {
  std::string text =
      vtk_title("ASCII", "4.2") + "POINTS " + std::to_string(surface.vertices.size()) + " double\n";
  for (const Vec3& v : surface.vertices) text += row(v);
  const std::size_t count = surface.triangles.size();
  text += "\nPOLYGONS " + std::to_string(count) + " " + std::to_string(4 * count) + "\n";
  for (const Corners& c : surface.triangles) {
    text += "3 " + std::to_string(c[0]) + " " + std::to_string(c[1]) + " " + std::to_string(c[2]) +
            "\n";
  }
  return text;
}

/// Writes the file as VTK 9 does.
template <class Real>
std::string as_binary_vtk(const Surface& surface) {
  std::string text = vtk_title("BINARY", "5.1") + "POINTS " +
                     std::to_string(surface.vertices.size()) +
                     (sizeof(Real) == sizeof(float) ? " float\n" : " double\n");
  for (const Vec3& v : surface.vertices) {
    for (const double x : v) append_bytes(text, static_cast<Real>(x), true);
  }
  text += "\nMETADATA\nINFORMATION 1\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 0 1\n\n";
  text += "POLYGONS " + std::to_string(surface.triangles.size() + 1) + " " +
          std::to_string(3 * surface.triangles.size()) + "\nOFFSETS vtktypeint64\n";
  for (std::size_t i = 0; i <= surface.triangles.size(); ++i) {
    append_bytes(text, static_cast<std::int64_t>(3 * i), true);
  }
  text += "\nCONNECTIVITY vtktypeint64\n";
  for (const Corners& c : surface.triangles) {
    for (const VertexId v : c) append_bytes(text, std::int64_t{v}, true);
  }
  return text + "\n";
}

inline std::string in_base64(std::string_view bytes) {
  constexpr std::string_view digits_of_64 =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::string_view group = bytes.substr(i, 3);
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      bits = bits << 8 | (k < group.size() ? static_cast<unsigned char>(group[k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= group.size() ? digits_of_64[bits >> (18 - 6 * k) & 63U] : '=';
    }
  }
  return text;
}

struct VtpStyle {
  enum class Format { text, base64, appended_base64, appended_raw };
  Format format = Format::text;
  bool is_compressed = false;
  bool has_long_counts = true;
  bool is_big_endian = false;
  std::string space = {};
};

class VtpWriter {
 public:
  explicit VtpWriter(VtpStyle style) : style_(std::move(style)) {}

  std::string write(const Surface& surface) {
    std::string xml =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"";
    xml += style_.is_big_endian ? "BigEndian" : "LittleEndian";
    xml += style_.has_long_counts ? "\" header_type=\"UInt64\"" : "\"";
    if (style_.is_compressed) xml += " compressor=\"vtkZLibDataCompressor\"";
    xml += ">\n<PolyData>\n";
    if (!style_.space.empty()) {
      std::vector<std::int8_t> letters(style_.space.begin(), style_.space.end());
      letters.push_back(0);
      xml += "<FieldData>" + array("Array", "String", "SPACE", letters) + "</FieldData>\n";
    }
    std::vector<float> coordinates;
    for (const Vec3& v : surface.vertices) {
      for (const double x : v) coordinates.push_back(static_cast<float>(x));
    }
    std::vector<std::int64_t> corners, ends;
    for (const Corners& c : surface.triangles) {
      corners.insert(corners.end(), c.begin(), c.end());
      ends.push_back(static_cast<std::int64_t>(corners.size()));
    }
    xml += "<Piece NumberOfPoints=\"" + std::to_string(surface.vertices.size()) +
           "\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"" +
           std::to_string(surface.triangles.size()) + "\">\n<Points>" +
           array("DataArray", "Float32", "Points", coordinates) + "</Points>\n<Polys>" +
           array("DataArray", "Int64", "connectivity", corners) +
           array("DataArray", "Int64", "offsets", ends) + "</Polys>\n</Piece>\n</PolyData>\n";
    if (!appended_.empty()) {
      xml += style_.format == VtpStyle::Format::appended_raw
                 ? "<AppendedData encoding=\"raw\">\n  _"
                 : "<AppendedData encoding=\"base64\">\n  _";
      xml += appended_ + "\n  </AppendedData>\n";
    }
    return xml + "</VTKFile>\n";
  }

 private:
  template <class Number>
  std::string array(const std::string& element, const char* type, const char* name,
                    const std::vector<Number>& numbers) {
    const std::string begin = "<" + element + " type=\"" + type + "\" Name=\"" + name +
                              "\" NumberOfComponents=\"3\" format=\"";
    const std::string end = "</" + element + ">";
    if (style_.format == VtpStyle::Format::text) {
      std::string text = begin + "ascii\">\n";
      for (const Number x : numbers) text += number(static_cast<double>(x)) + " ";
      return text + "\n<InformationKey name=\"L2_NORM_RANGE\"><Value>7</Value></InformationKey>" +
             end;
    }
    const std::string bytes = encoded(numbers);
    if (style_.format == VtpStyle::Format::base64)
      return begin + "binary\">\n" + bytes + "\n" + end;
    const std::string offset = std::to_string(appended_.size());
    appended_ += bytes;
    return begin + "appended\" offset=\"" + offset + "\">" + end;
  }

  std::string plain_or_base64(const std::string& bytes) const {
    return style_.format == VtpStyle::Format::appended_raw ? bytes : in_base64(bytes);
  }

  template <class Number>
  std::string encoded(const std::vector<Number>& numbers) const {
    std::string bytes;
    for (const Number x : numbers) append_bytes(bytes, x, style_.is_big_endian);
    const auto append_count = [&](std::string& to, std::uint64_t count) {
      style_.has_long_counts
          ? append_bytes(to, count, style_.is_big_endian)
          : append_bytes(to, static_cast<std::uint32_t>(count), style_.is_big_endian);
    };
    std::string counts;
    if (!style_.is_compressed) {
      append_count(counts, bytes.size());
      return plain_or_base64(counts + bytes);
    }
    // Blocks have 64 bytes; the last one is shorter.
    constexpr std::size_t size = 64;
    const std::size_t blocks = (bytes.size() + size - 1) / size;
    append_count(counts, blocks);
    append_count(counts, size);
    append_count(counts, bytes.size() % size);
    std::string packed;
    for (std::size_t b = 0; b < blocks; ++b) {
      const std::string block = bytes.substr(b * size, size);
      std::string part(compressBound(block.size()), '\0');
      uLongf length = part.size();
      compress(reinterpret_cast<Bytef*>(part.data()), &length,
               reinterpret_cast<const Bytef*>(block.data()), block.size());
      append_count(counts, length);
      packed.append(part, 0, length);
    }
    return plain_or_base64(counts) + plain_or_base64(packed);
  }

  VtpStyle style_;
  std::string appended_;
};

inline std::string as_vtp(const Surface& surface, const VtpStyle& style) {
  return VtpWriter(style).write(surface);
}

struct Format {
  std::string name, file;
  std::function<std::string(const Surface&)> write;
};

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
      {"Off", "mesh.off", as_off},
      {"TextVtk", "mesh.vtk", as_text_vtk},
      {"BinaryVtk", "mesh.vtk", as_binary_vtk<float>},
      {"DoubleVtk", "mesh.vtk", as_binary_vtk<double>},
      {"TextVtp", "mesh.vtp", [](const Surface& s) { return as_vtp(s, {}); }},
      {"Base64Vtp", "mesh.vtp",
       [](const Surface& s) {
         return as_vtp(s, {.format = VtpStyle::Format::base64, .has_long_counts = false});
       }},
      {"RawVtp", "mesh.vtp",
       [](const Surface& s) {
         return as_vtp(s, {.format = VtpStyle::Format::appended_raw, .is_big_endian = true});
       }},
      {"CompressedVtp", "mesh.vtp", [](const Surface& s) {
         return as_vtp(s, {.format = VtpStyle::Format::appended_base64, .is_compressed = true});
       }}};
  return all;
}

/// Returns a torus with short coordinates, which every format stores exactly.
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

/// An OFF file with one polygon of four corners.
inline const char* const square_off = "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";

class LoadMesh : public testing::Test {
 protected:
  LoadedMesh load(std::string_view name, std::string_view contents) const {
    return load_mesh(folder.write(name, contents));
  }
  /// Loads without a mesh check, so that there are no warnings about the small, open surface.
  LoadedMesh load_unchecked(std::string_view name, std::string_view contents) const {
    return load_mesh(folder.write(name, contents), {.check = MeshCheck::none});
  }

  /// Returns the message of load_mesh after the file name. Fails if there is no error, or if the
  /// message does not begin with the file name.
  std::string complaint(std::string_view name, std::string_view contents) const {
    return complaint(folder.write(name, contents));
  }
  /// A change to the contents, and the text that the message must contain.
  struct Fault {
    std::string_view from, to, says;
  };
  void expect_faults(std::string_view name, const std::string& good,
                     std::initializer_list<Fault> faults) const {
    for (const auto& [from, to, says] : faults) {
      EXPECT_CONTAINS(complaint(name, replaced(good, from, to)), says) << from << " -> " << to;
    }
  }
  static std::string complaint(const fs::path& path) {
    const std::string message = error_of([&] { load_mesh(path); });
    EXPECT_TRUE(message.starts_with(path.string())) << message;
    return message.substr(std::min(message.size(), path.string().size()));
  }

  TemporaryFolder folder;
};

}  // namespace keepout
