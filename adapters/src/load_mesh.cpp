// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause

#include "keepout/adapters/load_mesh.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <fstream>
#include <new>
#include <string_view>

#include "coordinate_notes.h"
#include "keepout/error.h"
#include "keepout/mesh/binary_ply.h"
#include "keepout/mesh/binary_stl.h"
#include "keepout/mesh/quick_check.h"
#include "keepout/mesh/weld.h"

#if KEEPOUT_WITH_ASSIMP
#include "../assimp/read_with_assimp.h"
#endif

namespace keepout {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what) {
  throw Error(path.string() + ": " + what);
}

std::string lower_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = (c >= 'A' && c <= 'Z') ? static_cast<char>(c - 'A' + 'a') : c;
  return extension;
}

/// Throws unless there is a file with something in it.
void check_file(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) fail(path, "there is no such file; check the name");
  if (std::filesystem::is_directory(status)) fail(path, "is a directory; name a mesh file in it");
  if (!std::filesystem::is_regular_file(status)) fail(path, "is not a regular file");
  if (!std::ifstream(path, std::ios::binary)) fail(path, "cannot be read; check its permissions");
  if (std::filesystem::file_size(path, error) == 0 || error) {
    fail(path, "is empty; copy or export it again");
  }
}

std::string beginning_of(const std::filesystem::path& path) {
  std::string bytes(512, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  return bytes;
}

void refuse_compressed(const std::filesystem::path& path, std::string_view beginning) {
  constexpr std::array<std::string_view, 5> magics{"\x1f\x8b", "PK\x03\x04", "BZh",
                                                   "\xfd"
                                                   "7zXZ",
                                                   "\x28\xb5\x2f\xfd"};
  for (const std::string_view magic : magics) {
    if (beginning.starts_with(magic)) fail(path, "is compressed; unpack it first");
  }
}

/// The extension that the content calls for, where it is beyond doubt.
std::string_view extension_by_content(std::string_view beginning) {
  if (beginning.starts_with("ply\n") || beginning.starts_with("ply\r")) return ".ply";
  if (beginning.starts_with("OFF\n") || beginning.starts_with("OFF\r")) return ".off";
  if (beginning.starts_with("solid") && beginning.find("facet") != std::string_view::npos) {
    return ".stl";
  }
  return {};
}

/// STL that is neither text nor of the length that its header declares.
[[noreturn]] void refuse_stl(const std::filesystem::path& path, std::string_view beginning) {
  constexpr std::size_t preamble = 84;
  const std::uintmax_t size = std::filesystem::file_size(path);
  if (beginning.size() < preamble) fail(path, "is too short to be an STL file");
  std::uint32_t count;
  std::memcpy(&count, beginning.data() + preamble - sizeof count, sizeof count);
  const std::uintmax_t needed = preamble + 50 * std::uintmax_t{count};
  fail(path, "is no text, and as binary STL declares " + std::to_string(count) +
                 " triangles, which take " + std::to_string(needed) + " bytes, but it has " +
                 std::to_string(size) +
                 (size < needed ? ": it was cut short, or is damaged; copy or export it again"
                                : ": something follows the mesh; export it again"));
}

bool looks_like_text_stl(std::string_view beginning) {
  const std::size_t word = beginning.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  return word != std::string_view::npos && beginning.find('\0') == std::string_view::npos;
}

#if KEEPOUT_WITH_ASSIMP

std::string contents_of(const std::filesystem::path& path) {
  std::string contents(std::filesystem::file_size(path), '\0');
  std::ifstream file(path, std::ios::binary);
  if (!file.read(contents.data(), static_cast<std::streamsize>(contents.size()))) {
    fail(path, "cannot be read to its end; check the disk");
  }
  return contents;
}

MeshFormat format_of(const std::string& extension) noexcept {
  if (extension == ".ply") return MeshFormat::ply;
  if (extension == ".obj") return MeshFormat::obj;
  if (extension == ".off") return MeshFormat::off;
  return MeshFormat::stl;
}

CoordinateNotes notes_of(MeshFormat format, std::string_view contents, const std::string& file) {
  switch (format) {
    case MeshFormat::stl:
      return notes_of_text_stl(contents);
    case MeshFormat::ply:
      return notes_of_ply(read_ply_header(contents, file).comments);
    case MeshFormat::obj:
    case MeshFormat::off:
      break;
  }
  return notes_after_hashes(contents);
}

Surface read_other(const std::filesystem::path& path, const std::string& extension,
                   std::vector<std::string>& warnings, CoordinateNotes& notes) {
  const MeshFormat format = format_of(extension);
  const std::string contents = contents_of(path);
  notes = notes_of(format, contents, path.string());
  return read_with_assimp(format, contents, path.string(), warnings);
}

#else

Surface read_other(const std::filesystem::path& path, const std::string&, std::vector<std::string>&,
                   CoordinateNotes&) {
  fail(path,
       "only binary STL and PLY can be read, for keepout was built without assimp; convert the "
       "mesh, "
       "or build with KEEPOUT_WITH_ASSIMP=ON");
}

#endif

/// A binary PLY file's surface, welded.
Surface read_ply(const std::filesystem::path& path, const PlyHeader& header,
                 std::vector<std::string>& warnings) {
  PlySurface read = read_binary_ply(path, header);
  warnings.insert(warnings.end(), read.warnings.begin(), read.warnings.end());
  return weld(std::move(read.surface));
}

Surface read_welded(const std::filesystem::path& path, std::vector<std::string>& warnings,
                    CoordinateNotes& notes) {
  check_file(path);
  const std::string beginning = beginning_of(path);
  refuse_compressed(path, beginning);
  const std::string extension = lower_extension(path);
  constexpr std::array<std::string_view, 4> known{".stl", ".ply", ".obj", ".off"};
  if (std::find(known.begin(), known.end(), extension) == known.end()) {
    fail(path, "its extension is none of .stl, .ply, .obj, .off; convert the mesh to one of them");
  }
  if (extension == ".stl" && is_binary_stl(path)) {
    notes = notes_of_binary_stl(beginning);
    return read_welded_stl(path);
  }
  const std::string_view expected = extension_by_content(beginning);
  if (!expected.empty() && expected != extension) {
    fail(path, "its content is " + std::string(expected) + "; give it that extension");
  }
  if (extension == ".stl" && !looks_like_text_stl(beginning)) refuse_stl(path, beginning);
  if (extension == ".ply") {
    const PlyHeader header = read_ply_header(path);
    if (header.encoding != PlyEncoding::text) {
      notes = notes_of_ply(header.comments);
      return read_ply(path, header, warnings);
    }
  }
  return weld(read_other(path, extension, warnings, notes));
}

/// Turns the surface into the space that is wanted, and takes down what is known of it. Throws
/// Error when that cannot be done without guessing.
void settle_space(const std::filesystem::path& path, const CoordinateNotes& notes,
                  const LoadOptions& options, Surface& surface, LoadedMesh& loaded) {
  constexpr AnatomicalSpace unstated = AnatomicalSpace::unstated;
  if (!notes.contradiction.empty()) {
    fail(path, "states that its space is " + notes.contradiction +
                   ", which cannot both be; correct its comments, or export it again");
  }
  loaded.stated = notes.space;
  loaded.space = notes.space;
  if (loaded.space == unstated && notes.other_space.empty()) loaded.space = options.untagged;
  if (options.space == unstated) {
    if (!notes.other_space.empty()) {
      loaded.warnings.push_back("states SPACE=" + notes.other_space +
                                ", which is neither RAS nor LPS: taken as it stands");
    } else if (notes.space != unstated) {
      const std::string stated(name(notes.space));
      const std::string other(
          name(notes.space == AnatomicalSpace::ras ? AnatomicalSpace::lps : AnatomicalSpace::ras));
      loaded.warnings.push_back(
          "states SPACE=" + stated + ": taken as it stands, so tips must be in " + stated +
          " too; ask for the space " + stated + ", or for " + other + " to have it turned");
    }
    return;
  }
  const std::string wanted(name(options.space));
  if (!notes.other_space.empty()) {
    fail(path, "states SPACE=" + notes.other_space + ", and only RAS and LPS are turned into " +
                   wanted + "; export it in one of them");
  }
  if (loaded.space == unstated) {
    fail(path, "does not state its space, so it cannot be told whether it is in " + wanted +
                   "; say what a file without SPACE=RAS or SPACE=LPS is in (LoadOptions::untagged, "
                   "--untagged). 3D Slicer saved RAS before 4.11 and saves LPS since; most other "
                   "programs for DICOM images use LPS");
  }
  if (loaded.space != options.space) {
    swap_ras_and_lps(surface);
    loaded.space = options.space;
  }
}

void warn_of_unit(const CoordinateNotes& notes, std::vector<std::string>& warnings) {
  if (!notes.millimetres || *notes.millimetres == 1.0) return;
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), *notes.millimetres);
  const std::string factor(digits.data(), end.ptr);
  warnings.push_back("states that 1 unit is " + factor + " mm: not rescaled; scale it by " +
                     factor + " where lengths are in millimetres");
}

}  // namespace

LoadedMesh load_mesh(const std::filesystem::path& path, const LoadOptions& options) {
  LoadedMesh loaded;
  Surface surface;
  CoordinateNotes notes;
  try {
    surface = read_welded(path, loaded.warnings, notes);
  } catch (const std::bad_alloc&) {
    fail(path, "there is not enough memory to read it; decimate the mesh, or use binary STL");
  } catch (const std::filesystem::filesystem_error& error) {
    fail(path, error.code().message());
  }
  settle_space(path, notes, options, surface, loaded);
  warn_of_unit(notes, loaded.warnings);
  try {
    loaded.mesh = std::make_shared<const Mesh>(std::move(surface));
  } catch (const Error& error) {
    fail(path, error.what());
  }
  if (options.check == MeshCheck::quick) {
    for (std::string& warning : quick_check(*loaded.mesh)) {
      loaded.warnings.push_back(std::move(warning));
    }
  }
  return loaded;
}

}  // namespace keepout
