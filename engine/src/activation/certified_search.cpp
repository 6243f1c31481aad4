// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "certified_search.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "box_screen.h"
#include "keepout/activation/planes.h"
#include "tolerance_ladder.h"

namespace keepout {
namespace {

constexpr std::uint32_t no_facet = ~std::uint32_t{0};

// Leaves whose screens are kept, a power of 2; a cycle in contact looks at a dozen.
constexpr std::size_t most_memory = 256;
constexpr std::size_t most_waiting = 4096;
constexpr std::size_t most_facets = 4096;

// How often a cycle may look at a leaf: some milliseconds.
constexpr std::size_t most_looks = std::size_t{1} << 17;

}  // namespace

CertifiedSearch::CertifiedSearch(std::shared_ptr<const Mesh> mesh, const WideBvh& tree)
    : mesh_(std::move(mesh)),
      tree_(tree),
      generation_(tree.generation()),
      longest_edge_(mesh_->longest_edge()),
      facets_(most_facets),
      memory_(most_memory),
      waiting_(most_waiting) {}

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
  looks_ = 0;
  if (!(around.margin > needed_margin * tau)) return {Stance::no_margin};
  locate(around);
  is_free_ = frontier_.is_free(around.ball);
  if (is_free_) return {Stance::clear};
  begin(around, CertifiedTerms::keeping(around.margin, tau));

  constexpr double always = 2.0;
  walk(Vec3::Zero(), always, [&](LeafMemory& memory, std::size_t lane) {
    make_facet(memory, lane, corners(memory.leaf, lane));
  });
  if (facets_.overflowed()) return {Stance::over_capacity};
  const Facet* its = nearest();
  if (its == nullptr || its->distance() >= around.margin - lost_below * tau) return {Stance::clear};
  if (its->distance() <= touching_within * tau) return {Stance::touching};
  const double lift = std::min(around.recovery, around.margin - its->distance());
  const Vec3 aim = way_out(around, its->normal(), lift);
  begin(around, CertifiedTerms::leading_off(its->distance(), lift, tau));
  return {Stance::too_close, aim};
}

/// From here on nothing is known of any triangle.
void CertifiedSearch::begin(const Surroundings& around, const CertifiedTerms& terms) noexcept {
  terms_ = terms;
  tip_ = around.tip;
  float_tip_ = float_tip(tip_);
  const double longest =
      around.reach == Reach::sphere ? around.longest : around.aim.norm() * (1.0 + 1e-9);
  reach_ = float_reach(terms.target, longest, tip_, tree_.coordinate_error());
  is_long_ = longest > around.margin;
  facets_.clear();
  if (++cycle_ == 0) {  // the counter went round: forget the leaves of cycles long gone
    for (LeafMemory& leaf : memory_) leaf.cycle = 0;
    cycle_ = 1;
  }
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
  const bool serves_more = farther_ > motion;
  frontier_.gather(tree_,
                   {around.ball.center, around.ball.radius + (serves_more ? farther_ : 0.0)});
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

/// Visits, as visit(its leaf's memory, lane), the triangles that the trial is not sure to keep
/// clear of, the earliest first but for the order among those that it begins at; none that it meets
/// after `latest`, which visits may lower.
template <class Visit>
void CertifiedSearch::walk(const Vec3& trial, const double& latest, Visit&& visit) noexcept {
  const std::array<float, 3> motion{static_cast<float>(trial.x()), static_cast<float>(trial.y()),
                                    static_cast<float>(trial.z())};
  std::array<std::uint32_t, 16 * NodeBlock::lanes> begun;  // boxes that the motion begins in
  std::size_t begun_size = 0;
  waiting_size_ = 0;
  const auto later = [](const Waiting& a, const Waiting& b) { return a.time > b.time; };
  const auto wait = [&](const Waiting& item) {
    if (waiting_size_ == waiting_.size()) return false;
    waiting_[waiting_size_++] = item;
    std::push_heap(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(waiting_size_),
                   later);
    return true;
  };
  const auto enter = [&](const NodeBlock& node, const CylinderBlock& cylinders) {
    BoxEntries entries;
    enter_boxes(node, cylinders, float_tip_, motion.data(), reach_, entries);
    for (std::uint32_t reached = entries.reached; reached != 0; reached &= reached - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(reached));
      const std::uint32_t child = node.child[lane];
      if (child == 0) break;
      const float time = entries.time[lane];
      // What the motion begins in it may meet before it begins: where the tip is too close already.
      if (time > 0.0f) {
        if (static_cast<double>(time) > latest) continue;
        if (wait({time, LeafBlock::lanes, child})) continue;
      }
      begun[begun_size++] = child;
    }
  };
  const auto look_at = [&](std::uint32_t leaf) {
    LeafMemory& memory = memory_of(leaf);
    Suspects suspects;
    suspect(memory.screen, motion.data(), suspects);
    if (is_long_ && suspects.mask != 0) {
      suspect_sharply(tree_.leaves()[leaf], float_tip_, motion.data(), reach_, memory.screen,
                      suspects);
    }
    for (std::uint32_t mask = suspects.mask; mask != 0; mask &= mask - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(mask));
      if (!tree_.leaves()[leaf].is_used(lane)) break;
      const float time = suspects.time[lane];
      if (time > 0.0f) {
        if (static_cast<double>(time) > latest) continue;
        if (wait({time, lane, leaf})) continue;
      }
      visit(memory, lane);
    }
  };
  const auto open = [&](std::uint32_t box) {
    if ((box & NodeBlock::leaf) != 0) {
      look_at(box & ~NodeBlock::leaf);
    } else {
      enter(tree_.nodes()[box], tree_.cylinders()[box]);
    }
  };

  for (std::size_t i = 0; i < frontier_.blocks().size(); ++i) {
    enter(frontier_.blocks()[i], frontier_.cylinders()[i]);
  }
  while (looks_ <= most_looks) {
    if (begun_size > 0) {
      open(begun[--begun_size]);
      continue;
    }
    if (waiting_size_ == 0 || static_cast<double>(waiting_[0].time) > latest) return;
    std::pop_heap(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(waiting_size_),
                  later);
    const Waiting next = waiting_[--waiting_size_];
    if (next.lane == LeafBlock::lanes) {
      open(next.what);
    } else {
      visit(memory_of(next.what), next.lane);
    }
  }
}

