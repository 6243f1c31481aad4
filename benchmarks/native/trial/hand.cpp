// SPDX-License-Identifier: BSD-3-Clause
#include "hand.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace keepout::trial {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr int stalled = 4;  // decisions; then the hand pulls on

int cycles(double seconds, double period) {
  return std::max(1, static_cast<int>(std::nearbyint(seconds / period)));
}

class OpenLoopHand final : public Hand {
 public:
  OpenLoopHand(OpenLoop hand, const HandSettings& settings)
      : hand_(std::move(hand)),
        settings_(settings),
        reaction_(cycles(settings.reaction, settings.period)),
        spacing_(settings.speed / hand_.samples),
        lean_(settings.fixture ? hand_.leaning : 0.0) {}

  Coordinates aim(int cycle, int approach) override {
    if (cycle > approach) {
      const double seen =
          cycle > reaction_ ? factors_[static_cast<std::size_t>(cycle - 1 - reaction_)] : 1.0;
      along_ += settings_.speed * settings_.period * seen;
    }
    const auto [across, below] = hand_.errors.interpolated(along_ / spacing_);
    below_ = settings_.depth + below;
    return {along_, across, below_ + lean_};
  }

  void look(const Seen& seen) override {
    const double aside_squared = seen.ahead * seen.ahead + seen.across * seen.across;
    const double hanging =
        seen.push > settings_.felt_force ? 0.0 : std::max(0.0, below_ - seen.depth - seen.above);
    factors_.push_back(
        1.0 / (1.0 + (aside_squared + hanging * hanging) / (hand_.tolerance * hand_.tolerance)));
  }

 private:
  OpenLoop hand_;
  HandSettings settings_;
  int reaction_;
  double spacing_, lean_, along_ = 0.0, below_ = 0.0;
  std::vector<double> factors_;  // on the speed, from what the eye saw in each cycle
};

class IntermittentHand final : public Hand {
 public:
  IntermittentHand(Intermittent hand, const HandSettings& settings)
      : hand_(std::move(hand)),
        settings_(settings),
        reaction_(cycles(settings.reaction, settings.period)),
        refractory_(cycles(hand_.refractory, settings.period)),
        movement_(cycles(hand_.movement, settings.period)),
        looks_(hand_.motor.rows / hand_.looks, 0) {}

  Coordinates aim(int cycle, int approach) override {
    if (next_ < 0) next_ = approach + refractory_;
    if (cycle >= next_) decide(cycle);
    Vector out = done_;
    std::size_t left = 0;
    for (std::size_t m = 0; m < moves_.size(); ++m) {
      const Movement move = moves_[m];
      const double part = static_cast<double>(cycle - move.start) / movement_;
      if (part >= 1.0) {
        for (std::size_t i = 0; i < 3; ++i) {
          done_[i] += move.length[i];
          out[i] += move.length[i];
        }
      } else {
        moves_[left++] = move;
        // The submovement has minimum jerk.
        const double share = part * part * part * (10.0 + part * (6.0 * part - 15.0));
        for (std::size_t i = 0; i < 3; ++i) out[i] += move.length[i] * share;
      }
    }
    moves_.resize(left);
    aims_.push_back(out);
    return {out[0], out[1], out[2]};
  }

  void look(const Seen& seen) override { seen_.push_back(seen); }

 private:
  using Vector = std::array<double, 3>;  // along, across and below the path [mm]
  struct Movement {
    int start;
    Vector length;
  };

  /// Makes one decision from what was seen a reaction ago, and starts its submovement.
  void decide(int cycle);

  Intermittent hand_;
  HandSettings settings_;
  int reaction_, refractory_, movement_;
  int next_ = -1;                   // the cycle of the next decision
  std::vector<std::size_t> looks_;  // decisions in each millimeter
  Vector done_{}, end_{};           // the sum of finished submovements, and of all
  std::vector<Movement> moves_;     // that are not finished
  std::vector<Vector> aims_;        // in each cycle
  std::vector<Seen> seen_;
  bool turn_of_depth_ = true;
  bool at_depth_ = false;  // a look showed the wanted depth, since the tool entered
  bool lifted_ = false;
  int misses_ = 0;   // looks at the depth in a row that showed an error
  int stalled_ = 0;  // decisions to go on in a row while the command was too far ahead
};

