// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "judge.h"
#include "setup.h"

namespace keepout::app {

using Json = nlohmann::ordered_json;

/// One step that should not have been, with everything that is needed to do it again.
struct Incident {
  std::string what;  // a breach; or the status of a step that found no motion
  std::string scene;
  std::uint64_t trajectory = 0;
  std::uint64_t cycle = 0;
  Setup setup;  // as the tip was put down
  Vec3 tip = Vec3::Zero();
  Vec3 desired = Vec3::Zero();
  Vec3 motion = Vec3::Zero();
  Status status = Status::free;
  std::vector<double> jacobian = {};    // 3 x n, column by column; empty without one
  std::vector<double> row_matrix = {};  // of the extra rows, row by row
  std::vector<double> row_bounds = {};
  Verdict verdict = {};
};

Incident make_incident(std::string what, const Scene& scene, const Setup& setup,
                       const Motion& motion, const Step& step, const Verdict& verdict);

/// All of it, every number to its last digit; none (null) for what is not finite.
void to_json(Json& json, const Incident& incident);

/// An incident in a few lines, but without Jacobian and rows.
std::string text(const Json& incident);

}  // namespace keepout::app
