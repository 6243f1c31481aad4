// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause

#include "path_audit.h"

#include <utility>
#include <vector>

namespace keepout::app {

PathAudit::PathAudit(Audit& audit, const Vec3& start)
    : audit_(&audit), at_(start), here_(audit.side(start)), side_(here_) {}

bool PathAudit::follow(const Vec3& to) {
  const Vec3 from = std::exchange(at_, to);
  const Side start = std::exchange(here_, audit_->side(to));
  // Parts of the way between two meetings lie on one side each: their middles tell which.
  std::vector<double> meetings = audit_->meetings(from, to);
  if (start == Side::touching) meetings.insert(meetings.begin(), 0.0);
  if (here_ == Side::touching) meetings.push_back(1.0);
  met_ = met_ || !meetings.empty();

  bool crossed = false;
  for (std::size_t i = 1; i < meetings.size(); ++i) {
    const double middle = 0.5 * (meetings[i - 1] + meetings[i]);
    crossed |= changes_side(audit_->side(from + middle * (to - from)));
  }
  crossed |= changes_side(here_);
  if (here_ != Side::touching) met_ = false;
  return crossed;
}

bool PathAudit::changes_side(Side now) {
  if (now == Side::touching) return false;
  const Side before = std::exchange(side_, now);
  if (before == now || before == Side::touching) return false;
  // Whoever leaves a closed surface went through it; an open one can be walked around.
  return audit_->surface() == SurfaceKind::closed || met_;
}

}  // namespace keepout::app
