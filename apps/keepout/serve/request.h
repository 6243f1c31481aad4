// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/option_table.h"

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

/// An option of an instrument in a request.
struct OptionOfRequest {
  std::string_view name;
  const OptionText* option;
  bool is_given = false;
  OptionValue value = {};  // of the option's kind; its range is checked where it is used
};

/// What a request to do something has besides "id" and "do"; unused places are empty.
struct VerbKeys {
  std::string_view name;
  Verb verb;
  std::array<std::string_view, 2> needed;
  std::array<std::string_view, 4> optional;
  bool takes_options = false;  // all instrument_options too

  bool needs(std::string_view key) const noexcept;
  bool takes(std::string_view key) const noexcept;  // needed or optional
};

/// Returns the keys of each verb.
std::span<const VerbKeys> verb_keys() noexcept;

/// One request as it was read.
struct Request {
  explicit Request(const RequestLimits& limits);

  std::string id;  // as JSON, to be echoed; null if there is none, or none that can be read
  Verb verb = Verb::ping;
  TextList guides;                       // as guide_of_text reads each
  std::vector<NumberTable> tables;       // see table()
  std::vector<TextValue> texts;          // see text()
  std::vector<OptionOfRequest> options;  // of an instrument, in the order of instrument_options

  /// Returns the value of a key. Precondition: the constructor knows the key.
  const NumberTable& table(std::string_view key) const noexcept;
  /// See table().
  const TextValue& text(std::string_view key) const noexcept;
  /// See table().
  const OptionOfRequest& option(std::string_view key) const noexcept;
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
