// SPDX-License-Identifier: BSD-3-Clause
#include "verify/result.h"

#include <algorithm>
#include <sstream>

#include "record/json_parts.h"
#include "record/record.h"
#include "shared/machine.h"
#include "shared/names.h"
#include "shared/number_text.h"

namespace keepout::app {
namespace {

using oracle::Breach;

/// Returns the ratio; null if the divisor is 0.
template <class Part>
Json ratio(Part part, std::uint64_t of) {
  return of == 0 ? Json(nullptr) : Json(static_cast<double>(part) / static_cast<double>(of));
}
auto finite(double Tally::*figure) {
  return [figure](const Tally& t) { return or_null(t.*figure); };
}
auto breaches(Breach breach) {
  return [breach](const Tally& t) { return Json(t[breach]); };
}
template <class Part>
auto per(std::uint64_t Tally::*of, Part Tally::*part) {
  return [of, part](const Tally& t) { return ratio(t.*part, t.*of); };
}

Json cut_share(const Tally& t) {
  return ratio(t.statuses[static_cast<std::size_t>(Status::truncated)], t.cycles);
}

/// Returns the fraction of cycles without a motion that may be executed.
Json unmoved_share(const Tally& t) {
  std::uint64_t unmoved = 0;
  for (std::size_t i = 0; i < status_count; ++i) {
    unmoved += is_ok(static_cast<Status>(i)) ? 0 : t.statuses[i];
  }
  return ratio(unmoved, t.cycles);
}

std::string percent_text(const Json& value) {
  return value.is_null() ? "-" : formatted("%.2f%%", 100.0 * value.get<double>());
}
/// Returns median, 99 %, 99.9 % and maximum as text.
std::string times_text(const Json& us) {
  std::string text;
  for (const auto& [key, value] : us.items()) {
    text += (text.empty() ? "" : "/") + figure_text<2>(value);
  }
  return text;
}

const Columns<Tally>& robot_columns() {
  static const Columns<Tally> all{
      {"mesh", &Tally::mesh, "mesh", -12},
      {"triangles", &Tally::triangles, "triangles", 9, &count_text},
      {"scenario", &Tally::scenario, "scenario", -11},
      {"speed", &Tally::speed, "speed", 5, &figure_text<2>},
      {"cycle_s", &Tally::period},
      {"starts", &Tally::starts, "starts", 6, &count_text},
      {"cycles", &Tally::cycles, "cycles", 11, &count_text},
      {"without_start", &Tally::startless},
      {"below", breaches(Breach::too_near), "below", 7, &count_text},
      {"in_mesh", &Tally::in_mesh, "in mesh", 7, &count_text},
      {"deepest_mm", &Tally::deepest, "deepest", 7, &figure_text<2>},
      {"limits_broken", breaches(Breach::limits_broken), "limits", 6, &count_text},
      {"guides_left", breaches(Breach::guide_left), "guides", 6, &count_text},
      {"strayed", breaches(Breach::strayed), "strayed", 7, &count_text},
      {"undecided", &Tally::undecided, "undec.", 6, &count_text},
      {"first_breach",
       [](const Tally& t) { return t.first_breach > 0 ? Json(t.first_breach) : Json(nullptr); }},
      {"least_beyond_mm", finite(&Tally::least_beyond), "least", 9, &number_text<"%.2e">},
      {"least_beyond_tau", finite(&Tally::least_in_tau), "in tau", 9, &number_text<"%.2e">},
      {"least_guide_tau", finite(&Tally::least_guide_in_tau), "guide", 9, &number_text<"%.2e">},
      {"blocked", &Tally::blocked},
      {"blocked_share", per(&Tally::cycles, &Tally::blocked), "blocked", 7, &percent_text},
      {"cut_share", &cut_share, "cut", 6, &percent_text},
      {"unmoved_share", &unmoved_share, "none", 6, &percent_text},
      {"worse", &Tally::worse, "worse", 5, &count_text},
      {"rounds_sum", &Tally::rounds},
      {"rounds_mean", per(&Tally::cycles, &Tally::rounds), "rounds", 6, &figure_text<3>},
      {"rounds_max", &Tally::most_rounds, "max", 3, &count_text},
      {"rows_sum", &Tally::rows},
      {"rows_mean", per(&Tally::cycles, &Tally::rows), "rows", 5, &figure_text<2>},
      {"step_us", &Tally::step, "us p50/p99/p99.9/max", 22, &times_text},
      {"contact_us", &Tally::contact, "contact us p50/p99/p99.9/max", 28, &times_text},
      {"free_us", &Tally::free, "free us p50/p99/p99.9/max", 25, &times_text},
      {"point_us", &Tally::point, "point us p50/p99/p99.9/max", 26, &times_text},
      {"looks_max", &Tally::most_work_units, "looks", 8, &count_text},
      {"excess_sum", &Tally::excess},
      {"excess_mean", per(&Tally::samples, &Tally::excess), "excess", 7, &figure_text<2>},
      {"excess_samples", &Tally::samples, "of", 5, &count_text},
      {"useful", &Tally::useful, "useful", 6, &count_text},
      {"movable", &Tally::movable, "movable", 7, &count_text},
      {"movable_share", per(&Tally::samples, &Tally::movable), "of bl.", 6, &percent_text},
      {"recoveries", &Tally::recoveries, "recov.", 6, &count_text},
      {"recovered", &Tally::recovered, "in 500", 6, &count_text},
      {"recovery_cycles", &Tally::recovery_cycles},
      {"recovery_cycles_mean", per(&Tally::recovered, &Tally::recovery_cycles), "cycles", 6,
       &figure_text<3>},
      {"statuses", [](const Tally& t) { return json_of<Status>(t.statuses); }},
      {"seconds", &Tally::seconds, "seconds", 7, &figure_text<3>}};
  return all;
}

constexpr const char* robot_legend =
    R"(below: cycles that came closer than guaranteed; an independent judge proves the whole motion of
each cycle. in mesh: of these, cycles in which the mesh reached into a body. limits: cycles that
broke a joint limit. guides: cycles that left a guide by more than guaranteed. strayed: cycles of
status free that ended farther from the command than without motion. undec.: cycles that the judge
neither proved nor refuted. least: smallest clearance beyond the guaranteed one at the ends of
motions, in mm and in tolerances, of which 3 are rounding; guide: the same for guides.
blocked: cycles that executed less than 5 % of the command; worse: cycles farther from the command
than without motion. cut: motions shortened to the proved part; none: no motion. excess: fraction
of the cost that a search could save, in searched blocked cycles; useful: more than 5 %; movable:
the search executed a tenth of the command with the full margin. recov.: a body was closer than a
margin just set; in 500: of these, recovered within 500 cycles. point us: time of the certified
step of a ball at the tip, for comparison. contact us: time of the cycles in which the mesh or a
guide limited the motion; free us: of the others. Lengths in mm.
)";

}  // namespace