Judgement CertifiedSearch::judge(const Surroundings& around, const Vec3& trial,
                                 HalfSpaceBuffer& planes) noexcept {
  using Verdict = Judgement::Verdict;
  if (is_free_) return {Verdict::accepted};

  Contact first{2.0, {Vec3::Zero(), 0.0, no_triangle}};
  std::uint32_t found = no_facet;
  const double length = trial.norm();
  walk(trial, first.time, [&](LeafMemory& memory, std::size_t lane) {
    const Facet* its = known(memory, lane);
    const Triangle its_corners = its != nullptr ? its->corners() : corners(memory.leaf, lane);
    if (terms_.is_covered(its_corners, trial, planes.view())) return;
    const Facet& facet = its != nullptr ? *its : make_facet(memory, lane, its_corners);
    if (facet.distance() - length > terms_.demand(facet)) return;
    const auto is_sooner = [&](const Contact& contact) {
      return contact.time < first.time ||
             (contact.time == first.time && found != no_facet && facet.before(facets_[found]));
    };
    // When it would meet the trial is told sooner than whether it does; most that come this far do.
    const Contact contact = terms_.contact(facet, trial, first.time);
    if (found != no_facet && !is_sooner(contact)) return;
    if (!terms_.is_beyond_doubt(contact, facet, trial)) {
      const bool answered = has_plane(facet.source(), planes.view());
      if (terms_.keeps_clear(facet, trial, answered)) return;
    }
    if (!is_sooner(contact)) return;
    first = contact;
    found = static_cast<std::uint32_t>(&facet - facets_.begin());
  });
  // Beyond the budget of work nothing is known.
  if (looks_ > most_looks || facets_.overflowed()) return {Verdict::blocked, 0.0};
  if (found == no_facet) return {Verdict::accepted};
  const double free_share = std::clamp(first.time, 0.0, 1.0);
  if (has_plane(first.plane.source, planes.view()) || planes.size() >= most_planes) {
    return {Verdict::blocked, free_share};
  }
  planes.push(terms_.answer(facets_[found], around, trial, first.plane));
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

CertifiedSearch::LeafMemory& CertifiedSearch::memory_of(std::uint32_t leaf) noexcept {
  LeafMemory& memory = memory_[leaf % most_memory];
  if (memory.leaf == leaf && memory.cycle == cycle_) return memory;
  ++looks_;
  memory.leaf = leaf;
  memory.cycle = cycle_;
  memory.facet.fill(no_facet);
  look(tree_.leaves()[leaf], float_tip_, reach_, memory.screen);
  return memory;
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

const Facet* CertifiedSearch::known(const LeafMemory& memory, std::size_t lane) const noexcept {
  const std::uint32_t number = memory.facet[lane];
  return number == no_facet ? nullptr : &facets_[number];
}

const Facet& CertifiedSearch::make_facet(LeafMemory& memory, std::size_t lane,
                                         const Triangle& corners) noexcept {
  facets_.push(Facet(corners, tree_.leaves()[memory.leaf].triangle(lane)));
  memory.facet[lane] = static_cast<std::uint32_t>(facets_.size() - 1);
  return facets_[memory.facet[lane]];
}

const Facet& CertifiedSearch::facet(TriangleId source) const noexcept {
  return *std::find_if(facets_.begin(), facets_.end(),
                       [&](const Facet& one) { return one.source() == source; });
}

}  // namespace keepout
