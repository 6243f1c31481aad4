// SPDX-License-Identifier: BSD-3-Clause
// Compiled once with each of these names defined. Each must fail, with a message on what to do.
#include "keepout/step/motion.h"

Eigen::Matrix<double, 3, 7> new_jacobian();

keepout::Motion motion(const Eigen::Matrix<double, 6, 7>& of_a_frame,
                       const Eigen::Matrix3d& rotation) {
  const Eigen::Matrix<double, 3, 7> jacobian = rotation * of_a_frame.topRows<3>();
  keepout::Motion asked{.tip = {0, 0, 0}, .desired = {0, 0, 0}, .jacobian = jacobian};
#if defined(SIX_ROWS)
  asked.jacobian = of_a_frame;
#elif defined(FLOATS)
  const Eigen::Matrix<float, 3, 7> in_floats = jacobian.cast<float>();
  asked.jacobian = in_floats;
#elif defined(A_PRODUCT)
  asked.jacobian = rotation * of_a_frame.topRows<3>();
#elif defined(NO_NAME)
  asked.jacobian = new_jacobian();
#else
#error none of the names is defined
#endif
  return asked;
}
