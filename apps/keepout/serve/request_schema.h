// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "serve/request.h"

namespace keepout::app {

/// Returns the JSON Schema (draft 2020-12) of requests within these limits, from the tables that
/// read them. A request that is carried out is valid. The schema cannot express that sizes in a
/// request agree, such as the number of rows and of bounds.
std::string request_schema(const RequestLimits& limits);

}  // namespace keepout::app
