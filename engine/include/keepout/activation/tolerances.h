// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace keepout {

// The thresholds of the proofs, in units of their tolerance tau: see the constants of
// docs/certified-step.md. Solvers and the rounding of positions leave errors far below one tau. The
// first three are losses of clearance, in increasing order and about one tau apart. Planes are put
// at the full clearance, so that later cycles regain the loss.
inline constexpr double demand_below = 1.0;         ///< loss of a free motion
inline constexpr double floor_below = 2.0;          ///< loss of a motion along a plane
inline constexpr double lost_below = 2.75;          ///< the required clearance is violated
inline constexpr double touching_within = 4.0;      ///< the tip touches the surface
inline constexpr double needed_clearance = 8.0;     ///< the least required clearance
inline constexpr double region_beyond = 8.0;        ///< the searched region beyond the clearance
inline constexpr double proof_slack = 1.0 / 64.0;   ///< slack of a proof of clearance
inline constexpr double contact_slack = 1.0 / 8.0;  ///< slack of a contact: small compared to
                                                    ///< demand_below

// For the core of an instrument's body, in addition to lost_below.
inline constexpr double plane_rounding = 2.0;  ///< loss of a proof by a plane
inline constexpr double due_gain = 1.0 / 8.0;  ///< least gain of a clearance that rounding has
                                               ///< reduced
inline constexpr double moved_beyond = 4.0;  ///< a larger loss is not rounding: the core was moved
inline constexpr double crossing_within = 3.0;  ///< the core may have crossed the surface
inline constexpr double core_touching_within =
    7.0;                                    ///< the core touches; its side is certain beyond
                                            ///< 6
inline constexpr double needed_band = 4.0;  ///< the least band, and margin beyond the band

}  // namespace keepout