void IntermittentHand::decide(int cycle) {
  const double tolerance = hand_.tolerance;
  const auto seen_in = static_cast<std::size_t>(cycle - reaction_);
  const Seen then = seen_[seen_in];
  const Vector aim = aims_[seen_in];
  Vector pending;  // sent, and not yet seen
  for (std::size_t i = 0; i < 3; ++i) pending[i] = end_[i] - aim[i];
  const double place = std::min(std::max(end_[0], 0.0), static_cast<double>(looks_.size()) - 1.0);
  const auto millimeter = static_cast<std::size_t>(place);
  const std::size_t number = millimeter * hand_.looks + looks_[millimeter] % hand_.looks;
  ++looks_[millimeter];
  const auto view = hand_.view.interpolated(place);
  const double lasting = std::sqrt(hand_.lasting), fresh = std::sqrt(1.0 - hand_.lasting);
  const double seen_across =
      then.across + hand_.sight_across * (lasting * view[0] + fresh * hand_.sight(number, 0));
  const double seen_depth =
      then.depth + hand_.sight_in_depth * (lasting * view[1] + fresh * hand_.sight(number, 1));
  const double across = seen_across + pending[1];
  const double error = seen_depth + pending[2] - settings_.depth;
  // The command may go ahead of the tip by this much more.
  const double room_along =
      settings_.cutting ? tolerance - (end_[0] - aim[0] - then.ahead) : infinity;
  const double room_below = settings_.cutting ? tolerance - (end_[2] - seen_depth) : infinity;

  const bool feels = settings_.fixture && then.push > settings_.felt_force;
  Vector length{};
  int wait = refractory_;
  if (lifted_) {
    length[1] = std::abs(across) > tolerance ? -across : 0.0;
    length[2] = tolerance - end_[2];  // down to the surface; the next decisions press on
    lifted_ = false;
    wait = movement_ + reaction_;
  } else if (turn_of_depth_ && !feels) {
    if (settings_.fixture) {
      length[2] = std::max(0.0, std::min(tolerance, room_below));
    } else if (std::abs(error) <= tolerance) {
      at_depth_ = true;
      misses_ = 0;
    } else {
      ++misses_;
      if (settings_.cutting && at_depth_ && misses_ >= 2) {
        length[2] = -(end_[2] + hand_.lift);
        lifted_ = true;
        at_depth_ = false;
        misses_ = 0;
        wait = movement_ + reaction_;
      } else {
        length[2] = std::min(-error, std::max(0.0, room_below));
      }
    }
  } else {
    length[1] = std::abs(across) > tolerance ? -across : 0.0;
    const bool goes_on = feels || (!settings_.fixture && at_depth_ && misses_ == 0);
    if (goes_on && end_[0] < settings_.length) {
      const double pace = settings_.speed * hand_.refractory;
      stalled_ = room_along <= 0.0 ? stalled_ + 1 : 0;
      length[0] = stalled_ >= stalled ? pace : std::max(0.0, std::min(pace, room_along));
    }
    if (feels) {
      const double push = then.push + settings_.force_per_mm * pending[2];
      length[2] =
          std::min(std::max((hand_.touch - push) / settings_.force_per_mm, -tolerance), tolerance);
    }
  }
  turn_of_depth_ = !turn_of_depth_;
  next_ = cycle + wait;
  const double size =
      std::sqrt(length[0] * length[0] + length[1] * length[1] + length[2] * length[2]);
  if (size > 0.0) {
    for (std::size_t i = 0; i < 3; ++i) {
      length[i] += size * (hand_.noise * hand_.motor(number, i) + hand_.drift * hand_.heading[i]);
      end_[i] += length[i];
    }
    moves_.push_back({cycle, length});
  }
}

}  // namespace

std::array<double, 2> Table::interpolated(double place) const {
  place = std::min(std::max(place, 0.0), static_cast<double>(rows) - 1.0);
  const std::size_t low = std::min(static_cast<std::size_t>(place), rows - 2);
  const double share = place - static_cast<double>(low);
  const Table& table = *this;
  return {(1.0 - share) * table(low, 0) + share * table(low + 1, 0),
          (1.0 - share) * table(low, 1) + share * table(low + 1, 1)};
}

std::unique_ptr<Hand> make_hand(OpenLoop hand, const HandSettings& settings) {
  return std::make_unique<OpenLoopHand>(std::move(hand), settings);
}

std::unique_ptr<Hand> make_hand(Intermittent hand, const HandSettings& settings) {
  return std::make_unique<IntermittentHand>(std::move(hand), settings);
}

}  // namespace keepout::trial