CampaignResult finished(Json record, const std::vector<Tally>& rows) {
  const Json& settings = record.at("settings");
  Json& written = record["rows"] = json_of(robot_columns(), rows);
  const Json sums = total_of(written);
  Json total{{"mesh", "total"}};
  for (const char* key : {"cycles", "below", "in_mesh", "deepest_mm", "limits_broken",
                          "guides_left", "strayed", "undecided", "least_beyond_tau", "blocked"}) {
    total[key] = sums[key];
  }
  total.update({{"searched", sums["excess_samples"]}, {"movable", sums["movable"]}});
  std::uint64_t broken = 0;
  Json account = Json::array();
  for (const Tally& t : rows) {
    broken += t.broken();
    if (t.startless == 0) continue;
    account.push_back("On " + t.mesh + ", " + t.scenario + ", only " + counted(t.cycles, "cycle") +
                      ": no start was found " + how_often(t.startless) + ".");
  }
  const std::uint64_t starts = sums["starts"].get<std::uint64_t>();
  if (const auto open = sums["undecided"].get<std::uint64_t>(); open > 0) {
    account.push_back("The judge could not decide " + counted(open, "cycle") + ".");
  }
  if (broken == 0 && starts > 0) account.push_back(rate_bound(starts));
  const bool is_actual = settings.at("motion") == "actual";
  if (!is_actual) {
    account.push_back("The linearized motion was certified, for comparison: this is unsafe.");
  }
  const auto count = [&](const char* key) { return total[key].get<std::uint64_t>(); };
  const bool is_interrupted = !are_whole(record);
  if (is_interrupted) {
    account.push_back("Incomplete: interrupted after " + counted(count("cycles"), "cycle") + ".");
  }
  note_missing(account, record);
  std::string headline = "No breach in ";
  if (broken > 0) {
    headline = counted(count("below"), "cycle") + " too close, " + grouped(count("in_mesh")) +
               " of them in the mesh, " + counted(count("guides_left"), "cycle") +
               " outside a guide, " + counted(count("strayed"), "cycle") + " astray, and " +
               counted(count("limits_broken"), "joint limit") + " broken, in ";
  }
  record["complete"] = missing_shards(record).empty() && !is_interrupted;
  record["headline"] = count("cycles") == 0 ? "Nothing was tested."
                                            : headline + counted(count("cycles"), "cycle") + ".";
  record["account"] = account;
  record["total"] = std::move(total);
  std::ostringstream table;
  print_rows(table, robot_columns(), rows);
  table << robot_legend;
  return {std::move(record), table.str(), is_actual && broken > 0, is_interrupted};
}

CampaignResult result_of_instruments(const Campaign& campaign, const Findings& findings) {
  std::vector<std::string> speeds;
  for (const double speed : campaign.speeds) speeds.push_back(trimmed(speed));
  const std::string robot = campaign.robot.empty() ? "drawn" : campaign.robot;
  const bool is_actual = campaign.motion == CertifiedMotion::actual;
  Json record = new_record(
      {.kind = "verify_robot",
       .command = campaign.command,
       .subject = "Closed-loop motion of a whole instrument, " + robot +
                  ", each cycle judged by an independent oracle",
       .machine = this_machine(),
       .settings = {{"robot", robot},
                    {"scenario", campaign.scenarios.empty() ? "the usual ones"
                                                            : enumerated(campaign.scenarios, ",")},
                    {"cycles", grouped(campaign.cycles)},
                    {"speed", enumerated(speeds, ",")},
                    {"rate", campaign.rate > 0.0 ? trimmed(campaign.rate) + " Hz"
                                                 : "as the joints' velocity limits admit"},
                    {"motion", is_actual ? "actual" : "linearized"},
                    {"margin", trimmed(campaign.margin) + " mm"},
                    {"seed", std::to_string(campaign.seed)},
                    {"index", campaign.index}}});
  if (!campaign.bodies.empty()) record["settings"]["bodies"] = campaign.bodies.string();
  write_shard(record, campaign, findings);
  record["robot"] = robot;
  return finished(std::move(record), findings.rows);
}

}  // namespace keepout::app
