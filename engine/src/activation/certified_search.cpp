// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "certified_search.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "keepout/activation/planes.h"
#include "tolerance_ladder.h"

namespace keepout {
namespace {

constexpr std::uint32_t no_facet = TrialWalk::no_note;
constexpr std::size_t most_facets = 4096;

}  // namespace

CertifiedSearch::CertifiedSearch(std::shared_ptr<const Mesh> mesh, const WideBvh& tree)
    : mesh_(std::move(mesh)),
      tree_(tree),
      generation_(tree.generation()),
      longest_edge_(mesh_->longest_edge()),
      walk_(tree),
      facets_(most_facets) {}

std::size_t CertifiedSearch::triangles(const Surroundings&) const noexcept {
  return facets_.size();
}

Ball CertifiedSearch::region(const Surroundings& around) const noexcept {
  return certified_region(around, certified_tolerance(around, longest_edge_));
}

Opening CertifiedSearch::start(const Surroundings& around, HalfSpaceBuffer&) noexcept {
  using Stance = Opening::Stance;
  if (tree_.generation() != generation_) return {Stance::over_capacity};
  const double tau = certified_tolerance(around, longest_edge_);
  facets_.clear();
  aim_is_free_ = false;
  at_aim_.reset();
  walk_.restart_counting();
  if (!(around.margin > needed_margin * tau)) return {Stance::no_margin};
  locate(around);
  is_free_ = frontier_.is_free(around.ball);
  if (is_free_) return {Stance::clear};
  begin(around, CertifiedTerms::keeping(around.margin, tau));

  // What is in reach of the tip itself, which comes first; and by the way, what speaks against the
  // motion asked for, should the tip keep the margin: it is the first trial.
  const double least = around.margin - lost_below * tau;
  aim_is_free_ = meet(around.aim, {}, least, at_aim_.emplace());
  if (is_over_budget()) return {Stance::over_capacity};
  const Facet* its = nearest();
  const std::optional<double> distance = known_distance(its, around.margin, tau);
  if (its == nullptr || its->distance() >= least) {
    return {.stance = Stance::clear, .distance = distance};
  }
  aim_is_free_ = false;
  at_aim_.reset();
  if (its->distance() <= touching_within * tau) {
    return {.stance = Stance::touching, .distance = distance};
  }
  const double lift = std::min(around.recovery, around.margin - its->distance());
  const Vec3 aim = way_out(around, its->normal(), lift);
  begin(around, CertifiedTerms::leading_off(its->distance(), lift, tau));
  return {Stance::too_close, aim, distance};
}

/// From here on nothing is known of any triangle.
void CertifiedSearch::begin(const Surroundings& around, const CertifiedTerms& terms) noexcept {
  terms_ = terms;
  tip_ = around.tip;
  const double longest =
      around.reach == Reach::sphere ? around.longest : around.aim.norm() * (1.0 + 1e-9);
  walk_.begin(tip_, terms.target, longest);
  facets_.clear();
}

/// Of the facets that were asked about; of equals the first by their corners.
const Facet* CertifiedSearch::nearest() const noexcept {
  const auto nearer = [](const Facet& a, const Facet& b) {
    return a.distance() < b.distance() || (a.distance() == b.distance() && a.before(b));
  };
  const Facet* its = std::min_element(facets_.begin(), facets_.end(), nearer);
  return its == facets_.end() ? nullptr : its;
}

/// Sees to it that the frontier covers all that the cycle may ask about. It reaches farther than it
/// must, for the cycles to come, as long as that leaves few boxes and cycles are short.
void CertifiedSearch::locate(const Surroundings& around) noexcept {
  if (frontier_.covers(around.ball)) return;
  const double motion = around.aim.norm();
  // A planner's states have nothing to do with each other: more would serve none of them.
  const bool serves_more = farther_ > motion && frontier_.is_near(around.ball);
  const auto gather = [&](double farther) {
    frontier_.gather(tree_, {around.ball.center, around.ball.radius + farther});
  };
  gather(serves_more ? farther_ : 0.0);
  if (serves_more && !frontier_.is_opened()) {
    // So far that large boxes are left over, which every cycle to come would have to look into.
    farther_ *= 0.25;
    gather(farther_ > motion ? farther_ : 0.0);
    return;
  }
  if (farther_ > motion && !serves_more) return;  // it tells nothing of reaching that far
  constexpr std::size_t few = 12;
  constexpr std::size_t many = 24;
  if (frontier_.size() == 0) {
    farther_ = 2.0 * farther_ + motion;
  } else if (frontier_.size() < few) {
    farther_ = 1.5 * farther_ + 0.1 * motion;
  } else if (frontier_.size() > many) {
    farther_ *= 0.7;
  }
}

/// Beyond the budget of work nothing is known.
bool CertifiedSearch::is_over_budget() const noexcept {
  return walk_.looks() > TrialWalk::most_looks || facets_.overflowed();
}

bool CertifiedSearch::meet(const Vec3& trial, std::span<const HalfSpace> planes, double too_close,
                           Meeting& meeting) noexcept {
  constexpr double at_once = 0.0;
  const double length = trial.norm();
  Contact& first = meeting.contact;
  const auto visit = [&](TrialWalk::Leaf& leaf, std::size_t lane) {
    const Facet* its = known(leaf, lane);
    const Triangle its_corners = its != nullptr ? its->corners() : corners(leaf.number, lane);
    if (terms_.is_covered(its_corners, trial, planes)) return;
    const Facet& facet = its != nullptr ? *its : make_facet(leaf, lane, its_corners);
    if (facet.distance() - length > terms_.demand(facet)) return;
    if (facet.distance() < too_close) {
      first.time = at_once;
      return;
    }
    const bool is_first = meeting.facet == no_facet;
    const auto is_sooner = [&](const Contact& contact) {
      return contact.time < first.time ||
             (contact.time == first.time && !is_first && facet.before(facets_[meeting.facet]));
    };
    // When it would meet the trial is told sooner than whether it does; most that come this far do.
    const Contact contact = terms_.contact(facet, trial, first.time);
    if (!is_first && !is_sooner(contact)) return;
    if (!terms_.is_beyond_doubt(contact, facet, trial)) {
      const bool answered = has_plane(facet.source(), planes);
      if (terms_.keeps_clear(facet, trial, answered)) return;
    }
    if (!is_sooner(contact)) return;
    first = contact;
    meeting.facet = static_cast<std::uint32_t>(&facet - facets_.begin());
  };
  return walk_.run(frontier_, trial, first.time, visit);
}

Judgement CertifiedSearch::judge(const Surroundings& around, const Vec3& trial,
                                 HalfSpaceBuffer& planes) noexcept {
  using Verdict = Judgement::Verdict;
  if (is_free_) return {Verdict::accepted};
  const auto is_aim = [&] {
    return (trial - around.aim).norm() <= TrialWalk::alike * around.aim.norm();
  };
  if (aim_is_free_ && is_aim()) return {Verdict::accepted};

  Meeting meeting;
  if (at_aim_ && planes.empty() && trial == around.aim) {
    meeting = *at_aim_;
  } else {
    meet(trial, planes.view(), 0.0, meeting);
  }
  if (is_over_budget()) return {Verdict::blocked, 0.0};
  if (meeting.facet == no_facet) return {Verdict::accepted};
  const HalfSpace& plane = meeting.contact.plane;
  const double free_share = std::clamp(meeting.contact.time, 0.0, 1.0);
  if (has_plane(plane.source, planes.view()) || planes.size() >= most_planes) {
    return {Verdict::blocked, free_share};
  }
  planes.push(terms_.answer(facets_[meeting.facet], around, trial, plane));
  return {Verdict::objected, free_share};
}

bool CertifiedSearch::relax(HalfSpaceBuffer& planes) const noexcept {
  return let_stand_still(planes);
}

bool CertifiedSearch::turn(const Surroundings& around, std::span<const HalfSpace> planes,
                           HalfSpaceBuffer& turned) noexcept {
  return terms_.turn_all(
      around, planes, [&](TriangleId source) -> const Facet& { return facet(source); }, turned);
}

void CertifiedSearch::ways_around(const Surroundings&, TriangleId source,
                                  HalfSpaceBuffer& ways) const noexcept {
  if (source != no_triangle) terms_.ways_around(facet(source), ways);
}

/// Relative to the tip, in lexicographic order, as a Facet has them.
Triangle CertifiedSearch::corners(std::uint32_t leaf, std::size_t lane) const noexcept {
  const LeafBlock& block = tree_.leaves()[leaf];
  Triangle corners;
  if (tree_.coordinate_error() == 0.0) {
    for (std::size_t c = 0; c < 3; ++c) {
      corners[c] =
          Vec3(block.corner[c][0][lane], block.corner[c][1][lane], block.corner[c][2][lane]) - tip_;
    }
    return corners;
  }
  return ordered_relative(mesh_->triangle(block.triangle(lane)), tip_);
}

const Facet* CertifiedSearch::known(const TrialWalk::Leaf& leaf, std::size_t lane) const noexcept {
  const std::uint32_t number = leaf.note[lane];
  return number == no_facet ? nullptr : &facets_[number];
}

const Facet& CertifiedSearch::make_facet(TrialWalk::Leaf& leaf, std::size_t lane,
                                         const Triangle& corners) noexcept {
  facets_.push(Facet(corners, tree_.leaves()[leaf.number].triangle(lane)));
  leaf.note[lane] = static_cast<std::uint32_t>(facets_.size() - 1);
  return facets_[leaf.note[lane]];
}

const Facet& CertifiedSearch::facet(TriangleId source) const noexcept {
  return *std::find_if(facets_.begin(), facets_.end(),
                       [&](const Facet& one) { return one.source() == source; });
}

}  // namespace keepout
