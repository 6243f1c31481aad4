// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "keepout/factory/make_instrument_constraint.h"
#include "keepout/factory/make_motion_constraint.h"
#include "keepout/step/side_watch.h"
#include "serve/request.h"

namespace keepout::app {

/// What is kept of one client from request to request.
struct Client {
  SideWatch tip;                                                  // where his last step led it
  std::optional<InstrumentConstraint> instrument = std::nullopt;  // that he has opened
  std::optional<MotionConstraint> own = std::nullopt;  // for a tool or guides of this client
  std::vector<std::string> tip_guide_names = {};       // of its tip
  std::vector<std::string> guide_names = {};           // of its instrument
};

/// Opens the instrument of a request in place of the one that there was; `settings` are what it
/// says nothing of. Throws Refusal, "no_instrument", and leaves that one, for what is no
/// instrument. Reads a file, and allocates.
void open_instrument(Client& client, const std::shared_ptr<const Mesh>& mesh,
                     const std::shared_ptr<const SpatialIndex>& index,
                     InstrumentConstraintSettings settings, const Request& request);

/// The same for the tool of his steps, in place of the one before or the service's, whose rule and
/// narrow phase do not count. Throws Refusal, "no_tool". May read a file.
void open_tool(Client& client, const std::shared_ptr<const Mesh>& mesh,
               const std::shared_ptr<const SpatialIndex>& index, MotionConstraintSettings settings,
               const Request& request);

/// Sets the guides of a request for the client's tip or instrument, in place of those that there
/// are. A tip with guides gets a constraint of its own, as `settings` say. Throws Refusal,
/// "no_guide", and keeps the old guides, for a text that is no guide, and "no_instrument".
void set_guides(Client& client, const std::shared_ptr<const Mesh>& mesh,
                const std::shared_ptr<const SpatialIndex>& index,
                const MotionConstraintSettings& settings, const Request& request);

/// Keeps his instrument out of one more mesh, with an index as `settings` say, and returns its
/// number. Throws Refusal, "no_anatomy", and leaves all as it was, and "no_instrument". Reads a
/// file, and builds an index.
std::size_t add_anatomy(Client& client, const MotionConstraintSettings& settings,
                        const Request& request);

/// Says where one of the meshes of his instrument is, and how it moves. Throws Refusal,
/// "no_anatomy", for a number of none or a frame that is none, and "no_instrument".
void place_anatomy(Client& client, const Request& request);

/// Carries out a request. Throws Refusal: "no_instrument" if none was opened, "not_a_request" for
/// another number of joints.
InstrumentStep joint_step(Client& client, const Request& request);

}  // namespace keepout::app
