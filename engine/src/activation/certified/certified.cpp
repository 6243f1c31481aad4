// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/activation/certified.h"

#include <algorithm>

#include "certified_terms.h"
#include "keepout/activation/planes.h"
#include "keepout/activation/tolerances.h"
#include "keepout/index/query.h"

namespace keepout {

/// Keeps the first contact of a trial with the triangles that it is shown.
class CertifiedRule::FirstMeeting final : public EncounterVisitor {
 public:
  /// A triangle nearer to the tip than `too_close` ends the search: what speaks against the trial
  /// does not matter then, and `facets` gets all that are as near.
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

  double visit(const Encounter& its) noexcept override {
    Contact& first = meeting_.contact;
    budget_.spend(work_of_planes_);
    const bool is_known = its.note != Encounter::no_note;
    const Triangle& corners = is_known ? facets_[its.note].corners() : *its.corners;
    if (terms_.is_covered(corners, trial_, planes_)) return first.time;
    if (!is_known) {
      if (facets_.size() == facets_.capacity()) {
        budget_.mark_overflow();
        budget_.spend_all();
        return first.time;
      }
      budget_.spend(work_of_facet);
      facets_.push(Facet(corners, its.triangle));
      its.note = static_cast<std::uint32_t>(facets_.size() - 1);
    }
    const Facet& facet = facets_[its.note];
    if (facet.distance() - length_ > terms_.demand(facet)) return first.time;
    if (facet.distance() < too_close_) return first.time = at_once;
    if (terms_.is_clear_at_once(facet, trial_)) return first.time;
    budget_.spend(work_of_contact);
    // When the trial would meet it takes less to find than whether it does, and most triangles that
    // come this far are met.
    const Contact contact = terms_.contact(facet, trial_, first.time);
    if (!is_sooner(contact, facet)) return first.time;
    if (!terms_.is_beyond_doubt(contact, facet, trial_)) {
      const bool answered = has_plane(facet.source(), planes_);
      if (terms_.keeps_clear(facet, trial_, answered)) return first.time;
    }
    first = contact;
    meeting_.facet = its.note;
    return first.time;
  }

 private:
  static constexpr double at_once = 0.0;

  // In looks, about as long as each takes.
  static constexpr std::size_t work_of_facet = 2;
  static constexpr std::size_t work_of_contact = 6;

  /// Of equals the first by its corners.
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

// Cosines of normals: of walls that lead off alike, and of those that are almost parallel, which
// solvers find contradictory by their rounding.
constexpr double alike = 0.8;
constexpr double almost_parallel = 0.99;

}  // namespace

CertifiedRule::CertifiedRule() : terms_(std::make_unique<CertifiedTerms>()), facets_(0) {}

CertifiedRule::~CertifiedRule() = default;

void CertifiedRule::prepare(Neighborhood& near) {
  ActivationRule::prepare(near);
  walk_ = make_motion_walk(near);
  facets_ = Buffer<Facet>(walk_->room());
}

double CertifiedRule::tolerance(const CycleProblem& problem) const noexcept {
  return 2e-10 * (mesh().longest_edge() + problem.radius + problem.margin) +
         4e-16 * problem.tip.lpNorm<1>();
}

Ball CertifiedRule::region(const CycleProblem& problem) const noexcept {
  Ball ball = ends_of_motions(problem);
  ball.radius += problem.margin + region_beyond * tolerance(problem);
  return ball;
}

bool CertifiedRule::gather(const CycleProblem& problem) noexcept {
  facets_.clear();
  *terms_ = CertifiedTerms::keeping(problem.margin, tolerance(problem));
  const Ball ends = ends_of_motions(problem);
  const double longest = std::min(problem.longest, 2.0 * ends.radius * (1.0 + 1e-9));
  const double beyond = problem.margin + region_beyond * terms_->tolerance;
  return walk_->begin(
      {problem.tip, {ends.center, ends.radius + beyond}, terms_->clearance, longest});
}

Opening CertifiedRule::open(const CycleProblem& problem, HalfSpaceBuffer&) noexcept {
  target_is_free_ = false;
  at_target_.reset();
  walls_.clear();
  const double tau = terms_->tolerance;
  if (!(problem.margin > needed_margin * tau)) return {Status::margin_too_small};
  if (walk_->is_free()) return {};

  // What is in reach of the tip itself, which comes first; and by the way, what speaks against the
  // motion asked for, should the tip keep the margin: it is the first trial.
  const double least = problem.margin - lost_below * tau;
  target_is_free_ = meet(problem.target, {}, least, at_target_.emplace());
  if (budget().is_spent()) return {budget().status_at_end()};
  const Facet* near = nearest([](const Facet&) { return true; });
  const std::optional<double> distance = known_distance(near, problem.margin, tau);
  if (near == nullptr || near->distance() >= least) return {.distance = distance};
  target_is_free_ = false;
  at_target_.reset();
  if (near->distance() <= touching_within * tau) {
    return {.status = Status::touching, .distance = distance};
  }
  // Too close already: the mesh shall not come closer, and what comes as close is led off as well.
  // By a tolerance at least, so that what was lost to rounding comes back and nothing adds up.
  const double missing = problem.margin - near->distance();
  const double lift = std::max(std::min(problem.recovery, missing), tau);
  const Vec3 target = way_out(problem, near->normal(), lift);
  *terms_ = CertifiedTerms::leading_off(near->distance(), lift, tau);
  choose_walls(*near, least);
  walk_->begin_again(terms_->clearance);
  facets_.clear();
  return {Status::recovering, target, distance};
}

/// Walks along a trial to what it meets first. Whether nothing came near it, so that others like it
/// are as free.
bool CertifiedRule::meet(const Vec3& trial, std::span<const HalfSpace> planes, double too_close,
                         Meeting& meeting) noexcept {
  FirstMeeting visitor(*terms_, trial, planes, too_close, facets_, budget(), meeting);
  return walk_->walk(trial, visitor);
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
             return wall.normal().dot(facet.normal()) > alike;
           });
  };
  for (const Facet* next = &first; next != nullptr; next = nearest(is_new)) {
    walls_.push(*next);
    if (walls_.size() == most_walls) return;
    budget().spend(1 + facets_.size() / 8);
  }
}

