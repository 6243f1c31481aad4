// SPDX-License-Identifier: BSD-3-Clause
#include "verify/robot/result.h"

#include <cmath>
#include <ostream>

#include "record/json_parts.h"
#include "shared/number_text.h"

namespace keepout::app {
namespace {

/// Null where there is nothing to divide by.
Json ratio(double part, std::uint64_t of) {
  return of == 0 ? Json(nullptr) : Json(part / static_cast<double>(of));
}
Json ratio(std::uint64_t part, std::uint64_t of) { return ratio(static_cast<double>(part), of); }

Json or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json share_of(const RobotTally& t, Status status) {
  return ratio(t.statuses[static_cast<std::size_t>(status)], t.cycles);
}

/// Of cycles that ended without a motion that may be carried out.
Json unmoved_share(const RobotTally& t) {
  std::uint64_t unmoved = 0;
  for (std::size_t i = 0; i < status_count; ++i) {
    unmoved += is_ok(static_cast<Status>(i)) ? 0 : t.statuses[i];
  }
  return ratio(unmoved, t.cycles);
}

Json statuses(const RobotTally& t) {
  Json json = Json::object();
  for (std::size_t i = 0; i < status_count; ++i) {
    json[std::string(name(static_cast<Status>(i)))] = t.statuses[i];
  }
  return json;
}

std::string count_text(const Json& value) { return grouped(value.get<std::uint64_t>()); }
template <int digits>
std::string figure(const Json& value) {
  return value.is_null() ? "-" : rounded(value.get<double>(), digits);
}
std::string percent_text(const Json& value) {
  return value.is_null() ? "-" : formatted("%.2f%%", 100.0 * value.get<double>());
}
std::string tiny(const Json& value) {
  return value.is_null() ? "-" : formatted("%.2e", value.get<double>());
}
/// Median, 99 %, 99.9 % and the longest.
std::string times_text(const Json& us) {
  std::string text;
  for (const auto& [key, value] : us.items()) {
    text += (text.empty() ? "" : "/") + (value.is_null() ? "-" : rounded(value.get<double>(), 2));
  }
  return text;
}

const Columns<RobotTally>& robot_columns() {
  using Tally = RobotTally;
  static const Columns<Tally> all{
      {"mesh", &Tally::mesh, "mesh", -12},
      {"triangles", &Tally::triangles, "triangles", 9, &count_text},
      {"scenario", &Tally::scenario, "scenario", -11},
      {"speed", &Tally::speed, "speed", 5, &figure<2>},
      {"cycle_s", [](const Tally& t) { return Json(t.period); }},
      {"starts", &Tally::starts, "starts", 6, &count_text},
      {"cycles", &Tally::cycles, "cycles", 11, &count_text},
      {"below", &Tally::below, "below", 7, &count_text},
      {"in_mesh", &Tally::in_mesh, "in mesh", 7, &count_text},
      {"deepest_mm", &Tally::deepest, "deepest", 7, &figure<2>},
      {"limits_broken", &Tally::limits_broken, "limits", 6, &count_text},
      {"guides_left", &Tally::guides_left, "guides", 6, &count_text},
      {"strayed", &Tally::strayed, "strayed", 7, &count_text},
      {"first_breach",
       [](const Tally& t) { return t.first_breach > 0 ? Json(t.first_breach) : Json(nullptr); }},
      {"least_beyond_mm", [](const Tally& t) { return or_null(t.least_beyond); }, "least", 9,
       &tiny},
      {"least_beyond_tau", [](const Tally& t) { return or_null(t.least_in_tau); }, "in tau", 9,
       &tiny},
      {"least_guide_tau", [](const Tally& t) { return or_null(t.least_guide_in_tau); }, "guide", 9,
       &tiny},
      {"blocked_share", [](const Tally& t) { return ratio(t.blocked, t.cycles); }, "blocked", 7,
       &percent_text},
      {"cut_share", [](const Tally& t) { return share_of(t, Status::fallback); }, "cut", 6,
       &percent_text},
      {"unmoved_share", [](const Tally& t) { return unmoved_share(t); }, "none", 6, &percent_text},
      {"worse", &Tally::worse, "worse", 5, &count_text},
      {"rounds_mean", [](const Tally& t) { return ratio(t.rounds, t.cycles); }, "rounds", 6,
       &figure<3>},
      {"rounds_max", &Tally::most_rounds, "max", 3, &count_text},
      {"rows_mean", [](const Tally& t) { return ratio(t.rows, t.cycles); }, "rows", 5, &figure<2>},
      {"step_us", [](const Tally& t) { return Json(t.step); }, "us p50/p99/p99.9/max", 22,
       &times_text},
      {"point_us", [](const Tally& t) { return Json(t.point); }, "point us p50/p99/p99.9/max", 26,
       &times_text},
      {"looks_max", &Tally::most_looks, "looks", 8, &count_text},
      {"excess_mean", [](const Tally& t) { return ratio(t.excess, t.samples); }, "excess", 7,
       &figure<2>},
      {"excess_samples", &Tally::samples, "of", 5, &count_text},
      {"useful", &Tally::useful, "useful", 6, &count_text},
      {"movable", &Tally::movable, "movable", 7, &count_text},
      {"movable_share", [](const Tally& t) { return ratio(t.movable, t.samples); }, "of bl.", 6,
       &percent_text},
      {"recoveries", &Tally::recoveries, "recov.", 6, &count_text},
      {"recovered", &Tally::recovered, "in 500", 6, &count_text},
      {"recovery_cycles_mean", [](const Tally& t) { return ratio(t.recovery_cycles, t.recovered); },
       "cycles", 6, &figure<3>},
      {"statuses", &statuses},
      {"seconds", &Tally::seconds, "seconds", 7, &figure<3>}};
  return all;
}

constexpr const char* legend =
    R"(below: cycles that came closer than was promised, as an independent judge sees 15 poses of each;
in mesh: of them, those in which the mesh reached into a body. limits: cycles that broke a joint's.
guides: cycles that left a guide by more than is promised. strayed: cycles of status free that ended
farther from what was asked than standing still. least: smallest clearance beyond what was promised,
in mm and in tolerances, of which 3 are rounding; guide: the same of guides. blocked: cycles that made
less than 5 % of what was asked; worse: those whose motion was more off than none. cut: to the part that
was proven; none: nothing was. excess: cost that a search could still save, of all there is, in blocked
cycles that were searched; useful: more than 5 %; movable: the search made a tenth of what was asked, at
the full margin. recov.: how often a body was closer than a margin just set; in 500: of them within 500
cycles. point us: of the certified step of a ball at the tip, beside each. Lengths in mm.
)";

}  // namespace

