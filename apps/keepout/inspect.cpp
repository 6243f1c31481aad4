// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <iostream>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "commands.h"
#include "keepout/index/pd_tree.h"
#include "keepout/index/self_intersection.h"
#include "keepout/mesh/diagnostics.h"
#include "record/drawn_mesh.h"
#include "record/record.h"
#include "record/report_page.h"
#include "shared/columns.h"
#include "shared/fact_row.h"
#include "shared/findings.h"
#include "shared/named_mesh.h"
#include "shared/number_text.h"
#include "shared/progress.h"
#include "shared/stop_signal.h"

namespace keepout::app {
namespace {

// The most places of each kind of fault.
constexpr std::size_t places_in_text = 3;
constexpr std::size_t places_in_json = 10;
constexpr std::size_t places_on_page = 2000;

struct Inspection {
  LoadedMesh loaded;
  MeshFindings mesh;
  std::optional<SelfIntersections> self_intersections;
  std::vector<Finding> findings;
};

Inspection examine_file(const InspectOptions& options) {
  const StopSignal stop({}, BeforeWork::ends_process);
  Inspection inspection;
  LoadOptions load = options.load;
  load.check = MeshCheck::none;  // the findings contain all results of this check, and more
  inspection.loaded = read_named_mesh(options.mesh, load);
  const Mesh& mesh = *inspection.loaded.mesh;
  const std::size_t most = options.page ? places_on_page : places_in_json;
  inspection.mesh = examine(mesh, most);
  if (options.self_intersections) {
    Progress progress("inspect", mesh.triangle_count());
    const PdTree tree(inspection.loaded.mesh);
    inspection.self_intersections =
        find_self_intersections(mesh, tree, most, [&progress] { progress.advance(); });
  }
  inspection.findings =
      findings_of(inspection.mesh, inspection.self_intersections, inspection.loaded.scale != 1.0);
  return inspection;
}

std::string triple(const Vec3& v, std::string_view between) {
  std::string text = trimmed(v.x());
  for (const double value : {v.y(), v.z()}) text.append(between).append(trimmed(value));
  return text;
}

/// Returns the unit that was requested or is assumed, and the other plausible units.
std::string unit_text(const LoadOptions& load, double extent) {
  if (load.scale) return "mm, scaled by " + trimmed(*load.scale) + " as asked";
  if (!load.unit.empty()) return "mm, from a file in " + load.unit + " as asked";
  std::string text = "mm, which is assumed";
  std::string_view joint = "; as plausible: ";
  for (const UnitGuess& guess : other_units(extent)) {
    text.append(joint).append(guess.unit).append(" (").append(trimmed(extent * guess.millimetres));
    text += " mm)";
    joint = ", ";
  }
  return text;
}

/// Returns the anatomical space, and how it is known.
std::string space_text(const LoadedMesh& loaded) {
  if (!loaded.stated_name.empty() && loaded.stated == AnatomicalSpace::unstated) {
    return loaded.stated_name + ", as stated in the file: neither RAS nor LPS";
  }
  if (loaded.space == AnatomicalSpace::unstated) return "the file states neither RAS nor LPS";
  std::string text(name(loaded.space));
  if (loaded.stated == AnatomicalSpace::unstated) return text + ", not stated in the file";
  if (loaded.stated == loaded.space) return text + ", as stated in the file";
  return text + ", turned from " + std::string(name(loaded.stated));
}

/// Returns one place of each of the first groups of faults, and the number of other groups.
std::string where_text(const FaultPlaces& places) {
  std::string text;
  const std::size_t count = std::min({places_in_text, places.groups, places.places.size()});
  for (std::size_t i = 0; i < count; ++i) {
    text.append(i == 0 ? "near (" : ", (").append(triple(places.places[i].at, ", ")) += ')';
  }
  text += " mm";
  const std::size_t more = places.groups - count;
  return more > 0 ? text + ", and in " + counted(more, "more place") : text;
}

/// Returns the name for JSON; null if the space is unknown.
Json or_null(AnatomicalSpace space) {
  if (space == AnatomicalSpace::unstated) return nullptr;
  return name(space);
}

/// Returns a text for JSON; null if it is empty.
Json or_null(const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); }

void print_text(const InspectOptions& options, const Inspection& inspection, std::ostream& out) {
  const MeshFindings& mesh = inspection.mesh;
  out << options.mesh.string() << '\n';
  print_row(out, "triangles", grouped(mesh.triangles));
  print_row(out, "vertices", grouped(mesh.vertices));
  print_row(out, "edges", grouped(mesh.edges));
  print_row(out, "components", grouped(mesh.components));
  print_row(out, "size", triple(mesh.bounds.size(), " x ") + " mm");
  print_row(out, "from", triple(mesh.bounds.low, ", ") + " mm");
  print_row(out, "to", triple(mesh.bounds.high, ", ") + " mm");
  print_row(out, "unit", unit_text(options.load, mesh.bounds.size().maxCoeff()));
  print_row(out, "space", space_text(inspection.loaded));
  if (inspection.loaded.flipped) print_row(out, "winding", "flipped, as asked");
  print_row(out, "area", trimmed(mesh.area) + " mm^2");
  if (mesh.is_watertight()) {
    print_row(out, "volume", trimmed(mesh.signed_volume) + " mm^3");
  }
  print_row(out, "surface",
            mesh.is_watertight() ? "watertight"
            : mesh.is_closed()   ? "closed, but not a manifold with one orientation"
                                 : "open");
  if (mesh.genus) print_row(out, "handles", grouped(static_cast<std::size_t>(*mesh.genus)));
  if (inspection.self_intersections) {
    print_row(out, "intersecting",
              grouped(inspection.self_intersections->pairs) + " pairs of triangles");
  }

  out << "\nFindings\n";
  if (inspection.findings.empty() && inspection.loaded.warnings.empty()) out << "  none\n";
  for (const Finding& finding : inspection.findings) {
    out << "  - " << text_of(finding) << ".\n";
    if (finding.places.groups > 0) out << "    Where: " << where_text(finding.places) << ".\n";
    out << "    What to do: " << finding.advice << ".\n";
  }
  for (const std::string& warning : inspection.loaded.warnings) {
    out << "  - " << warning << ".\n";
  }
}

template <class T>
Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

/// Returns at most `most` places, for JSON.
Json list_of(const FaultPlaces& places, std::size_t most) {
  Json list = Json::array();
  for (const FaultPlace& place : places.places) {
    if (list.size() == most) break;
    Json corners = Json::array();
    for (const Vec3& corner : place.corners) corners.push_back(json_of(corner));
    list.push_back({{"at", json_of(place.at)}, {"corners", std::move(corners)}});
  }
  return list;
}

/// Returns all results, with at most `most_places` places of each kind of fault.
Json members_of(const Inspection& inspection, std::size_t most_places) {
  const MeshFindings& mesh = inspection.mesh;
  const auto& crossings = inspection.self_intersections;
  Json json{{"unit", "mm"},
            {"other_units", Json::array()},
            {"space", or_null(inspection.loaded.space)},
            {"stated_space", or_null(inspection.loaded.stated_name)},
            {"triangles", mesh.triangles},
            {"vertices", mesh.vertices},
            {"edges", mesh.edges},
            {"components", mesh.components},
            {"edge_components", mesh.edge_components},
            {"boundary_edges", mesh.boundary_edges},
            {"non_manifold_edges", mesh.non_manifold_edges},
            {"inconsistent_edges", mesh.inconsistent_edges},
            {"pinched_vertices", mesh.pinched_vertices},
            {"repeated_vertex_triangles", mesh.repeated_vertex_triangles},
            {"collinear_triangles", mesh.collinear_triangles},
            {"duplicate_triangles", mesh.duplicate_triangles},
            {"closed", mesh.is_closed()},
            {"watertight", mesh.is_watertight()},
            {"inside_out", mesh.is_inside_out()},
            {"looks_like_meters", mesh.looks_like_meters()},
            {"looks_like_micrometers", mesh.looks_like_micrometers()},
            {"euler_characteristic", mesh.euler_characteristic},
            {"genus", or_null(mesh.genus)},
            {"area", mesh.area},
            // The volume of an open surface would depend on the position of the origin.
            {"signed_volume", mesh.is_watertight() ? Json(mesh.signed_volume) : nullptr},
            {"bounds", {{"low", json_of(mesh.bounds.low)}, {"high", json_of(mesh.bounds.high)}}},
            {"self_intersections", crossings ? Json(crossings->pairs) : Json(nullptr)},
            {"scale", inspection.loaded.scale},
            {"flipped", inspection.loaded.flipped},
            {"warnings", inspection.loaded.warnings},
            {"notices", inspection.loaded.notices},
            {"most_places", most_places},
            {"findings", Json::array()}};
  for (const UnitGuess& guess : other_units(mesh.bounds.size().maxCoeff())) {
    json["other_units"].push_back({{"unit", guess.unit}, {"scale", guess.millimetres}});
  }
  for (const Finding& finding : inspection.findings) {
    json["findings"].push_back({{"key", finding.key},
                                {"count", finding.count},
                                {"text", text_of(finding)},
                                {"meaning", finding.meaning},
                                {"advice", finding.advice},
                                {"groups", finding.places.groups},
                                {"places", list_of(finding.places, most_places)}});
  }
  return json;
}

void print_json(const InspectOptions& options, const Inspection& inspection, std::ostream& out) {
  Json json{{"mesh", options.mesh.string()}};
  json.update(members_of(inspection, places_in_json));
  // A file name may be invalid UTF-8, which JSON does not allow.
  out << json.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
}

/// Returns a headline, such as "2 boundary edges, 1 degenerate triangle, inside out".
std::string headline_of(const std::string& mesh, const Inspection& inspection) {
  std::string text;
  for (const Finding& finding : inspection.findings) {
    std::string fault(finding.key);
    std::ranges::replace(fault, '_', ' ');
    if (!finding.one.empty()) fault = counted(finding.count, finding.one);
    text += (text.empty() ? "" : ", ") + fault;
  }
  return mesh + ": " + (text.empty() ? "no faults were found" : text) + ".";
}

/// Returns the record of the page: see docs/records.md.
Json record_of(const InspectOptions& options, const Inspection& inspection) {
  const std::string name = options.mesh.filename().string();
  Json record = new_record({.kind = "inspect",
                            .command = options.command,
                            .subject = "What " + name + " is made of, and what is wrong with it",
                            .headline = headline_of(name, inspection)});
  record["mesh"] = drawn_mesh(name, *inspection.loaded.mesh);
  record["mesh"]["surface"] = inspection.mesh.is_closed() ? "closed" : "open";
  record["inspection"] = members_of(inspection, places_on_page);
  return record;
}

/// Returns the text that precedes the file name of the page.
std::string page_text(const Json& record, const Inspection& inspection) {
  if (!missing_template(record).empty()) return "Page, with tables, no pictures: ";
  const auto is_marked = [](const Finding& finding) { return finding.places.groups > 0; };
  return std::ranges::any_of(inspection.findings, is_marked) ? "Page with the faults marked: "
                                                             : "Page: ";
}

}  // namespace

void inspect(const InspectOptions& options, std::ostream& out) {
  const RecordFiles files{.json = {}, .page = options.page};
  OutputFiles outputs = files.open({options.mesh});
  const Inspection inspection = examine_file(options);
  std::string page;
  if (options.page) {
    const Json record = record_of(options, inspection);
    write_record(outputs, record, files);
    page = page_text(record, inspection) + options.page->string();
  }
  if (options.json) {
    print_json(options, inspection, out);
    return;
  }
  print_text(options, inspection, out);
  if (options.page) out << '\n' << page << '\n';
}

}  // namespace keepout::app
