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

inline constexpr std::size_t most_work = 16;  // of one turn, in steps

/// The mesh, options and limits of a service.
struct ServiceSettings {
  std::filesystem::path mesh;                         // its file, for "info"
  AnatomicalSpace space = AnatomicalSpace::unstated;  // of its coordinates, for "info"
  std::vector<std::string> notices = {};              // of its reading, for "info"
  MotionConstraintSettings constraint{.options = {.distances = Distances::always}};
  RequestLimits limits;
  std::size_t longest_line = std::size_t{1} << 18;  // [bytes]
};

/// The mesh, the index and the constraint of tips that all clients share. Not thread-safe.
struct Service {
  /// Throws Error as make_motion_constraint does.
  Service(std::shared_ptr<const Mesh> served, const ServiceSettings& settings);

  std::shared_ptr<const Mesh> mesh;
  std::shared_ptr<const SpatialIndex> index;
  InstrumentConstraintSettings instrument;  // defaults for a client's instrument
  MotionConstraintSettings tip;             // with capacity for the largest request
  MotionConstraint constraint;              // for clients without a constraint of their own
  std::size_t longest_line;                 // [bytes]
  RequestReader requests;
  std::string info;      // members of the answer
  std::string statuses;  // members of the answer
};

/// A tip or an instrument, and the names of its guides.
template <class Constraint>
struct Guarded {
  std::optional<Constraint> constraint = std::nullopt;
  std::vector<std::string> guide_names = {};

  /// Sets the guides. Throws Error as Constraint::set_guides does; then it keeps the earlier
  /// guides.
  void set_guides(std::vector<Guide> guides);
};

/// The state of one client between lines. Independent of files and sockets.
struct Client {
  Service& service;
  SideWatch side = {};                            // the side of the tip after the last step
  Guarded<MotionConstraint> tip = {};             // set once the client has a tool or guides
  std::string tool = {};                          // the text of its convex tool; empty: a ball
  Guarded<InstrumentConstraint> instrument = {};  // set once it is opened
  bool is_skipping = false;  // the line was too long, and its beginning is discarded
};

/// Returns the verbs of all requests.
std::span<const Verb> verbs();

/// Returns the largest number of bytes of an unfinished line.
std::size_t most_received(const Service& service) noexcept;

/// Answers the complete lines of `received`, except blank ones, until the work of one turn is done,
/// so that other clients are served too. Lines end with "\n" or "\r\n". Skips a line that is too
/// long, and answers it once. Appends to `answers` and returns the number of bytes used.
/// `received`: at most most_received().
std::size_t take_turn(Client& client, std::string_view received, std::string& answers);

}  // namespace keepout::app
