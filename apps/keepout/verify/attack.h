// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "verify/campaign.h"

namespace keepout::app {

/// One row of a campaign: trajectories of a tip, or of an instrument, in closed loop on one mesh.
class Attack {
 public:
  explicit Attack(Tally tally) : row(std::move(tally)) {}
  virtual ~Attack() = default;

  /// Draws the start of the next trajectory. Loads the mesh before the first one. Returns the
  /// largest number of cycles of the trajectory; 0 if no trajectory is left, or without a mesh.
  virtual std::uint64_t begin() = 0;

  /// Commands a motion, runs the step, lets the judge examine it, tallies it and applies it.
  /// `number`: the cycle in the trajectory. Returns false if the trajectory ends here.
  virtual bool cycle(std::uint64_t number) = 0;

  /// Returns true if no trajectory is left.
  virtual bool is_done() const = 0;

  Tally row;
  Times step_times = {}, contact_times = {}, free_times = {}, point_times = {};  // see Tally
};
using Attacks = std::vector<std::unique_ptr<Attack>>;

/// Return the rows of a campaign. Arguments must outlive the attacks.
Attacks attacks_on_tips(const Campaign& campaign, std::span<const Arena> arenas,
                        Findings& findings);
Attacks attacks_on_instruments(const Campaign& campaign, std::span<const Arena> arenas);

}  // namespace keepout::app
