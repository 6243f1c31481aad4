// SPDX-License-Identifier: BSD-3-Clause
// Other code of the process changes the rounding mode, or interrupts a step with a signal.

#if defined(__SSE2__)
#include <immintrin.h>
#endif
#include <sys/time.h>

#include <array>
#include <cfenv>
#include <csignal>
#include <functional>
#include <memory>
#include <vector>

#include "guards.h"
#include "keepout/error.h"
#include "keepout/rounding_mode.h"
#include "realtime/counted_allocations.h"
#include "trials.h"

namespace keepout {
namespace {

constexpr std::array modes{FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO};

/// Calls in each mode other than to nearest, set for the whole thread. Afterwards the mode is as
/// before.
void in_each_mode(const std::function<void()>& call) {
  for (const int mode : modes) {
    SCOPED_TRACE(mode);
    std::fesetround(mode);
    call();
    EXPECT_EQ(std::fegetround(), mode) << "the mode of the caller was lost";
    std::fesetround(FE_TONEAREST);
  }
}

TEST(RoundsToNearest, NoticesEachMode) {
  EXPECT_TRUE(rounds_to_nearest());
  in_each_mode([] {
    EXPECT_FALSE(rounds_to_nearest());
    const RoundingToNearest rounding;
    EXPECT_TRUE(rounds_to_nearest());
  });
}

#if defined(__SSE2__)
TEST(RoundsToNearest, NoticesAndRestoresTheModeOfTheSseUnitAlone) {
  const unsigned usual = _mm_getcsr();
  for (const unsigned mode : {_MM_ROUND_UP, _MM_ROUND_DOWN, _MM_ROUND_TOWARD_ZERO}) {
    _mm_setcsr(usual | mode);
    EXPECT_FALSE(rounds_to_nearest());
    {
      const RoundingToNearest rounding;
      EXPECT_TRUE(rounds_to_nearest());
    }
    EXPECT_EQ(_mm_getcsr() & _MM_ROUND_MASK, mode);
    _mm_setcsr(usual);
  }
}
#endif

/// The results of one round of calls, to compare bit for bit.
struct Round {
  Vec3 motion = Vec3::Zero();
  std::array<double, 6> increment{};
  double fraction = 0.0;
  double offsets = 0.0;  // the sum of a polytope's [length]
  std::array<Status, 4> statuses{};

  bool operator==(const Round&) const = default;
};

/// A tip and an instrument at one mesh.
class Loops {
 public:
  explicit Loops(const std::shared_ptr<const Mesh>& mesh)
      : tip_(guard_of(mesh, {.radius = 2.0, .margin = 0.2})),
        instrument_(guard_of(mesh, psm({Vec3(0, 0, 100), Mat3::Identity()}))) {}

  /// Returns the results of steps, a proof and a polytope at random places. They are computed in
  /// the rounding mode `mode`.
  Round round(Random& random, int mode = FE_TONEAREST) {
    const Motion request{.tip = 12.0 * random.uniform() * random.direction(),
                         .desired = random.direction()};
    std::array<double, 6> q{0, 0, random.uniform(40.0, 120.0), 0, 0, 0};
    for (const std::size_t k : {0, 1, 3, 4, 5}) q[k] = random.uniform(-0.3, 0.3);
    const Twist displacement{.linear = random.direction(), .angular = Vec3::Zero()};
    const std::array increment{0.02, 0.02, 1.0, 0.1, 0.1, 0.1};
    tip_.forget();
    instrument_.forget();
    std::fesetround(mode);
    const Step step = tip_.step(request);
    const Polytope polytope = tip_.free_polytope(request.tip, 1.0);
    const InstrumentStep joints = instrument_.step(q, displacement);
    std::array<double, 6> made{};
    std::ranges::copy(joints.increment, made.begin());
    const MotionProof proof = instrument_.prove(q, increment);
    std::fesetround(FE_TONEAREST);
    double offsets = 0.0;
    for (const HalfSpace& plane : polytope.planes) offsets += plane.offset;
    return {step.motion,
            made,
            proof.fraction,
            offsets,
            {step.status, polytope.status, joints.status, proof.status}};
  }

