// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/activation/certified.h"

#include <algorithm>

#include "certified_terms.h"
#include "keepout/activation/planes.h"
#include "keepout/activation/tolerances.h"
#include "keepout/index/query.h"

namespace keepout {

/// Finds the first contact of a triangle that objects to a trial, among those that the traversal
/// shows: rule 5 of docs/certified-step.md. Adds the triangles that it examines to the prepared
/// triangles of the rule.
class CertifiedRule::ContactSearch final : public TriangleVisitor {
 public:
  /// Writes all of `passage` except nothing_near. A triangle nearer to the tip than `too_close`
  /// ends the search for contacts: visit() then returns 0. From then on the traversal shows only
  /// triangles that may be within the level at the start of the motion. So the prepared triangles
  /// include all triangles nearer than `too_close`.
  ContactSearch(CertifiedRule& rule, const Vec3& trial, std::span<const HalfSpace> planes,
                double too_close, Passage& passage) noexcept
      : terms_(*rule.terms_),
        prepared_(rule.prepared_),
        budget_(rule.budget()),
        trial_(trial),
        length_(trial.norm()),
        planes_(planes),
        too_close_(too_close),
        passage_(passage) {}

  /// `note`: the triangle's index in the prepared triangles of the rule.
  double visit(TriangleId triangle, std::uint32_t& note,
               const Triangle* corners) noexcept override {
    examine(triangle, note, corners);
    return latest();
  }

 private:
  /// Returns the time after which contacts do not matter.
  double latest() const noexcept { return passage_.is_too_close ? 0.0 : passage_.contact.time; }

  void examine(TriangleId triangle, std::uint32_t& note, const Triangle* corners) noexcept {
    budget_.spend((1 + planes_.size() / 16) * work::coverage);
    const bool is_known = note != MotionTraversal::no_note;
    if (is_known) corners = &prepared_[note].corners();
    if (terms_.is_covered(*corners, trial_, planes_)) return;
    if (!is_known) {
      if (prepared_.size() == prepared_.capacity()) {
        budget_.mark_overflow();
        budget_.spend_all();
        return;
      }
      budget_.spend(work::triangle);
      prepared_.push(PreparedTriangle(*corners, triangle));
      note = static_cast<std::uint32_t>(prepared_.size() - 1);
    }
    const PreparedTriangle& prepared = prepared_[note];
    // Rule 5 (b): too far for a motion of this length.
    if (prepared.distance() - length_ > terms_.demand(prepared)) return;
    if (prepared.distance() < too_close_) {
      passage_.is_too_close = true;
      return;
    }
    if (terms_.is_clear_at_once(prepared, trial_)) return;
    budget_.spend(work::contact);
    // The time of contact is cheaper to find than a proof of clearance, and most triangles that
    // come this far are hit. The time is a lower bound (Lemma 6), so a contact that is later than
    // an earlier one does not matter. Without an earlier contact, latest() is beyond the end of the
    // trial. A time after the end is a proof by rule 5 (d), but still goes to stays_clear(). If
    // that finds no proof, the triangle objects to the end of the trial, with free_fraction 1. That
    // costs motion, not safety.
    const Contact contact = terms_.contact(prepared, trial_, latest());
    if (!is_sooner(contact, prepared)) return;
    if (!terms_.is_surely_too_close(contact, prepared, trial_)) {
      const bool has_own_plane = has_plane(prepared.triangle(), planes_);
      if (terms_.stays_clear(prepared, trial_, has_own_plane)) return;
    }
    passage_.contact = contact;
    passage_.prepared = note;
  }

  /// Returns true if the contact is before the first one so far. If both are equally early, the
  /// order of the corners decides.
  bool is_sooner(const Contact& contact, const PreparedTriangle& prepared) const noexcept {
    const Contact& first = passage_.contact;
    return contact.time < first.time || (contact.time == first.time && passage_.has_contact() &&
                                         prepared.before(prepared_[passage_.prepared]));
  }

