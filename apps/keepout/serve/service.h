// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/factory/make_instrument_constraint.h"
#include "keepout/factory/make_motion_constraint.h"
#include "keepout/mesh/load_mesh.h"
#include "keepout/step/side_watch.h"
#include "serve/request.h"

namespace keepout::app {

inline constexpr std::size_t most_work = 16;  // of a turn, in steps

/// The mesh, options and limits of a service.
struct ServiceSettings {
  std::filesystem::path mesh;                         // what it was read from, for "info"
  AnatomicalSpace space = AnatomicalSpace::unstated;  // that its coordinates are in, for "info"
  std::vector<std::string> notices = {};              // on how it was read, for "info"
  MotionConstraintSettings constraint{.options = {.distances = Distances::always}};
  RequestLimits limits;
  std::size_t longest_line = std::size_t{1} << 18;  // [bytes]
};

/// The mesh, the index and the constraint of tips that all clients share. Not thread-safe.
struct Service {
  /// Throws Error where make_motion_constraint does.
  Service(std::shared_ptr<const Mesh> served, const ServiceSettings& settings);

  std::shared_ptr<const Mesh> mesh;
  std::shared_ptr<const SpatialIndex> index;
  InstrumentConstraintSettings instrument;  // of a client's, unless the client says otherwise
  MotionConstraintSettings tip;             // with room for the largest request
  MotionConstraint constraint;              // of the tips of clients without one of their own
  std::size_t longest_line;                 // [bytes]
  RequestReader requests;
  std::string info;      // members of an answer
  std::string statuses;  // members of an answer
};

/// A tip or an instrument, and the names of its guides.
template <class Constraint>
struct Guarded {
  std::optional<Constraint> constraint = std::nullopt;
  std::vector<std::string> guide_names = {};

  /// Throws Error, and keeps the guides that there are, like Constraint::set_guides.
  void set_guides(std::vector<Guide> guides);
};

/// The state of one client between lines. Independent of files and sockets.
struct Client {
  Service& service;
  SideWatch side = {};                            // of the tip, where the last step led it
  Guarded<MotionConstraint> tip = {};             // its own once it has a tool or guides
  std::string tool = {};                          // the text of its convex tool, if it has one
  Guarded<InstrumentConstraint> instrument = {};  // once it is opened
  bool is_skipping = false;  // the beginning of this line is gone: it was too long
};

/// Returns the verbs of all requests.
std::span<const Verb> verbs();

/// Returns the largest number of bytes of an unfinished line.
std::size_t most_received(const Service& service) noexcept;

/// Answers the complete lines of `received`, except blank ones, until the work of one turn is done,
/// so that other clients are served too. Lines end with "\n" or "\r\n". A line that is too long is
/// skipped to its end and answered once. Appends to `answers` and returns the number of bytes used.
/// `received`: at most most_received().
std::size_t take_turn(Client& client, std::string_view received, std::string& answers);

}  // namespace keepout::app