 private:
  MotionConstraint tip_;
  InstrumentConstraint instrument_;
};

bool is_limited(const Round& round) {
  return std::ranges::count(round.statuses, Status::limited) > 0;
}

TEST(RoundsToNearest, ResultsHaveTheSameBitsInEachModeAndNothingIsAllocated) {
  Loops loops(mesh_of("gear"));
  for (const int mode : modes) {
    SCOPED_TRACE(mode);
    Random random(5);
    Random again(5);
    int limited = 0;
    for (int i = 0; i < test::trials(2'000); ++i) {
      const Round expected = loops.round(random);
      const std::size_t before = allocations();
      ASSERT_EQ(loops.round(again, mode), expected);
      ASSERT_EQ(allocations(), before);
      limited += is_limited(expected);
    }
    EXPECT_GT(limited, test::trials(2'000) / 20);
  }
}

TEST(RoundsToNearest, NothingThatProofsRestOnIsMadeInAnotherMode) {
  const Surface surface = make_cube(5.0);
  const auto mesh = mesh_of(surface);
  const auto index = std::make_shared<WideBvh>(mesh);
  const Instrument instrument = psm();
  auto tip = guard_of(mesh, {.radius = 2.0, .margin = 0.2});
  auto guarded = guard_of(mesh, instrument);
  in_each_mode([&] {
    EXPECT_THROW(Mesh{surface}, Error);
    EXPECT_THROW(WideBvh{mesh}, Error);
    EXPECT_THROW(index->refit(mesh), Error);
    EXPECT_THROW(Chain({Joint{}}), Error);
    EXPECT_THROW(tip.follow(mesh, index), Error);
    EXPECT_THROW(guarded.follow(mesh, index), Error);
    EXPECT_THROW(guarded.add_mesh(mesh, index), Error);
    EXPECT_THROW(InstrumentConstraint(instrument, std::make_unique<ActiveSet>(), {}), Error);
  });
  EXPECT_EQ(guarded.mesh_count(), 1u);
  EXPECT_TRUE(tip.step({.tip = Vec3(0, 0, 20), .desired = Vec3::UnitX()}).ok());
}

/// The handler of SIGALRM rounds upward, and steps constraints of its own.
Loops* interrupting = nullptr;
Random* of_handler = nullptr;
volatile std::sig_atomic_t interruptions = 0;

void interrupt(int) {
  interruptions = interruptions + 1;
  interrupting->round(*of_handler);
  std::fesetround(FE_UPWARD);  // the kernel restores the interrupted mode
}

TEST(Signals, ThatInterruptStepsDoNotChangeTheirBits) {
  const auto mesh = mesh_of("gear");
  Loops loops(mesh);
  Loops of_signals(mesh);
  Random random_of_signals(9);
  interrupting = &of_signals;
  of_handler = &random_of_signals;
  Random random(6);
  std::vector<Round> expected;
  for (int i = 0; i < test::trials(5'000); ++i) expected.push_back(loops.round(random));
  const auto previous = std::signal(SIGALRM, interrupt);
  const itimerval often{.it_interval = {0, 200}, .it_value = {0, 200}};
  Random again(6);
  setitimer(ITIMER_REAL, &often, nullptr);
  std::size_t differing = 0;
  for (const Round& round : expected) differing += loops.round(again) != round;
  const itimerval never{};
  setitimer(ITIMER_REAL, &never, nullptr);
  std::signal(SIGALRM, previous);
  EXPECT_EQ(differing, 0u);
  EXPECT_GT(interruptions, 20);
  EXPECT_TRUE(rounds_to_nearest());
}

}  // namespace
}  // namespace keepout
