// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "audit.h"

namespace keepout::app {

/// Follows a tip and tells when it passes through the surface. It remembers on which side the tip
/// was last seen clear of it: a guarded tool that gets through does so by touching first, and while
/// it touches it is on neither side.
///
/// Around the rim of an open surface a tip may walk freely; one that slides around it in contact is
/// counted as having passed through.
class PathAudit {
 public:
  /// `audit` must outlive this object.
  PathAudit(Audit& audit, const Vec3& start);

  /// Moves straight on to `to`; true if on the way, or at its end, the tip came to be on the other
  /// side of the surface.
  bool follow(const Vec3& to);

 private:
  bool changes_side(Side now);

  Audit* audit_;
  Vec3 at_;
  Side here_;         // at_ is on
  Side side_;         // where the tip was last clear of the surface; touching: nowhere yet
  bool met_ = false;  // the surface, since then
};

}  // namespace keepout::app