  const CertifiedTerms& terms_;
  Buffer<PreparedTriangle>& prepared_;
  Budget& budget_;
  const Vec3& trial_;
  double length_;
  std::span<const HalfSpace> planes_;
  double too_close_;
  Passage& passage_;
};

namespace {

// Cosines of angles between normals: of walls in about the same direction, and of almost parallel
// planes, which rounding may make contradictory for a solver.
constexpr double same_direction = 0.8;
constexpr double almost_parallel = 0.99;

}  // namespace

CertifiedRule::CertifiedRule() : terms_(std::make_unique<CertifiedTerms>()), prepared_(0) {}

CertifiedRule::~CertifiedRule() = default;

void CertifiedRule::prepare(Neighborhood& neighborhood) {
  ActivationRule::prepare(neighborhood);
  traversal_ = make_motion_traversal(neighborhood);
  // The walls are in prepared_ twice if the traversal shows them again.
  prepared_ = Buffer<PreparedTriangle>(traversal_->room() + most_walls);
}

double CertifiedRule::tolerance(const RuleInput& input) const noexcept {
  return 2e-10 * (mesh().longest_edge() + input.radius + input.clearance) +
         4e-16 * input.tip.lpNorm<1>();
}

Ball CertifiedRule::region(const RuleInput& input) const noexcept {
  Ball ball = searched_ends(input);
  ball.radius += input.clearance + region_beyond * tolerance(input);
  return ball;
}

bool CertifiedRule::makes_queries() const noexcept { return !index().traverses(); }

/// Sets the levels, and begins the traversal, which shows triangles trial by trial. It has shown no
/// triangle yet.
bool CertifiedRule::gather(const RuleInput& input) noexcept {
  prepared_.clear();
  *terms_ = CertifiedTerms::keeping(input.clearance, tolerance(input));
  // A motion that ends in the ball over the target is at most as long as the ball's diameter.
  const double longest = std::min(input.longest, 2.0 * searched_ends(input).radius * (1.0 + 1e-9));
  return traversal_->begin({input.tip, region(input), terms_->plane_level, longest});
}

/// A recovery calls this twice (Cycle::run). The same tip gives the same levels and walls, and the
/// second target is not used.
Opening CertifiedRule::open(const RuleInput& input, HalfSpaceBuffer&) noexcept {
  at_target_.reset();
  walls_.clear();
  const double tau = terms_->tolerance;
  if (!(input.clearance > needed_clearance * tau)) return {Status::margin_too_small};
  if (traversal_->region_is_empty()) return {};

  // The traversal shows the triangles near the tip first. If the tip has its clearance, the
  // traversal also finds the triangles that object to the target, which is the first trial.
  const double too_close = input.clearance - lost_below * tau;
  const Passage passage = traverse_along(input.target, {}, too_close);
  if (budget().is_spent()) return {budget().failure()};
  // prepared_ now has all triangles nearer than `too_close`.
  const PreparedTriangle* closest = nearest([](const PreparedTriangle&) { return true; });
  const std::optional<double> distance = known_distance(closest, input.clearance, tau);
  if (closest == nullptr || closest->distance() >= too_close) {
    at_target_ = passage;
    return {.distance = distance};
  }
  if (closest->distance() <= touching_within * tau) {
    return {.status = Status::touching, .distance = distance};
  }
  // Too close: the cycle recovers. The lift is at least a tolerance, so that losses to rounding are
  // regained and do not accumulate: rule 1.
  const double missing = input.clearance - closest->distance();
  const double lift = std::max(std::min(input.recovery, missing), tau);
  const Vec3 target = retreat_target(input, closest->towards_tip(), lift);
  *terms_ = CertifiedTerms::recovering(closest->distance(), lift, tau);
  choose_walls(*closest, too_close);
  forget_prepared_triangles(terms_->plane_level);
  return {Status::recovering, target, distance};
}

/// Clears the prepared triangles together with the traversal's notes, which are their indices.
/// `level`: of the traversals to come. [length]
void CertifiedRule::forget_prepared_triangles(double level) noexcept {
  prepared_.clear();
  traversal_->begin_again(level);
}

/// Traverses the index along a trial to the first contact of a triangle that objects (see
/// ContactSearch).
CertifiedRule::Passage CertifiedRule::traverse_along(const Vec3& trial,
                                                     std::span<const HalfSpace> planes,
                                                     double too_close) noexcept {
  Passage passage;
  ContactSearch visitor(*this, trial, planes, too_close, passage);
  passage.nothing_near = traversal_->traversal(trial, visitor);
  return passage;
}

/// Returns the nearest of the prepared triangles for which `accepts` is true, or null. If two are
/// equally near, the order of the corners decides.
template <class Accepts>
const PreparedTriangle* CertifiedRule::nearest(const Accepts& accepts) const noexcept {
  const PreparedTriangle* found = nullptr;
  for (const PreparedTriangle& prepared : prepared_) {
    if (found != nullptr && prepared.distance() > found->distance()) continue;
    if (!accepts(prepared)) continue;
    const bool is_first =
        found == nullptr || prepared.distance() < found->distance() || prepared.before(*found);
    if (is_first) found = &prepared;
  }
  return found;
}

/// Chooses prepared triangles nearer to the tip than `too_close` that face it from different
/// directions, the nearest first. Precondition: `first` is the nearest, and nearer than
/// `too_close`.
void CertifiedRule::choose_walls(const PreparedTriangle& first, double too_close) noexcept {
  const auto is_new = [&](const PreparedTriangle& prepared) {
    return prepared.distance() < too_close &&
           std::none_of(walls_.begin(), walls_.end(), [&](const PreparedTriangle& wall) {
             return wall.towards_tip().dot(prepared.towards_tip()) > same_direction;
           });
  };
  for (const PreparedTriangle* next = &first; next != nullptr; next = nearest(is_new)) {
    walls_.push(*next);
    if (walls_.size() == most_walls) return;
    budget().spend((1 + prepared_.size() / 8) * work::wall);
  }
}

/// Adds the planes of all walls together, except where there is a similar plane. Between many
/// faces, a trial for each plane would cost too much of the budget.
void CertifiedRule::add_planes_of_walls(HalfSpaceBuffer& planes) noexcept {
  for (const PreparedTriangle& wall : walls_) {
    const bool has_similar = std::any_of(planes.begin(), planes.end(), [&](const HalfSpace& plane) {
      return plane.source == wall.triangle() ||
             plane.normal.dot(wall.towards_tip()) > almost_parallel;
    });
    if (has_similar || prepared_.size() == prepared_.capacity()) continue;
    planes.push({wall.towards_tip(), wall.support(wall.towards_tip()) + terms_->plane_level,
                 wall.triangle()});
    prepared_.push(wall);
  }
  walls_.clear();
}

Judgement CertifiedRule::judge(const RuleInput& input, const Vec3& trial,
                               HalfSpaceBuffer& planes) noexcept {
  using Verdict = Judgement::Verdict;
  if (traversal_->region_is_empty()) return {Verdict::accepted};
  if (at_target_ && at_target_->nothing_near &&
      (trial - input.target).norm() <= MotionTraversal::alike * input.target.norm()) {
    return {Verdict::accepted};
  }
  const bool is_known = at_target_ && planes.empty() && trial == input.target;
  // open() has examined the distance of the tip, so no triangle ends the search for contacts.
  constexpr double too_close = 0.0;
  const Passage passage = is_known ? *at_target_ : traverse_along(trial, planes.view(), too_close);
  // If the budget is spent, the traversal may have left out triangles, so there is no conclusion.
  if (budget().is_spent()) return {Verdict::blocked, 0.0};
  if (!passage.has_contact()) return {Verdict::accepted};
  const HalfSpace& plane = passage.contact.plane;
  const double free_fraction = std::clamp(passage.contact.time, 0.0, 1.0);
  if (has_plane(plane.source, planes.view()) || planes.size() >= most_cutting_planes) {
    return {Verdict::blocked, free_fraction};
  }
  planes.push(terms_->plane_for(prepared_[passage.prepared], input, trial, plane));
  // All walls get planes with the first objection. A single wall gets its plane when it objects.
  if (walls_.size() > 1) add_planes_of_walls(planes);
  return {Verdict::objected, free_fraction};
}

bool CertifiedRule::relax(HalfSpaceBuffer& planes) noexcept {
  // Offsets above 0 demand motion, to regain clearance. Relaxed planes allow standing still.
  return terms_->relax(planes);
}

bool CertifiedRule::relinearize(const RuleInput& input, std::span<const HalfSpace> planes,
                                HalfSpaceBuffer& next) noexcept {
  bool changed = false;
  budget().spend(planes.size() * work::plane);
  budget().spend(planes.size() * (prepared_.size() / 64) * work::scan);
  for (const HalfSpace& plane : planes) {
    if (is_idle(plane, input)) continue;
    HalfSpace turned = plane;
    if (plane.source != no_triangle) {  // not the bound of the motion sphere
      turned = terms_->turned(plane, prepared(plane.source), input.accepted, input.accepted);
    }
    next.push(turned);
    changed = changed || (turned.normal - plane.normal).squaredNorm() > least_turn * least_turn;
  }
  return changed;
}

void CertifiedRule::add_alternatives(TriangleId triangle, HalfSpaceBuffer& planes) const noexcept {
  if (triangle != no_triangle) terms_->add_alternatives(prepared(triangle), planes);
}

/// Returns the prepared triangle of a triangle that has a plane. Precondition: it was examined.
const PreparedTriangle& CertifiedRule::prepared(TriangleId triangle) const noexcept {
  return *std::find_if(prepared_.begin(), prepared_.end(),
                       [&](const PreparedTriangle& one) { return one.triangle() == triangle; });
}

}  // namespace keepout
