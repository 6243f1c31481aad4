// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/mesh/load_mesh.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <new>
#include <utility>

#include "keepout/error.h"
#include "keepout/mesh/doctor.h"
#include "keepout/mesh/mesh.h"
#include "mesh_file.h"
#include "text_lines.h"

namespace keepout {
namespace {

void refuse_compressed(const MeshSource& source, std::string_view beginning) {
  constexpr std::array<std::string_view, 5> magics{"\x1f\x8b", "PK\x03\x04", "BZh",
                                                   "\xfd"
                                                   "7zXZ",
                                                   "\x28\xb5\x2f\xfd"};
  for (const std::string_view magic : magics) {
    if (beginning.starts_with(magic)) source.fail("is compressed; unpack it first");
  }
}

/// Returns the extension that the content requires; empty if it is not certain.
std::string_view extension_by_content(std::string_view beginning) {
  if (beginning.starts_with("ply\n") || beginning.starts_with("ply\r")) return ".ply";
  if (beginning.starts_with("OFF\n") || beginning.starts_with("OFF\r")) return ".off";
  if (beginning.starts_with("solid") && beginning.find("facet") != std::string_view::npos) {
    return ".stl";
  }
  if (beginning.starts_with("# vtk DataFile Version")) return ".vtk";
  if (beginning.find("<VTKFile") != std::string_view::npos &&
      beginning.find("\"PolyData\"") != std::string_view::npos) {
    return ".vtp";
  }
  return {};
}

/// Rejects an STL file that is neither text nor of the length that its header declares.
[[noreturn]] void refuse_stl(const MeshSource& source, std::string_view beginning) {
  if (beginning.size() < stl_preamble_size) source.fail("is too short to be an STL file");
  std::uint32_t count;
  std::memcpy(&count, beginning.data() + stl_header_size, sizeof count);
  const std::uint64_t needed = stl_preamble_size + stl_record_size * std::uint64_t{count};
  source.fail("is not text, and as binary STL declares " + std::to_string(count) +
              " triangles, which take " + std::to_string(needed) + " bytes, but it has " +
              std::to_string(source.size()) +
              (source.size() < needed ? ": it was cut short, or is damaged; copy or export it again"
                                      : ": something follows the mesh; export it again"));
}

bool looks_like_text_stl(std::string_view beginning) {
  const std::size_t word = beginning.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  return word != std::string_view::npos && beginning.find('\0') == std::string_view::npos;
}

struct Format {
  std::string_view extension;
  MeshFile (*read)(const MeshSource&);  // for all formats except binary STL
};

constexpr std::array<Format, 6> formats{{{".stl", read_text_stl},
                                         {".ply", read_ply},
                                         {".obj", read_obj},
                                         {".off", read_off},
                                         {".vtk", read_vtk},
                                         {".vtp", read_vtp}}};

/// Returns a file's surface, welded. `vertices_in_file`: the number before welding.
MeshFile read_welded(const MeshSource& source, const std::string& extension,
                     std::size_t& vertices_in_file) {
  const std::string beginning = source.contents(512);
  refuse_compressed(source, beginning);
  const auto format = std::ranges::find(formats, extension, &Format::extension);
  if (format == formats.end()) {
    source.fail(
        "its extension is none of .stl, .ply, .obj, .off, .vtk, .vtp; convert the mesh to one of "
        "them");
  }
  if (extension == ".stl") {
    if (auto surface = read_binary_stl(source)) {
      vertices_in_file = 3 * surface->triangles.size();
      return {*std::move(surface), {beginning.substr(0, stl_header_size)}};
    }
  }
  const std::string_view expected = extension_by_content(beginning);
  if (!expected.empty() && expected != extension) {
    source.fail("its content is " + std::string(expected) + "; give it that extension");
  }
  if (extension == ".stl" && !looks_like_text_stl(beginning)) refuse_stl(source, beginning);
  MeshFile mesh = format->read(source);
  vertices_in_file = mesh.surface.vertices.size();
  mesh.surface = weld(std::move(mesh.surface));
  return mesh;
}

/// Transforms the surface to the requested space, and notes the known facts about it. Throws Error
/// if that would need a guess.
void settle_space(const MeshSource& source, const CoordinateNotes& notes,
                  const LoadOptions& options, Surface& surface, LoadedMesh& loaded) {
  constexpr AnatomicalSpace unstated = AnatomicalSpace::unstated;
  if (!notes.contradiction.empty()) {
    source.fail("states that its space is " + notes.contradiction +
                ", which cannot both be; correct its comments, or export it again");
  }
  loaded.stated = notes.space == name(AnatomicalSpace::ras)   ? AnatomicalSpace::ras
                  : notes.space == name(AnatomicalSpace::lps) ? AnatomicalSpace::lps
                                                              : unstated;
  loaded.stated_name = notes.space;
  loaded.space = notes.space.empty() ? options.untagged : loaded.stated;
  const bool is_another = !notes.space.empty() && loaded.stated == unstated;
  if (options.space == unstated) {
    if (is_another) {
      loaded.warnings.push_back("the file states SPACE=" + notes.space +
                                ", which is neither RAS nor LPS: taken as it stands");
    } else if (loaded.stated != unstated) {
      const std::string other(name(loaded.stated == AnatomicalSpace::ras ? AnatomicalSpace::lps
                                                                         : AnatomicalSpace::ras));
      loaded.warnings.push_back("the file states SPACE=" + notes.space +
                                ": taken as it stands, so tips must be in " + notes.space +
                                " too. To have it turned, ask for " + other + " (space=\"" + other +
                                "\", or 'keepout convert --space " + other + "')");
    }
    return;
  }
  const std::string wanted(name(options.space));
  if (is_another) {
    source.fail("states SPACE=" + notes.space + ", and only RAS and LPS are turned into " + wanted +
                "; export it in one of them");
  }
  if (loaded.space == unstated) {
    source.fail(
        "does not state its space, so keepout cannot convert it to " + wanted +
        "; give the space of files without SPACE=RAS or SPACE=LPS, for example --untagged LPS or "
        "untagged=\"LPS\". 3D Slicer saved RAS before 4.11 and saves LPS since; most other "
        "programs for DICOM images use LPS");
  }
  if (loaded.space != options.space) {
    swap_ras_and_lps(surface);
    loaded.notices.push_back("turned from " + std::string(name(loaded.space)) + " to " + wanted +
                             ": x and y have changed their signs");
    loaded.space = options.space;
  }
}

std::string number_text(double value) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  return {digits.data(), end.ptr};
}

/// Returns the factor from lengths in the file to mm. Throws Error for an unknown unit or an
/// invalid scale.
double scale_of(const LoadOptions& options) {
  if (options.scale) {
    if (!options.unit.empty()) throw Error("unit and scale: give one of them, not both");
    if (!(*options.scale > 0.0) || !std::isfinite(*options.scale)) {
      throw Error(
          "scale must be a finite number above 0, the factor from lengths in the file to "
          "mm, not " +
          number_text(*options.scale));
    }
    return *options.scale;
  }
  if (options.unit.empty()) return 1.0;
  std::string names;
  for (const UnitGuess& known : length_units()) {
    if (options.unit == known.unit) return known.millimetres;
    names.append(names.empty() ? "'" : ", '").append(known.unit).append("'");
  }
  throw Error("unit must be one of " + names + ", the unit of the lengths in the file, not '" +
              options.unit + "'");
}

/// Scales the surface to mm. Rounding may make two vertices equal, so it is welded again.
void scale_to_mm(const MeshSource& source, const LoadOptions& options, double scale,
                 Surface& surface, LoadedMesh& loaded) {
  if (scale == 1.0) return;
  for (Vec3& vertex : surface.vertices) {
    vertex *= scale;
    if (!(vertex.cwiseAbs().maxCoeff() <= largest_coordinate)) {
      source.fail("scaled by " + number_text(scale) +
                  " it has a coordinate beyond 1e30; check the unit or the scale that was given");
    }
  }
  surface = weld(std::move(surface));
  loaded.scale = scale;
  loaded.notices.push_back("scaled by " + number_text(scale) +
                           (options.unit.empty() ? "" : ", from " + options.unit + " to mm"));
}

/// Warns of a unit that the file states if it is not the one used.
void warn_of_unit(const CoordinateNotes& notes, const LoadOptions& options, double scale,
                  std::vector<std::string>& warnings) {
  if (!notes.millimetres || *notes.millimetres == scale) return;
  const std::string factor = number_text(*notes.millimetres);
  const bool is_given = options.scale || !options.unit.empty();
  warnings.push_back("the file states that 1 unit is " + factor + " mm, " +
                     (is_given ? "but it was read as if 1 unit were " + number_text(scale) +
                                     " mm, as was asked for: check which is right"
                               : "but nothing is scaled unless you ask for it: give --scale " +
                                     factor + " or scale=" + factor));
}

void flip_triangles(Surface& surface, LoadedMesh& loaded) {
  for (Corners& corners : surface.triangles) std::swap(corners[1], corners[2]);
  loaded.flipped = true;
  loaded.notices.emplace_back("flipped: each triangle is wound the other way");
}

}  // namespace

