// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <array>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>

#include "commands.h"
#include "keepout/error.h"
#include "keepout/index/orient.h"
#include "keepout/mesh/binary_ply.h"
#include "keepout/mesh/binary_stl.h"
#include "keepout/mesh/diagnostics.h"
#include "keepout/mesh/load_mesh.h"
#include "keepout/mesh/repair.h"
#include "shared/fact_row.h"
#include "shared/named_mesh.h"
#include "shared/names.h"
#include "shared/number_text.h"
#include "shared/output_file.h"
#include "shared/progress.h"

namespace keepout::app {
namespace {

/// A converted mesh, and the changes of the conversion.
struct Conversion {
  Surface surface;                              // the surface to write
  std::optional<double> rounding = {};          // the largest change of a coordinate [mm]
  RemovedTriangles removed = {};                // from the mesh
  std::optional<Orientation> orientation = {};  // if requested
};

/// Rounds coordinates to the single precision of STL. Returns the largest change of a coordinate.
double round_to_floats(Surface& surface) {
  double farthest = 0.0;
  for (Vec3& v : surface.vertices) {
    const Vec3 exact = v;
    v = exact.cast<float>().cast<double>();  // no coordinate of a Mesh is beyond a float's range
    farthest = std::max(farthest, (v - exact).cwiseAbs().maxCoeff());
  }
  return farthest;
}

/// Throws Error for a mesh whose triangles were all degenerate, or became so by rounding.
[[noreturn]] void refuse_as_empty(const ConvertOptions& options, const Mesh& mesh,
                                  std::optional<double> rounding) {
  Surface exact{{mesh.vertices().begin(), mesh.vertices().end()},
                {mesh.triangles().begin(), mesh.triangles().end()}};
  remove_faulty_triangles(exact);
  const std::string input = options.input.string();
  if (rounding && !exact.triangles.empty()) {
    throw Error(input + ": rounded to the single precision of STL, which moves coordinates by up " +
                "to " + trimmed(*rounding, 3) +
                " mm, all of its triangles are degenerate; write .ply, which keeps all digits");
  }
  throw Error(input + ": all of its triangles are degenerate, so nothing is left to write; check " +
              "the export");
}

Conversion converted(const ConvertOptions& options, const Mesh& mesh) {
  Conversion result;
  result.surface.vertices.assign(mesh.vertices().begin(), mesh.vertices().end());
  result.surface.triangles.assign(mesh.triangles().begin(), mesh.triangles().end());
  if (lower_extension(options.output) == ".stl") {
    // Rounding comes first: it can merge two vertices, or make a thin triangle degenerate.
    const double rounding = round_to_floats(result.surface);
    if (rounding > 0.0) result.rounding = rounding;
    result.surface = weld(std::move(result.surface));
  }
  result.removed = remove_faulty_triangles(result.surface);
  if (result.surface.triangles.empty()) refuse_as_empty(options, mesh, result.rounding);
  if (options.orient) result.orientation = orient(result.surface);
  return result;
}

/// Writes the surface. Throws Error if the format cannot represent it.
void write(const ConvertOptions& options, const Surface& surface, AnatomicalSpace space,
           std::ostream& file) {
  try {
    if (lower_extension(options.output) == ".stl") {
      write_binary_stl(file, surface, space);
    } else {
      write_binary_ply(file, surface, space);
    }
  } catch (const Error& error) {
    throw Error(options.output.string() + ": " + error.what());
  }
}

void print_removed(std::ostream& out, const RemovedTriangles& removed) {
  std::string text = counted(removed.degenerate, "degenerate triangle") + ", " +
                     counted(removed.duplicates, "duplicate triangle");
  if (removed.opposite_duplicates > 0) {
    text +=
        " (" + grouped(removed.opposite_duplicates) + " wound opposite to the one that is kept)";
  }
  print_row(out, "dropped", text);
  if (removed.collinear_left > 0) {
    print_row(out, "left in",
              counted(removed.collinear_left, "triangle") +
                  " without area: removing them would leave gaps");
  }
}

/// Prints a row if there are parts of this kind.
void print_parts(std::ostream& out, std::string_view name, std::size_t count, std::string_view kind,
                 std::string_view words) {
  if (count > 0) print_row(out, name, counted(count, kind) + std::string(words));
}

/// Returns the anatomical space that the written file states.
std::string written_space(const LoadedMesh& loaded) {
  const std::string& stated = loaded.stated_name;
  if (loaded.space != AnatomicalSpace::unstated) {
    return std::string(name(loaded.space)) + ", stated in the file written";
  }
  return stated.empty() ? "unstated" : "no longer stated: " + stated + " is neither RAS nor LPS";
}

void print_orientation(std::ostream& out, const Orientation& done, std::size_t triangles) {
  print_row(out, "turned",
            grouped(done.turned) + " of " + counted(triangles, "triangle") + ": " +
                grouped(done.disagreeing) + " disagreed with most of their part");
  print_parts(out, "outward", done.closed_parts - done.nested_parts, "closed part",
              done.inside_out_parts == 0 ? ", none inside out"
                                         : ", of these turned as a whole, because inside out: " +
                                               grouped(done.inside_out_parts));
  print_parts(out, "crossing", done.crossing_parts, "closed part",
              ", included in those: only partly within another, so it bounds no cavity; 'keepout "
              "inspect --self-intersections' shows where they cross");
  print_parts(out, "nested", done.nested_parts, "closed part",
              " within another: may bound a cavity or a solid, so each was turned only if the one "
              "around it was");
  constexpr std::string_view undecided = "undecided";
  print_parts(out, undecided, done.open_parts, "open part",
              ": neighbors agree, but no side is known to be free; most triangles keep their "
              "winding");
  print_parts(out, undecided, done.non_manifold_parts, "part",
              " ending at non-manifold edges: neighbors agree within each, but not across those "
              "edges; most triangles keep their winding");
  print_parts(out, undecided, done.flat_parts, "closed part",
              " around no volume: neither side is outside; most triangles keep their winding");
  print_parts(out, undecided, done.one_sided_parts, "one-sided part",
              ", as a Möbius strip is: no winding agrees, so all triangles keep theirs");
}

void print_text(const ConvertOptions& options, const LoadedMesh& loaded, const Conversion& result,
                std::ostream& out) {
  const Surface& surface = result.surface;
  out << options.output.string() << ", from " << options.input.string() << '\n';
  print_row(out, "triangles",
            grouped(loaded.mesh->triangle_count()) + " in, " + grouped(surface.triangles.size()) +
                " out");
  print_row(out, "vertices",
            grouped(loaded.vertices_in_file) + " in, " + grouped(surface.vertices.size()) +
                " out: equal ones are welded");
  print_removed(out, result.removed);
  if (result.orientation) {
    print_orientation(out, *result.orientation, surface.triangles.size());
  } else {
    print_row(out, "turned", "none; --orient makes neighbors agree and closed parts face outward");
  }
  if (result.rounding) {
    print_row(out, "rounded",
              "coordinates to single precision, by at most " + trimmed(*result.rounding, 3) +
                  " mm; .ply keeps all digits");
  }
  print_row(out, "space", written_space(loaded));
}

}  // namespace

std::string fault_of_output(const std::filesystem::path& output) {
  const std::string extension = lower_extension(output);
  if (extension == ".stl" || extension == ".ply") return {};
  return in_quotes(output.string()) +
         " ends in neither .stl nor .ply, which are the formats to write; choose one of them";
}

void convert(const ConvertOptions& options, std::ostream& out) {
  OutputFiles outputs(std::array{NamedPath{"IN", file_of_mesh(options.input)}},
                      {{"OUT", options.output}});
  LoadOptions load = options.load;
  load.check = MeshCheck::none;  // the result is checked instead
  const LoadedMesh loaded = load_named_mesh(options.input, load);
  const Conversion result = converted(options, *loaded.mesh);
  write(options, result.surface, loaded.space, *outputs.stream("OUT"));
  outputs.commit();
  print_text(options, loaded, result, out);
  out.flush();  // before the warnings on stderr
  for (const std::string& warning : quick_check(Mesh(result.surface))) {
    warn_on_stderr(options.output.string() + ": " + warning);
  }
}

}  // namespace keepout::app
