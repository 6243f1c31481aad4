// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "keepout/robot/instrument_constraint.h"
#include "keepout/step/motion_constraint.h"

namespace keepout::app {

// Answers, appended to what is to be sent, in memory that it keeps: one line of JSON each.

/// The shortest digits that read back as the same double; "-0.0" for a negative zero, so that no
/// reader takes it for an integer; null for what is not finite.
void append_number(std::string& text, double value);

/// A string in quotes. `value`: UTF-8.
void append_string(std::string& text, std::string_view value);

/// Begins the answer to a request: {"id":7 and no more. `id`: JSON.
void begin_answer(std::string& out, std::string_view id);

void end_answer(std::string& out);

/// What became of a step, as members of an object. `joints`: of its Jacobian; 0 without one.
void append_step(std::string& out, const Step& step, std::size_t joints);

void append_polytope(std::string& out, const Polytope& polytope);

/// What an instrument is made of.
void append_instrument(std::string& out, const Instrument& instrument);

/// What became of the step of an instrument of so many joints.
void append_joint_step(std::string& out, const InstrumentStep& step, std::size_t joints);

/// Appends the state of each guide of a step, by name, and what was relaxed; nothing without
/// guides.
void append_guides(std::string& out, std::span<const std::string> names,
                   std::span<const GuideState> states, Relaxation relaxation);

/// The whole answer to a line that was not carried out.
void append_error(std::string& out, std::string_view id, std::string_view kind,
                  std::string_view message);

}  // namespace keepout::app
