// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/geometry/shapes.h"

namespace keepout::text {

// The text form of tools and guides: fields of names, numbers and points, separated by colons.

using Fields = std::vector<std::string_view>;

/// Returns the parts of a text between the separators.
Fields split(std::string_view text, char at);

/// Returns 'text'.
std::string in_quotes(std::string_view text);

/// Returns why no form was recognized: the name is unknown, or its number of fields is wrong.
/// `what`: "form", or another noun for the message.
std::string misfit(std::string_view name, std::initializer_list<std::string_view> known,
                   const char* what);

/// Returns a finite number. Throws Error for any other text.
double number(std::string_view field);

/// Returns three numbers, separated by commas. Throws Error for any other text.
Vec3 point(std::string_view field);

}  // namespace keepout::text
