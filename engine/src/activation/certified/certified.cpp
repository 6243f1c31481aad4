// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/activation/certified.h"

#include <algorithm>

#include "certified_terms.h"
#include "keepout/activation/planes.h"
#include "keepout/activation/tolerances.h"
#include "keepout/index/query.h"

namespace keepout {

/// Finds the first triangle that speaks against a trial, among those that the walk shows: rule 5 of
/// docs/certified-step.md.
class CertifiedRule::FirstMeeting final : public EncounterVisitor {
 public:
  /// A triangle nearer to the tip than `too_close` ends the search for contacts: visit() returns 0,
  /// and the walk then shows only triangles that may be within the level at the start of the
  /// motion. So `facets` gets all triangles nearer than `too_close`.
  FirstMeeting(const CertifiedTerms& terms, const Vec3& trial, std::span<const HalfSpace> planes,
               double too_close, Buffer<Facet>& facets, Budget& budget, Meeting& meeting) noexcept
      : terms_(terms),
        trial_(trial),
        length_(trial.norm()),
        planes_(planes),
        too_close_(too_close),
        facets_(facets),
        budget_(budget),
        work_of_planes_(1 + planes.size() / 16),
        meeting_(meeting) {}

  double visit(const Encounter& encounter) noexcept override {
    Contact& first = meeting_.contact;
    budget_.spend(work_of_planes_);
    std::uint32_t& number = encounter.note;  // of the facet of the triangle
    const bool is_known = number != Encounter::no_note;
    const Triangle& corners = is_known ? facets_[number].corners() : *encounter.corners;
    if (terms_.is_covered(corners, trial_, planes_)) return first.time;
    if (!is_known) {
      if (facets_.size() == facets_.capacity()) {
        budget_.mark_overflow();
        budget_.spend_all();
        return first.time;
      }
      budget_.spend(work_of_facet);
      facets_.push(Facet(corners, encounter.triangle));
      number = static_cast<std::uint32_t>(facets_.size() - 1);
    }
    const Facet& facet = facets_[number];
    // Rule 5 (b): too far for a motion of this length.
    if (facet.distance() - length_ > terms_.demand(facet)) return first.time;
    if (facet.distance() < too_close_) {
      first.time = 0.0;  // without a facet
      return first.time;
    }
    if (terms_.is_clear_at_once(facet, trial_)) return first.time;
    budget_.spend(work_of_contact);
    // The time of contact is cheaper to find than a proof of clearance, and most triangles that
    // come this far are met. It is a lower bound (Lemma 6): after the end of the trial it proves
    // the facet clear, rule 5 (d); after the contact with another facet it does not matter.
    const Contact contact = terms_.contact(facet, trial_, first.time);
    if (!is_sooner(contact, facet)) return first.time;
    if (!terms_.is_beyond_doubt(contact, facet, trial_)) {
      const bool has_own_plane = has_plane(facet.source(), planes_);
      if (terms_.stays_clear(facet, trial_, has_own_plane)) return first.time;
    }
    first = contact;
    meeting_.facet = number;
    return first.time;
  }

 private:
  // In work units, about as long as each takes.
  static constexpr std::size_t work_of_facet = 2;
  static constexpr std::size_t work_of_contact = 6;

  /// Returns true if the contact is before the first one so far; of equals the first by its
  /// corners.
  bool is_sooner(const Contact& contact, const Facet& facet) const noexcept {
    const Contact& first = meeting_.contact;
    return contact.time < first.time ||
           (contact.time == first.time && meeting_.facet != Encounter::no_note &&
            facet.before(facets_[meeting_.facet]));
  }

