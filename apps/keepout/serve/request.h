// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/option_table.h"

namespace keepout::app {

using Json = nlohmann::ordered_json;

inline constexpr std::size_t longest_id = 128;  // of a request [bytes]

/// The limits of a request.
struct RequestLimits {
  std::size_t joints = 7;      // columns of a Jacobian
  std::size_t rows = 64;       // own rows of the caller
  std::size_t motions = 1024;  // in one batch
};

/// A key of requests, and the kind of its value: a number, a string or a truth value, an array of
/// them, or an array of arrays of equal length. Or the value is that of an option, which checks the
/// range.
struct Field {
  struct Count {
    std::size_t least, most;
    bool has(std::size_t count) const noexcept { return count >= least && count <= most; }
  };
  std::string_view name;
  std::string expected;  // the valid values, for messages
  int rank = 0;          // of the value: 0 no array, 1 an array, 2 an array of arrays
  Count columns = {1, 1};
  Count rows = {1, 1};
  bool is_text = false;                // strings, not numbers
  bool is_flag = false;                // true or false
  const OptionText* option = nullptr;  // the option of the value, if any
};

struct Client;

/// A kind of request: a value of "do".
struct Verb {
  std::string_view name;
  std::vector<std::string_view> needed;    // keys besides "id" and "do"
  std::vector<std::string_view> optional;  // further keys
  /// Appends the members of the answer. Throws Refusal and Error.
  void (*carry_out)(Client& client, const Json& request, std::string& out);
  std::string_view refusal = {};  // the kind of Refusal that an Error becomes
  std::size_t work = 1;           // cost, in steps
};

/// Thrown for a line that is not carried out. The client receives it.
struct Refusal {
  std::string_view kind;  // see --help
  std::string message;    // the fault, and how to correct it
};

/// Throws Refusal of the kind "not_a_request".
[[noreturn]] void refuse(std::string message);

/// Reads requests.
class RequestReader {
 public:
  /// `verbs` must outlive this object.
  RequestReader(const RequestLimits& limits, std::span<const Verb> verbs);

  /// Reads a line into `request` and returns its verb. The request then has all keys that the verb
  /// needs and no key that it does not take, and each value is valid for its field. Throws Refusal:
  /// "not_json", or "not_a_request" for JSON with another key, type or size. In every case sets
  /// `id` to the request's id as JSON, which the answer repeats: null if the line has no valid id.
  const Verb& read(std::string_view line, std::string& id, Json& request) const;

  /// Returns the keys of all requests, except "id" and "do".
  std::span<const Field> fields() const noexcept { return fields_; }

 private:
  void check_values(const Json& request) const;
  const Verb& checked_verb(const Json& request) const;

  std::vector<Field> fields_;
  std::span<const Verb> verbs_;
};

/// Returns the value of an option; empty if it is of another kind.
std::optional<OptionValue> option_value(const Json& value, OptionKind kind);

/// Returns the numbers of a value, row by row.
std::vector<double> numbers(const Json& value);

/// Returns the numbers of a key, row by row; empty without this key.
std::vector<double> numbers(const Json& request, std::string_view key);

}  // namespace keepout::app
