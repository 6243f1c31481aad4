// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "keepout/step/side_watch.h"
#include "serve/service.h"

namespace keepout::app {

/// A tip or an instrument, and the names of its guides.
template <class Constraint>
struct Guarded {
  std::optional<Constraint> constraint = std::nullopt;
  std::vector<std::string> guide_names = {};

  /// Throws Error, and keeps the guides that there are, like Constraint::set_guides.
  void set_guides(std::vector<Guide> guides);
};

/// What is kept of one client from line to line. Knows no file or socket.
struct Client {
  Service& service;
  SideWatch side = {};                            // of the tip, where the last step led it
  Guarded<MotionConstraint> tip = {};             // its own once it has a tool or guides
  Guarded<InstrumentConstraint> instrument = {};  // once it is opened
  bool is_skipping = false;  // the beginning of this line is gone: it was too long
};

/// Returns all that a client may ask for.
std::span<const Verb> verbs();

}  // namespace keepout::app
