// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace keepout::app {

/// What a line may ask for.
enum class Verb : std::uint8_t {
  step,
  steps,
  polytope,
  info,
  statuses,
  ping,
  instrument,
  joint_step,
  tool,
  guides,
  anatomy,
  place
};

/// The largest request that there is room for.
struct RequestLimits {
  std::size_t joints = 7;      // columns of a Jacobian
  std::size_t rows = 64;       // of the caller's own
  std::size_t motions = 1024;  // of one batch
};

/// How many rows of how many numbers a value may have.
struct TableShape {
  int rank;  // of the value: 0 a number, 1 an array, 2 an array of arrays
  std::size_t fewest_rows, most_rows;
  std::size_t fewest_columns, most_columns;
};

/// The numbers of one value of a request, row by row, in memory that is made once. A number is a
/// table of one row and one column, an array one of one row.
struct NumberTable {
  std::string_view name;
  TableShape shape;
  std::string description;  // what the value must be, for messages
  bool is_given = false;    // there is a value, whole
  std::size_t rows = 0;
  std::size_t columns = 0;
  std::vector<double> numbers = {};
};

/// The text of one value of a request.
struct TextValue {
  std::string_view name;
  bool is_given = false;
  std::string text = {};
};

/// The texts of one value of a request, an array of them.
struct TextList {
  std::string_view name;
  std::size_t most;
  bool is_given = false;
  std::vector<std::string> texts = {};
};

/// One request as it was read.
struct Request {
  explicit Request(const RequestLimits& limits);

  std::string id;  // as JSON, to be echoed; null if there is none, or none that can be read
  Verb verb = Verb::ping;
  TextList guides;  // as guide_of_text reads each
  NumberTable tip;
  NumberTable desired;
  NumberTable jacobian;  // (3, n)
  NumberTable rows;      // A (m, n)
  NumberTable bounds;    // b (m)
  NumberTable radius;
  NumberTable motions;  // (count, 6): tip and desired increment
  TextValue urdf{"urdf"};
  TextValue base_link{"base_link"};
  TextValue tip_link{"tip_link"};
  TextValue tool{"tool"};  // as tool_of_text reads it
  TextValue narrow_phase{"narrow_phase"};
  TextValue of{"of"};      // what guides are of
  TextValue file{"file"};  // of a mesh
  NumberTable scale;       // of the lengths in the URDF
  NumberTable frame;       // (4, 4): of link 0, in that of the mesh
  NumberTable capsules;    // (count, 9): link and point, link and point, radius
  NumberTable margin;
  NumberTable band;
  NumberTable period;
  NumberTable recovery;
  NumberTable orientation_weight;
  NumberTable slowing_within;
  NumberTable slowing_time;
  NumberTable q;
  NumberTable linear;
  NumberTable angular;
  NumberTable increment;
  NumberTable weights;
  NumberTable mesh;  // its number

  std::array<NumberTable*, 23> tables() noexcept {
    return {&tip,    &desired,        &jacobian,    &rows,      &bounds,
            &radius, &motions,        &scale,       &frame,     &capsules,
            &margin, &band,           &period,      &recovery,  &orientation_weight,
            &q,      &linear,         &angular,     &increment, &weights,
            &mesh,   &slowing_within, &slowing_time};
  }
  std::array<TextValue*, 7> texts() noexcept {
    return {&urdf, &base_link, &tip_link, &tool, &narrow_phase, &of, &file};
  }
};

/// Thrown for a line that is not carried out: what the client is told.
struct Refusal {
  std::string_view kind;  // see --help
  std::string message;    // what is wrong and what to do
};

/// Reads a line into memory that is made once. Throws Refusal: "not_json", or "not_a_request" for
/// JSON with another key, type, size or value than a request has. Whatever the outcome, request.id
/// is what is to be echoed.
void read_request(std::string_view line, Request& request);

}  // namespace keepout::app
