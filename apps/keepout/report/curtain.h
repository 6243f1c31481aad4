// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "report/camera.h"
#include "report/image.h"

namespace keepout::app {

/// The cut of a camera as a depth over its picture: nearer to the viewer than that, nothing shows.
class Curtain {
 public:
  /// `size` is that of the grid of samples. Without a cut nothing is taken away.
  Curtain(const Camera& camera, ImageSize size);

  /// Towards the viewer, at the middle of a sample, rows from the top. [sample]
  float depth(int x, int y) const noexcept {
    return at_middle_[static_cast<std::size_t>(x)] +
           slope_ * (middle_ - static_cast<float>(y) - 0.5F);
  }

 private:
  void hang(const Camera& camera, ImageSize size);
  void close_gaps();
  void smooth();

  std::vector<float> at_middle_;  // depth in the middle row, column by column
  float middle_ = 0.0F;           // [sample]
  float slope_ = 0.0F;            // of the depth, upwards
};

}  // namespace keepout::app