std::string lower_extension(const std::filesystem::path& path) {
  return lower(path.extension().string());
}

#ifndef KEEPOUT_READS_VTP
MeshFile read_vtp(const MeshSource& source) {
  source.fail("this build of keepout does not read VTP; save the mesh as .vtk, .stl or .ply");
}
#endif

std::string_view name(AnatomicalSpace space) noexcept {
  constexpr std::array<std::string_view, 3> names{"unstated", "RAS", "LPS"};
  return names[static_cast<std::size_t>(space)];
}

std::optional<AnatomicalSpace> space_named(std::string_view text) noexcept {
  const auto is_same = [](char a, char b) { return a == b || a == b - 'A' + 'a'; };
  for (const AnatomicalSpace space : {AnatomicalSpace::ras, AnatomicalSpace::lps}) {
    if (std::ranges::equal(text, name(space), is_same)) return space;
  }
  return std::nullopt;
}

void swap_ras_and_lps(Surface& surface) noexcept {
  // Subtracted from 0, so that no 0 becomes -0.
  for (Vec3& v : surface.vertices) v = Vec3(0.0 - v.x(), 0.0 - v.y(), v.z());
}

MeshSource::MeshSource(const std::filesystem::path& path) : name_(path.string()), file_(path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (error && error != std::errc::no_such_file_or_directory) {
    fail("cannot be reached (" + error.message() + "); check its folders and links");
  }
  if (!std::filesystem::exists(status)) fail("there is no such file; check the name");
  if (std::filesystem::is_directory(status)) fail("is a directory; name a mesh file in it");
  if (!std::filesystem::is_regular_file(status))
    fail("is not a regular file; copy its contents to one");
  if (!file_.is_open()) fail("cannot be read; check its permissions");
  if (size() == 0) fail("is empty; copy or export it again");
}

