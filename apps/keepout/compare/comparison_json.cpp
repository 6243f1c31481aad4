// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include <ostream>

#include "bench/json_parts.h"
#include "compare/comparison_files.h"
#include "compare/comparison_verdict.h"

namespace keepout::app {
namespace {

Json json_of(const IndexAgreement& a) {
  return {{"mesh", a.mesh},
          {"index", a.index},
          {"activation", a.activation},
          {"searched_by_the_rule", a.searched},
          {"poses", a.poses},
          {"missed", a.missed},
          {"invented", a.invented},
          {"closest_point_error_mm", a.closest_point_error},
          {"plane_angle_rad", a.plane_angle},
          {"step_difference_mm", a.step_difference},
          {"steps_that_differ", a.steps_that_differ}};
}

Json json_of(const SolverAgreement& a) {
  return {{"solver", a.solver},
          {"activation", a.activation},
          {"posed", a.posed},
          {"problems", a.problems},
          {"optimal", a.optimal},
          {"infeasible", a.infeasible},
          {"gave_up", a.gave_up},
          {"wrong", a.wrong},
          {"step_difference", a.step_difference},
          {"kkt_residual", a.kkt_residual},
          {"p50_us", a.median_us},
          {"p99_us", a.p99_us},
          {"outcomes", a.outcomes}};
}

Json json_of(const NarrowPhaseAgreement& a) {
  return {{"backend", a.backend},
          {"tool", a.tool},
          {"relation", a.relation},
          {"pairs", a.pairs},
          {"failed", a.failed},
          {"contradicted", a.contradicted},
          {"median_error_mm", a.median_error},
          {"worst_error_mm", a.worst_error},
          {"worst_unproven_mm", a.worst_unproven},
          {"p50_us", a.median_us},
          {"p99_us", a.p99_us}};
}

template <class Agreement>
Json list_of(const std::vector<Agreement>& agreements) {
  Json list = Json::array();
  for (const Agreement& agreement : agreements) list.push_back(json_of(agreement));
  return list;
}

}  // namespace

void write_json(std::ostream& out, const ComparisonRecord& record) {
  const Comparison& comparison = record.comparison;
  const CompareExtent& extent = record.extent;
  const Json all = {
      {"date", record.date},
      {"command", record.command},
      {"seed", extent.seed},
      {"machine", json_of(record.machine)},
      {"mesh", record.mesh},
      {"triangles", record.triangles},
      {"asked_for",
       {{"poses", extent.poses}, {"problems", extent.problems}, {"pairs", extent.pairs}}},
      {"complete", comparison.complete},
      {"agree", agree(comparison)},
      {"verdict", verdict(comparison)},
      {"indices", list_of(comparison.indices)},
      {"solvers", list_of(comparison.solvers)},
      {"narrow_phases", list_of(comparison.narrow_phases)}};
  out << all.dump(2) << '\n';
}

}  // namespace keepout::app
