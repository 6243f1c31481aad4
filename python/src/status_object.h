// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include "keepout/step/status.h"

namespace keepout::python {

namespace py = pybind11;

/// The member of keepout.Status.
py::object status_object(Status status);

}  // namespace keepout::python
