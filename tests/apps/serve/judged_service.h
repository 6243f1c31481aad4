// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <random>
#include <string>
#include <string_view>

#include "keepout/factory/make_motion_constraint.h"
#include "serve/service.h"

namespace keepout::test {

/// A service, and one who knows what it must answer: by another JSON parser, and by a motion
/// constraint of his own.
class JudgedService {
 public:
  explicit JudgedService(std::size_t longest_line);

  /// Sends bytes as one client, in pieces of random sizes, and judges all that is answered: one
  /// line for each that is not blank, in order, with its id; motions and planes for requests alone,
  /// and those of the constraint. Returns what is wrong; empty if nothing is.
  std::string converse(std::string_view bytes, std::mt19937_64& random);

  std::size_t lines() const noexcept { return lines_; }              // that were answered
  std::size_t refusals() const noexcept { return refusals_; }        // among them
  std::size_t joint_steps() const noexcept { return joint_steps_; }  // that were carried out

 private:
  std::string judge(std::string_view line, std::string_view answer, SideWatch& tip);

  app::ServiceSettings settings_;
  app::Service service_;
  app::Request schema_{settings_.limits};
  MotionConstraint reference_;
  std::size_t lines_ = 0;
  std::size_t refusals_ = 0;
  std::size_t joint_steps_ = 0;
};

}  // namespace keepout::test
