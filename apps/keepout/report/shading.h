// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "report/image.h"
#include "report/raster.h"

namespace keepout::app {

/// The picture of the samples as lit bone: a warm key light from the upper left, a cool fill light,
/// hollows darkened by how much of the sky their surroundings hide. Where nothing is shown the
/// picture is transparent, so that it suits a light page as well as a dark one.
Image shade(const Samples& samples);

}  // namespace keepout::app
