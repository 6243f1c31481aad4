// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "plan/checker.h"

#include "number_text.h"

namespace keepout::app {

std::string Checker::name() const {
  switch (kind) {
    case Kind::sampled:
      return "sampled " + trimmed(100.0 * resolution) + " %";
    case Kind::widened:
      return "widened " + trimmed(100.0 * resolution) + " %";
    case Kind::certified:
      return "certified";
    case Kind::sliding:
      return "sliding";
  }
  return {};
}

std::vector<Checker> checkers(std::span<const double> resolutions) {
  std::vector<Checker> all;
  for (const Checker::Kind kind : {Checker::Kind::sampled, Checker::Kind::widened}) {
    for (const double resolution : resolutions) all.push_back({kind, resolution});
  }
  all.push_back({Checker::Kind::certified});
  all.push_back({Checker::Kind::sliding});
  return all;
}

}  // namespace keepout::app
