// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "keepout/factory/make_motion_constraint.h"
#include "keepout/mesh/load_mesh.h"
#include "serve/request.h"

namespace keepout::app {

inline constexpr std::size_t default_longest_line = std::size_t{1} << 18;

/// One line of input, without its end.
struct Line {
  bool is_too_long = false;  // it was skipped: there is no text
  std::string_view text;
};

/// What a service is made from.
struct ServiceSettings {
  std::filesystem::path mesh;                         // what it was read from, to be told
  AnatomicalSpace space = AnatomicalSpace::unstated;  // that its coordinates are in, to be told
  MotionConstraintSettings constraint;
  RequestLimits limits;
  std::size_t longest_line = default_longest_line;  // [bytes]
};

/// Carries out requests: one mesh, one constraint and one memory for all clients, who are told
/// apart by the side of their tips alone. Not thread-safe.
class Service {
 public:
  /// Throws Error where make_motion_constraint does.
  Service(std::shared_ptr<const Mesh> mesh, const ServiceSettings& settings);

  /// Appends the answer to a line, which is one line; none to a blank one. `tip`: of the client who
  /// asks. Returns how many steps the work was worth.
  std::size_t answer(const Line& line, SideWatch& tip, std::string& out);

  /// For a client who has asked nothing yet.
  SideWatch new_watch() const noexcept { return constraint_.new_watch(); }

  std::size_t longest_line() const noexcept { return longest_line_; }

 private:
  std::size_t carry_out(SideWatch& tip, std::string& out);
  void append_single_step(SideWatch& tip, std::string& out);
  void append_batch(SideWatch& tip, std::string& out);

  MotionConstraint constraint_;
  std::size_t longest_line_;
  Request request_;               // in hand, or done
  TipJacobian::Matrix jacobian_;  // of a request: (3, most joints)
  std::string info_;              // members of an answer
  std::string statuses_;          // members of an answer
};

}  // namespace keepout::app
