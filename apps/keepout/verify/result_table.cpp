// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ostream>

#include "../number_text.h"
#include "result.h"

namespace keepout::app {
namespace {

std::uint64_t count(const Tally& tally, Status status) {
  return tally.statuses[static_cast<std::size_t>(status)];
}
std::uint64_t count(const Tally& tally, Breach breach) {
  return tally.breaches[static_cast<std::size_t>(breach)];
}

std::string scientific(double value) {
  if (!std::isfinite(value)) return "-";
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%.2e", value);
  return text.data();
}

std::string fixed(double value, int decimals) {
  if (!std::isfinite(value)) return "-";
  std::array<char, 64> text;
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return text.data();
}

void print_row(std::ostream& out, const SceneResult& scene) {
  const Tally& t = scene.tally;
  const std::uint64_t limited = count(t, Status::limited);
  const std::uint64_t known = count(t, Status::free) + limited + count(t, Status::recovering) +
                              count(t, Status::fallback) + count(t, Status::unsolved);
  const std::uint64_t crossed = count(t, Breach::penetration);
  const double contact =
      t.steps == 0 ? 0.0 : 100.0 * static_cast<double>(limited) / static_cast<double>(t.steps);
  std::array<char, 320> line;
  std::snprintf(
      line.data(), line.size(),
      "%-16s %9s %8s %12s %6.1f%% %12s %12s %11s %9s %9s %9s %9s %7s %7s %8s %10s %8.1f\n",
      scene.mesh.c_str(), scene.triangles == 0 ? "-" : grouped(scene.triangles).c_str(),
      grouped(t.trajectories).c_str(), grouped(t.steps).c_str(), contact,
      grouped(count(t, Status::free)).c_str(), grouped(limited).c_str(),
      grouped(count(t, Status::recovering)).c_str(), grouped(t.led_out).c_str(),
      grouped(count(t, Status::fallback)).c_str(), grouped(count(t, Status::unsolved)).c_str(),
      grouped(t.steps - known).c_str(), grouped(crossed).c_str(),
      grouped(t.breach_count() - crossed).c_str(), fixed(t.least_in_tau, 3).c_str(),
      scientific(t.least).c_str(), t.seconds);
  out << line.data();
}

void print_header(std::ostream& out) {
  std::array<char, 320> line;
  std::snprintf(line.data(), line.size(),
                "%-16s %9s %8s %12s %7s %12s %12s %11s %9s %9s %9s %9s %7s %7s %8s %10s %8s\n",
                "mesh", "triangles", "traject.", "steps", "contact", "free", "limited",
                "recovering", "led out", "fallback", "unsolved", "other", "crossed", "broken",
                "least/tau", "least", "seconds");
  out << line.data();
}

}  // namespace

void print(std::ostream& out, const CampaignResult& result) {
  print_header(out);
  for (const SceneResult& scene : result.findings.scenes) print_row(out, scene);
  const Tally total = result.findings.total();
  print_row(out, {.mesh = "total", .tally = total});
  out << "contact: share of limited steps. led out: of the recovering ones, those from the\n"
         "forbidden side, which may cross. other: steps without a motion. crossed, broken: "
         "breaches\n"
         "of the theorem. least: smallest distance - margin of any way, in tau and as it is.\n";
  for (const std::string& mesh : result.missing) out << "missing: " << mesh << '\n';
  for (const std::uint64_t shard : missing_shards(result)) {
    out << "missing: shard " << shard << "/" << result.shard_count << '\n';
  }
  for (const ShardRun& shard : result.shards) {
    out << "shard " << shard.index << "/" << result.shard_count << ": " << fixed(shard.seconds, 1)
        << " s on " << shard.machine << (shard.is_whole ? "" : ", interrupted") << '\n';
  }
  constexpr std::size_t shown = 5;
  const std::vector<Incident>& breaches = result.findings.breaches;
  for (std::size_t i = 0; i < std::min(shown, breaches.size()); ++i) out << text(breaches[i]);
  const std::uint64_t broken = total.breach_count();
  if (broken == 0) {
    out << "no breach in " << counted(total.steps, "step") << '\n';
  } else {
    out << grouped(broken) << (broken == 1 ? " breach in " : " breaches in ")
        << counted(total.steps, "step") << "; --json keeps " << grouped(breaches.size())
        << " of them\n";
  }
  if (!is_complete(result)) {
    out << "incomplete: " << grouped(total.steps) << " of the campaign's "
        << counted(result.steps, "step") << " are done\n";
  }
}

}  // namespace keepout::app
