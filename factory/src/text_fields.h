// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/geometry/shapes.h"

namespace keepout::text {

// What tools and guides are told in: fields between colons, of names, numbers and points.

using Fields = std::vector<std::string_view>;

/// The parts of a text between the signs; one more than there are signs.
Fields split(std::string_view text, char at);

/// 'text'
std::string in_quotes(std::string_view text);

/// Returns why no form was recognized: the name is not known, or its number of fields is wrong.
/// what: "form" or what else the message calls it.
std::string misfit(std::string_view name, std::initializer_list<std::string_view> known,
                   const char* what);

/// A finite number. Throws Error for anything else.
double number(std::string_view field);

/// Three numbers between commas. Throws Error for anything else.
Vec3 point(std::string_view field);

}  // namespace keepout::text
