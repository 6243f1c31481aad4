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

/// The largest request that is read.
struct RequestLimits {
  std::size_t joints = 7;      // columns of a Jacobian
  std::size_t rows = 64;       // of the caller's own
  std::size_t motions = 1024;  // of one batch
};

/// A key of requests, and its value: a number, a string or a truth value, an array of them, or an
/// array of arrays of one length; or what an option takes, whose range is checked where the option
/// is set.
struct Field {
  struct Count {
    std::size_t least, most;
    bool has(std::size_t count) const noexcept { return count >= least && count <= most; }
  };
  std::string_view name;
  std::string expected;  // what the value must be, for messages
  int rank = 0;          // of the value: 0 no array, 1 an array, 2 an array of arrays
  Count columns = {1, 1};
  Count rows = {1, 1};
  bool is_text = false;                // strings, not numbers
  bool is_flag = false;                // true or false
  const OptionText* option = nullptr;  // that the value is of
};

struct Client;

/// A kind of request: a value of "do".
struct Verb {
  std::string_view name;
  std::vector<std::string_view> needed;    // keys beside "id" and "do"
  std::vector<std::string_view> optional;  // keys
  /// Appends the members of the answer. Throws Refusal and Error.
  void (*carry_out)(Client& client, const Json& request, std::string& out);
  std::string_view refusal = {};  // the kind of Refusal that an Error becomes
  std::size_t work = 1;           // as much as so many steps
};

/// Thrown for a line that is not carried out, and sent to the client.
struct Refusal {
  std::string_view kind;  // see --help
  std::string message;    // what is wrong and what to do
};

/// Throws Refusal: "not_a_request".
[[noreturn]] void refuse(std::string message);

/// Reads requests.
class RequestReader {
 public:
  /// `verbs` must outlive it.
  RequestReader(const RequestLimits& limits, std::span<const Verb> verbs);

  /// Reads a line into `request` and returns its verb. The request has all keys that the verb needs
  /// and no key that it does not take, and each value is valid for its field. Throws Refusal:
  /// "not_json", or "not_a_request" for JSON with another key, type or size. Sets `id` in every
  /// case to the request's id as JSON, which the answer repeats: null if the line has no valid id.
  const Verb& read(std::string_view line, std::string& id, Json& request) const;

  /// Returns the keys of all requests, but for "id" and "do".
  std::span<const Field> fields() const noexcept { return fields_; }

 private:
  void check_values(const Json& request) const;
  const Verb& checked_verb(const Json& request) const;

  std::vector<Field> fields_;
  std::span<const Verb> verbs_;
};

/// Returns the value of an option; nothing if it is of another kind.
std::optional<OptionValue> option_value(const Json& value, OptionKind kind);

/// Returns the numbers of a value, row by row.
std::vector<double> numbers(const Json& value);

/// Returns the numbers of a key, row by row; empty without that key.
std::vector<double> numbers(const Json& request, std::string_view key);

}  // namespace keepout::app