std::uint64_t robot_breaches(const Json& record) {
  const Json& total = record.at("total");
  std::uint64_t sum = 0;
  for (const char* kind : {"below", "limits_broken", "guides_left", "strayed"}) {
    sum += total.at(kind).get<std::uint64_t>();
  }
  return sum;
}

Json result_of(const RobotCampaign& campaign, const std::string& command, const std::string& index,
               const std::vector<RobotTally>& tallies, std::size_t meshes) {
  RobotTally total;
  total.mesh = "total";
  std::vector<std::string> account;
  for (const RobotTally& t : tallies) {
    total.cycles += t.cycles;
    total.below += t.below;
    total.in_mesh += t.in_mesh;
    total.limits_broken += t.limits_broken;
    total.guides_left += t.guides_left;
    total.strayed += t.strayed;
    total.blocked += t.blocked;
    total.samples += t.samples;
    total.movable += t.movable;
    total.least_in_tau = std::min(total.least_in_tau, t.least_in_tau);
    total.deepest = std::max(total.deepest, t.deepest);
    if (t.is_out_of_starts) {
      account.push_back("On " + t.mesh + ", " + t.scenario + ", only " +
                        counted(t.cycles, "cycle") + ": no other place was found to begin.");
    }
  }
  const bool is_actual = campaign.motion == CertifiedMotion::actual;
  if (!is_actual) account.emplace_back("The linearised motion was certified: unsafe, to compare.");
  std::string headline = "No breach in ";
  if (breaches(total) > 0) {
    headline = counted(total.below, "cycle") + " too close, " + grouped(total.in_mesh) +
               " of them in the mesh, " + counted(total.guides_left, "cycle") +
               " outside of a guide, " + counted(total.strayed, "cycle") + " astray, and " +
               counted(total.limits_broken, "joint limit") + " broken, in ";
  }
  std::string speeds;
  for (const double s : campaign.speeds) speeds += (speeds.empty() ? "" : ",") + trimmed(s);
  std::string scenarios = campaign.scenarios.empty() ? "the usual ones" : "";
  for (const std::string& one : campaign.scenarios) {
    scenarios += (scenarios.empty() ? "" : ",") + one;
  }
  const std::string robot = campaign.robot.empty() ? "drawn" : campaign.robot;
  const bool is_complete = tallies.size() == meshes * rows_of(campaign).size() &&
                           std::ranges::all_of(tallies, [&](const RobotTally& t) {
                             return t.is_out_of_starts || t.cycles >= campaign.cycles;
                           });
  Json record = new_record({.kind = "verify_robot",
                            .command = command,
                            .complete = is_complete,
                            .subject = "Closed-loop motion of a whole instrument, " + robot +
                                       ", each cycle judged by an independent "
                                       "oracle",
                            .headline = headline + counted(total.cycles, "cycle") + ".",
                            .account = account,
                            .machine = this_machine(),
                            .settings = {{"robot", robot},
                                         {"scenario", scenarios},
                                         {"cycles", grouped(campaign.cycles)},
                                         {"speed", speeds},
                                         {"motion", is_actual ? "actual" : "linearised"},
                                         {"margin", trimmed(campaign.margin) + " mm"},
                                         {"seed", std::to_string(campaign.seed)},
                                         {"index", index}}});
  record["robot"] = robot;
  record["rows"] = json_of(robot_columns(), tallies);
  record["total"] = {{"mesh", total.mesh},
                     {"cycles", total.cycles},
                     {"below", total.below},
                     {"in_mesh", total.in_mesh},
                     {"deepest_mm", total.deepest},
                     {"limits_broken", total.limits_broken},
                     {"guides_left", total.guides_left},
                     {"strayed", total.strayed},
                     {"least_beyond_tau", or_null(total.least_in_tau)},
                     {"blocked", total.blocked},
                     {"searched", total.samples},
                     {"movable", total.movable}};
  return record;
}

void print_robot_result(std::ostream& out, const Json& record) {
  print_headings(out, robot_columns());
  out << '\n';
  for (const Json& row : record.at("rows")) {
    print_cells(out, robot_columns(),
                [&](const auto& column) { return column.text(row.at(column.key)); });
    out << '\n';
  }
  out << legend << record.at("headline").get<std::string>() << '\n';
  for (const Json& text : record.at("account")) out << text.get<std::string>() << '\n';
}

}  // namespace keepout::app
