// SPDX-License-Identifier: BSD-3-Clause
#include "shared/findings.h"

#include "shared/number_text.h"

namespace keepout::app {

std::vector<Finding> findings_of(const MeshFindings& mesh,
                                 const std::optional<SelfIntersections>& self_intersections,
                                 bool is_scaled) {
  constexpr std::string_view check_scale = "check the unit or the scale that was given";
  const SelfIntersections crossings = self_intersections.value_or(SelfIntersections{});
  const std::vector<Finding> all{
      {"inside_out", mesh.is_inside_out(), "",
       "the normals point into the solid: tissue and free space are swapped",
       "flip all triangles: --flip, flip=True in Python, or 'keepout convert --orient'"},
      {"looks_like_meters", mesh.looks_like_meters(), "",
       "smaller than 3 in every direction: in millimeters that is tiny, so these may be meters",
       is_scaled ? check_scale
                 : "give the unit of the file: --unit m, or another that 'unit' above names; in "
                   "Python unit=\"m\""},
      {"looks_like_micrometers", mesh.looks_like_micrometers(), "",
       "larger than 3000 in some direction: 3 m in millimeters, so these may be micrometers, or "
       "something lies far from the rest",
       is_scaled ? check_scale
                 : "give the unit of the file if so: --unit um, or in Python unit=\"um\""},
      {"inconsistent_edges", mesh.inconsistent_edges, "inconsistently wound edge",
       "the two triangles there disagree about which side is free",
       "orient the surface consistently: 'keepout convert --orient'",
       mesh.places.inconsistent_edges},
      {"boundary_edges", mesh.boundary_edges, "boundary edge",
       "the surface is open: a hole is not guarded, and with the rule 'paper' a tip can also pass "
       "at a rim",
       "close the holes, or keep the tool away from the rims", mesh.places.boundary_edges},
      {"non_manifold_edges", mesh.non_manifold_edges, "non-manifold edge",
       "three triangles or more meet there, so no rule can distinguish a ridge from a valley",
       "remove inner walls and duplicates, or use a rule that does not use neighbors",
       mesh.places.non_manifold_edges},
      {"self_intersections", crossings.pairs, "self-intersecting pair",
       "triangles cut through or lie on each other; a tip can get stuck behind such a place",
       "remesh the surface, or take its outer hull", crossings.places},
      {"duplicate_triangles", mesh.duplicate_triangles, "duplicate triangle",
       "the same three vertices again; each triangle adds its own planes",
       "remove them: 'keepout convert'", mesh.places.duplicate_triangles},
      {"degenerate_triangles", mesh.degenerate_triangles(), "degenerate triangle",
       "without area they have no normal, and guard less than a proper triangle, or nothing",
       "remesh, or collapse their short edges; 'keepout convert' drops those that leave no gap",
       mesh.places.degenerate_triangles},
      {"pinched_vertices", mesh.pinched_vertices, "pinched vertex",
       "parts of the surface touch only at this vertex", "split the vertex, or remesh",
       mesh.places.pinched_vertices},
  };
  std::vector<Finding> present;
  for (const Finding& finding : all) {
    if (finding.count > 0) present.push_back(finding);
  }
  return present;
}

std::string text_of(const Finding& finding) {
  const std::string count = finding.one.empty() ? "" : counted(finding.count, finding.one) + ": ";
  return count + std::string(finding.meaning);
}

}  // namespace keepout::app