  const CertifiedTerms& terms_;
  const Vec3& trial_;
  double length_;
  std::span<const HalfSpace> planes_;
  double too_close_;
  Buffer<Facet>& facets_;
  Budget& budget_;
  std::size_t work_of_planes_;
  Meeting& meeting_;
};

namespace {

// Cosines of the angles of normals: of walls in about the same direction, and of planes that are
// almost parallel, which solvers find contradictory by their rounding.
constexpr double same_direction = 0.8;
constexpr double almost_parallel = 0.99;

}  // namespace

CertifiedRule::CertifiedRule() : terms_(std::make_unique<CertifiedTerms>()), facets_(0) {}

CertifiedRule::~CertifiedRule() = default;

void CertifiedRule::prepare(Neighborhood& near) {
  ActivationRule::prepare(near);
  walk_ = make_motion_walk(near);
  // The walls are in it twice if the walk shows them again.
  facets_ = Buffer<Facet>(walk_->room() + most_walls);
}

double CertifiedRule::tolerance(const CycleProblem& problem) const noexcept {
  return 2e-10 * (mesh().longest_edge() + problem.radius + problem.clearance) +
         4e-16 * problem.tip.lpNorm<1>();
}

Ball CertifiedRule::region(const CycleProblem& problem) const noexcept {
  Ball ball = searched_ends(problem);
  ball.radius += problem.clearance + region_beyond * tolerance(problem);
  return ball;
}

bool CertifiedRule::makes_queries() const noexcept { return !index().walks(); }

bool CertifiedRule::gather(const CycleProblem& problem) noexcept {
  facets_.clear();
  *terms_ = CertifiedTerms::keeping(problem.clearance, tolerance(problem));
  const Ball ends = searched_ends(problem);
  const double longest = std::min(problem.longest, 2.0 * ends.radius * (1.0 + 1e-9));
  const double beyond = problem.clearance + region_beyond * terms_->tolerance;
  return walk_->begin(
      {problem.tip, {ends.center, ends.radius + beyond}, terms_->plane_level, longest});
}

Opening CertifiedRule::open(const CycleProblem& problem, HalfSpaceBuffer&) noexcept {
  target_is_free_ = false;
  at_target_.reset();
  walls_.clear();
  const double tau = terms_->tolerance;
  if (!(problem.clearance > needed_margin * tau)) return {Status::margin_too_small};
  if (walk_->is_free()) return {};

  // The walk shows the triangles near the tip first. If the tip keeps its clearance, it also finds
  // what speaks against the target, which is the first trial.
  const double least = problem.clearance - lost_below * tau;
  const Passage passage = pass_along(problem.target, {}, least);
  if (budget().is_spent()) return {budget().status_at_end()};
  // Now facets_ has all triangles nearer than `least`.
  const Facet* closest = nearest([](const Facet&) { return true; });
  const std::optional<double> distance = known_distance(closest, problem.clearance, tau);
  if (closest == nullptr || closest->distance() >= least) {
    target_is_free_ = passage.nothing_near;
    at_target_ = passage.first;
    return {.distance = distance};
  }
  if (closest->distance() <= touching_within * tau) {
    return {.status = Status::touching, .distance = distance};
  }
  // Too close: the cycle recovers. The lift is at least a tolerance, so that losses to rounding are
  // regained and do not accumulate: rule 1.
  const double missing = problem.clearance - closest->distance();
  const double lift = std::max(std::min(problem.recovery, missing), tau);
  const Vec3 target = retreat_target(problem, closest->normal(), lift);
  *terms_ = CertifiedTerms::recovering(closest->distance(), lift, tau);
  choose_walls(*closest, least);
  walk_->begin_again(terms_->plane_level);
  facets_.clear();
  return {Status::recovering, target, distance};
}

/// Walks along a trial to the first triangle that speaks against it; see FirstMeeting. Adds the
/// triangles that it examines to facets_.
CertifiedRule::Passage CertifiedRule::pass_along(const Vec3& trial,
                                                 std::span<const HalfSpace> planes,
                                                 double too_close) noexcept {
  Passage passage;
  FirstMeeting visitor(*terms_, trial, planes, too_close, facets_, budget(), passage.first);
  passage.nothing_near = walk_->walk(trial, visitor);
  return passage;
}

/// Returns the nearest of the facets that `accepts` accepts, of equals the first by their corners;
/// null if it accepts none.
template <class Accepts>
const Facet* CertifiedRule::nearest(const Accepts& accepts) const noexcept {
  const Facet* found = nullptr;
  for (const Facet& facet : facets_) {
    if (found != nullptr && facet.distance() > found->distance()) continue;
    if (!accepts(facet)) continue;
    const bool is_first =
        found == nullptr || facet.distance() < found->distance() || facet.before(*found);
    if (is_first) found = &facet;
  }
  return found;
}

/// Chooses facets nearer to the tip than `too_close` that face it from different directions, the
/// nearest first. Precondition: `first` is the nearest, and it is nearer than that.
void CertifiedRule::choose_walls(const Facet& first, double too_close) noexcept {
  const auto is_new = [&](const Facet& facet) {
    return facet.distance() < too_close &&
           std::none_of(walls_.begin(), walls_.end(), [&](const Facet& wall) {
             return wall.normal().dot(facet.normal()) > same_direction;
           });
  };
  for (const Facet* next = &first; next != nullptr; next = nearest(is_new)) {
    walls_.push(*next);
    if (walls_.size() == most_walls) return;
    budget().spend(1 + facets_.size() / 8);
  }
}

/// Adds the planes of all walls together, unless the planes have a similar one: between many faces
/// a trial for each would cost too much of the budget.
void CertifiedRule::add_planes_of_walls(HalfSpaceBuffer& planes) noexcept {
  for (const Facet& wall : walls_) {
    const bool has_similar = std::any_of(planes.begin(), planes.end(), [&](const HalfSpace& plane) {
      return plane.source == wall.source() || plane.normal.dot(wall.normal()) > almost_parallel;
    });
    if (has_similar || facets_.size() == facets_.capacity()) continue;
    planes.push({wall.normal(), wall.support(wall.normal()) + terms_->plane_level, wall.source()});
    facets_.push(wall);
  }
  walls_.clear();
}

Judgement CertifiedRule::judge(const CycleProblem& problem, const Vec3& trial,
                               HalfSpaceBuffer& planes) noexcept {
  using Verdict = Judgement::Verdict;
  if (walk_->is_free()) return {Verdict::accepted};
  if (target_is_free_ &&
      (trial - problem.target).norm() <= MotionWalk::alike * problem.target.norm()) {
    return {Verdict::accepted};
  }
  const bool is_known = at_target_ && planes.empty() && trial == problem.target;
  const Meeting meeting = is_known ? *at_target_ : pass_along(trial, planes.view(), 0.0).first;
  // If the budget is spent, triangles may have been left out, and nothing may be concluded.
  if (budget().is_spent()) return {Verdict::blocked, 0.0};
  if (meeting.facet == Encounter::no_note) return {Verdict::accepted};
  const HalfSpace& plane = meeting.contact.plane;
  const double free_fraction = std::clamp(meeting.contact.time, 0.0, 1.0);
  if (has_plane(plane.source, planes.view()) || planes.size() >= most_cutting_planes) {
    return {Verdict::blocked, free_fraction};
  }
  planes.push(terms_->plane_for(facets_[meeting.facet], problem, trial, plane));
  if (walls_.size() > 1) add_planes_of_walls(planes);
  return {Verdict::objected, free_fraction};
}

bool CertifiedRule::relax(HalfSpaceBuffer& planes) noexcept {
  // Offsets above 0 demand motion, to regain clearance. Relaxed planes allow standing still.
  return terms_->relax(planes);
}

bool CertifiedRule::relinearize(const CycleProblem& problem, std::span<const HalfSpace> planes,
                                HalfSpaceBuffer& next) noexcept {
  bool changed = false;
  budget().spend(planes.size() * (4 + facets_.size() / 64));
  for (const HalfSpace& plane : planes) {
    if (is_idle(plane, problem)) continue;
    HalfSpace turned = plane;
    if (plane.source != no_triangle) {  // not the bound of the motion sphere
      turned = terms_->turned(plane, facet(plane.source), problem.accepted, problem.accepted);
    }
    next.push(turned);
    changed = changed || (turned.normal - plane.normal).squaredNorm() > least_turn * least_turn;
  }
  return changed;
}

void CertifiedRule::add_alternatives(TriangleId source, HalfSpaceBuffer& planes) const noexcept {
  if (source != no_triangle) terms_->add_alternatives(facet(source), planes);
}

const Facet& CertifiedRule::facet(TriangleId source) const noexcept {
  return *std::find_if(facets_.begin(), facets_.end(),
                       [&](const Facet& one) { return one.source() == source; });
}

}  // namespace keepout