/// Adds the planes of all walls at once: one by one, between many faces, they cost the budget.
void CertifiedRule::answer_walls(HalfSpaceBuffer& planes) noexcept {
  for (const Facet& wall : walls_) {
    const bool is_led = std::any_of(planes.begin(), planes.end(), [&](const HalfSpace& plane) {
      return plane.source == wall.source() || plane.normal.dot(wall.normal()) > almost_parallel;
    });
    if (is_led || facets_.size() == facets_.capacity()) continue;
    planes.push({wall.normal(), wall.support(wall.normal()) + terms_->clearance, wall.source()});
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
  Meeting meeting;
  if (at_target_ && planes.empty() && trial == problem.target) {
    meeting = *at_target_;
  } else {
    meet(trial, planes.view(), 0.0, meeting);
  }
  // Then triangles may have been left out, and nothing may be concluded.
  if (budget().is_spent()) return {Verdict::blocked, 0.0};
  if (meeting.facet == Encounter::no_note) return {Verdict::accepted};
  const HalfSpace& plane = meeting.contact.plane;
  const double free_fraction = std::clamp(meeting.contact.time, 0.0, 1.0);
  if (has_plane(plane.source, planes.view()) || planes.size() >= most_cutting_planes) {
    return {Verdict::blocked, free_fraction};
  }
  planes.push(terms_->answer(facets_[meeting.facet], problem, trial, plane));
  if (walls_.size() > 1) answer_walls(planes);
  return {Verdict::objected, free_fraction};
}

bool CertifiedRule::relax(HalfSpaceBuffer& planes) noexcept {
  // Offsets above 0 lead back to the full margin. Standing still is always allowed.
  return terms_->relax(planes);
}

bool CertifiedRule::relinearize(const CycleProblem& problem, std::span<const HalfSpace> planes,
                                HalfSpaceBuffer& turned) noexcept {
  bool changed = false;
  budget().spend(planes.size() * (4 + facets_.size() / 64));
  for (const HalfSpace& plane : planes) {
    if (is_idle(plane, problem)) continue;
    // One that is not a triangle's but the motion sphere's stays.
    HalfSpace next = plane;
    if (plane.source != no_triangle) {
      next = terms_->turned(plane, facet(plane.source), problem.accepted, problem.accepted);
    }
    turned.push(next);
    changed = changed || (next.normal - plane.normal).squaredNorm() > least_turn * least_turn;
  }
  return changed;
}

void CertifiedRule::ways_around(TriangleId source, HalfSpaceBuffer& ways) const noexcept {
  if (source != no_triangle) terms_->ways_around(facet(source), ways);
}

const Facet& CertifiedRule::facet(TriangleId source) const noexcept {
  return *std::find_if(facets_.begin(), facets_.end(),
                       [&](const Facet& one) { return one.source() == source; });
}

}  // namespace keepout
