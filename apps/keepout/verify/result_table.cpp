// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <numeric>
#include <ostream>

#include "../number_text.h"
#include "result.h"

namespace keepout::app {
namespace {

std::uint64_t count(const Json& counts, const char* name) {
  return counts.at(name).get<std::uint64_t>();
}

/// "-" where there is none.
std::string number(const char* format, const Json& value) {
  return value.is_null() ? "-" : formatted(format, value.get<double>());
}

/// The shards that are not there.
std::vector<std::uint64_t> missing_shards(const Json& result) {
  std::vector<std::uint64_t> missing(count(result, "shard_count"));
  std::iota(missing.begin(), missing.end(), 1);
  for (const Json& shard : result.at("shards")) std::erase(missing, count(shard, "index"));
  return missing;
}

void print_row(std::ostream& out, const Json& mesh) {
  const Json& statuses = mesh.at("statuses");
  const std::uint64_t steps = count(mesh, "steps");
  std::uint64_t other = steps;
  for (const char* known : {"free", "limited", "recovering", "fallback", "unsolved"}) {
    other -= count(statuses, known);
  }
  std::uint64_t broken = 0;
  for (const Json& breaches : mesh.at("breaches")) broken += breaches.get<std::uint64_t>();
  const std::uint64_t crossed = count(mesh.at("breaches"), "penetration");
  const std::uint64_t limited = count(statuses, "limited");
  const double contact =
      steps == 0 ? 0.0 : 100.0 * static_cast<double>(limited) / static_cast<double>(steps);
  const std::uint64_t triangles = mesh.value("triangles", std::uint64_t{0});
  out << formatted(
      "%-16s %9s %8s %12s %6.1f%% %12s %12s %11s %9s %9s %9s %9s %7s %7s %8s %10s %8.1f\n",
      mesh.at("mesh").get<std::string>().c_str(), triangles == 0 ? "-" : grouped(triangles).c_str(),
      grouped(count(mesh, "trajectories")).c_str(), grouped(steps).c_str(), contact,
      grouped(count(statuses, "free")).c_str(), grouped(limited).c_str(),
      grouped(count(statuses, "recovering")).c_str(), grouped(count(mesh, "led_out")).c_str(),
      grouped(count(statuses, "fallback")).c_str(), grouped(count(statuses, "unsolved")).c_str(),
      grouped(other).c_str(), grouped(crossed).c_str(), grouped(broken - crossed).c_str(),
      number("%.3f", mesh.at("least_beyond_margin_in_tau")).c_str(),
      number("%.2e", mesh.at("least_beyond_margin")).c_str(), mesh.at("seconds").get<double>());
}

void print_header(std::ostream& out) {
  out << formatted("%-16s %9s %8s %12s %7s %12s %12s %11s %9s %9s %9s %9s %7s %7s %8s %10s %8s\n",
                   "mesh", "triangles", "traject.", "steps", "contact", "free", "limited",
                   "recovering", "led out", "fallback", "unsolved", "other", "crossed", "broken",
                   "least/tau", "least", "seconds");
}

}  // namespace

bool is_complete(const Json& result) {
  return missing_shards(result).empty() &&
         std::ranges::all_of(result.at("shards").get<std::vector<Json>>(),
                             [](const Json& shard) { return shard.value("complete", true); });
}

void print(std::ostream& out, const Json& result) {
  print_header(out);
  for (const Json& mesh : result.at("meshes")) print_row(out, mesh);
  const Json& total = result.at("total");
  print_row(out, total);
  out << "contact: share of limited steps. led out: of the recovering ones, those from the\n"
         "forbidden side, which may cross. other: steps without a motion. crossed, broken: "
         "breaches\n"
         "of the theorem. least: smallest distance of any way, less tool radius and margin, in\n"
         "tau and as it is.\n";
  for (const Json& mesh : result.at("missing")) {
    out << "missing: " << mesh.get<std::string>() << '\n';
  }
  const std::string shards = "/" + result.at("shard_count").dump();
  for (const std::uint64_t shard : missing_shards(result)) {
    out << "missing: shard " << shard << shards << '\n';
  }
  for (const Json& shard : result.at("shards")) {
    out << "shard " << shard.at("index") << shards << ": " << number("%.1f", shard.at("seconds"))
        << " s on " << shard.at("machine").get<std::string>()
        << (shard.value("complete", true) ? "" : ", interrupted") << '\n';
  }
  constexpr std::size_t shown = 5;
  const Json& breaches = result.at("breaches");
  for (std::size_t i = 0; i < std::min(shown, breaches.size()); ++i) out << text(breaches[i]);
  const std::uint64_t broken = breach_count(result);
  const std::uint64_t steps = count(total, "steps");
  if (broken == 0) {
    out << "no breach in " << counted(steps, "step") << '\n';
  } else {
    out << grouped(broken) << (broken == 1 ? " breach in " : " breaches in ")
        << counted(steps, "step") << "; --json keeps " << grouped(breaches.size()) << " of them\n";
  }
  if (!is_complete(result)) {
    out << "incomplete: " << grouped(steps) << " of the campaign's "
        << counted(count(result, "steps"), "step") << " are done\n";
  }
}

}  // namespace keepout::app
