// SPDX-License-Identifier: BSD-3-Clause
#include "text_fields.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>

#include "keepout/error.h"

namespace keepout::text {

Fields split(std::string_view text, char at) {
  Fields fields;
  for (std::size_t end = text.find(at); end != std::string_view::npos; end = text.find(at)) {
    fields.push_back(text.substr(0, end));
    text.remove_prefix(end + 1);
  }
  fields.push_back(text);
  return fields;
}

std::string in_quotes(std::string_view text) { return "'" + std::string(text) + "'"; }

std::string misfit(std::string_view name, std::initializer_list<std::string_view> known,
                   const char* what) {
  if (std::ranges::find(known, name) == known.end()) return std::string("there is no such ") + what;
  return in_quotes(name) + " has too few or too many fields";
}

double number(std::string_view field) {
  double value = 0.0;
  const char* const last = field.data() + field.size();
  const auto [end, error] = std::from_chars(field.data(), last, value);
  if (error == std::errc{} && end == last && std::isfinite(value)) return value;
  throw Error(in_quotes(field) + " is not a number");
}

Vec3 point(std::string_view field) {
  const Fields numbers = split(field, ',');
  if (numbers.size() != 3) throw Error(in_quotes(field) + " is not a point, three numbers");
  return {number(numbers[0]), number(numbers[1]), number(numbers[2])};
}

}  // namespace keepout::text