void MeshSource::read(std::uint64_t offset, void* to, std::size_t size) const {
  if (!try_read(offset, to, size)) fail("cannot be read to its end; check the disk");
}

std::string MeshSource::contents(std::uint64_t at_most) const {
  std::string contents(static_cast<std::size_t>(std::min(size(), at_most)), '\0');
  read(0, contents.data(), contents.size());
  return contents;
}

void MeshSource::fail(const std::string& what) const { throw Error(name_ + ": " + what); }

LoadedMesh load_mesh(const std::filesystem::path& path, const LoadOptions& options) {
  const double scale = scale_of(options);
  const MeshSource source(path);
  LoadedMesh loaded;
  MeshFile read;
  try {
    read = read_welded(source, lower_extension(path), loaded.vertices_in_file);
  } catch (const std::bad_alloc&) {
    source.fail("there is not enough memory to read it; decimate the mesh, or use binary STL");
  }
  loaded.warnings = std::move(read.warnings);
  const CoordinateNotes notes = notes_of(read.comments);
  settle_space(source, notes, options, read.surface, loaded);
  warn_of_unit(notes, options, scale, loaded.warnings);
  scale_to_mm(source, options, scale, read.surface, loaded);
  if (options.flip) flip_triangles(read.surface, loaded);
  try {
    loaded.mesh = std::make_shared<const Mesh>(std::move(read.surface));
  } catch (const Error& error) {
    source.fail(error.what());
  }
  if (options.check == MeshCheck::quick) {
    for (std::string& warning : quick_check(*loaded.mesh, 0, scale)) {
      loaded.warnings.push_back(std::move(warning));
    }
  }
  const std::string file = path.filename().string() + ": ";
  for (auto* sentences : {&loaded.warnings, &loaded.notices}) {
    for (std::string& sentence : *sentences) sentence.insert(0, file);
  }
  return loaded;
}

}  // namespace keepout
