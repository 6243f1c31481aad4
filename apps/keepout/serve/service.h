// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "keepout/factory/make_instrument_constraint.h"
#include "keepout/factory/make_motion_constraint.h"
#include "keepout/mesh/load_mesh.h"
#include "serve/client.h"
#include "serve/request.h"

namespace keepout::app {

inline constexpr std::size_t default_longest_line = std::size_t{1} << 18;

/// One line of input, without its end.
struct Line {
  bool is_too_long = false;  // it was skipped: there is no text
  std::string_view text;
};

/// Cuts bytes that come in pieces into lines, in memory of a fixed size. Lines end with "\n" or
/// "\r\n". A line that is too long is skipped to its end, and told of once.
class LineReader {
 public:
  /// `longest`: of a line without its end. [bytes] Makes all memory here.
  explicit LineReader(std::size_t longest);

  /// Where the next bytes may be put; never empty once all lines have been taken.
  std::span<char> room() noexcept;

  /// That many bytes have been put there.
  void added(std::size_t count) noexcept { end_ += count; }

  /// No more bytes will come: what is left counts as a line.
  void ended() noexcept { has_ended_ = true; }

  /// The next whole line; nothing if more bytes are needed. Its text is valid until the next
  /// room().
  std::optional<Line> next() noexcept;

 private:
  std::optional<Line> finished(std::size_t line_end, std::size_t next_begin) noexcept;

  std::size_t longest_;
  std::vector<char> buffer_;  // of the longest line and its end
  std::size_t begin_ = 0;     // of the line that is being read
  std::size_t searched_ = 0;  // no line ends before
  std::size_t end_ = 0;       // of what was read
  bool is_skipping_ = false;  // the beginning of this line is gone: it was too long
  bool has_ended_ = false;
};

/// What a service is made from.
struct ServiceSettings {
  std::filesystem::path mesh;                         // what it was read from, to be told
  AnatomicalSpace space = AnatomicalSpace::unstated;  // that its coordinates are in, to be told
  MotionConstraintSettings constraint{.options = {.distances = Distances::always}};
  RequestLimits limits;
  std::size_t longest_line = default_longest_line;  // [bytes]
};

/// Carries out requests: one mesh, one index, one constraint of tips and one memory for all
/// clients, who are told apart by the side of their tips, and by the instruments and tools that
/// they open. Not thread-safe.
class Service {
 public:
  /// Throws Error where make_motion_constraint does.
  Service(std::shared_ptr<const Mesh> mesh, const ServiceSettings& settings);

  /// Appends the answer to a line, which is one line; none to a blank one. `client`: who
  /// asks. Returns how many steps the work was worth.
  std::size_t answer(const Line& line, Client& client, std::string& out);

  std::size_t longest_line() const noexcept { return longest_line_; }

 private:
  std::size_t carry_out(Client& client, std::string& out);
  MotionConstraint& constraint_of(Client& client) noexcept;
  Step step(Client& client, const Motion& motion) noexcept;
  void append_single_step(Client& client, std::string& out);
  void append_batch(Client& client, std::string& out);

  std::shared_ptr<const Mesh> mesh_;
  std::shared_ptr<const SpatialIndex> index_;
  InstrumentConstraintSettings instrument_;  // what a client says nothing of
  MotionConstraintSettings settings_;        // the same, with room for the largest request
  MotionConstraint constraint_;
  std::size_t longest_line_;
  RequestLimits limits_;
  Request request_;               // in hand, or done
  TipJacobian::Matrix jacobian_;  // of a request: (3, most joints)
  std::string info_;              // members of an answer
  std::string statuses_;          // members of an answer
};

/// One client: what came from him in part, what is kept of him, and what he has not been sent yet.
/// Knows no file or socket. While answers are unsent no line is taken, so a client who does not
/// read takes up no more memory than one turn's answers.
class Session {
 public:
  /// `service` must outlive it.
  explicit Session(Service& service);

  // What the client sends: see LineReader.
  std::span<char> room() noexcept { return lines_.room(); }
  void added(std::size_t count) noexcept { lines_.added(count), may_have_line_ = true; }
  void ended() noexcept { lines_.ended(), may_have_line_ = has_ended_ = true; }

  /// Answers lines that are there, up to some work's worth, so that other clients have their turn.
  void take_turn();

  /// Whether another turn would get somewhere, without more bytes.
  bool has_work() const noexcept { return may_have_line_ && unsent().empty(); }

  /// Whether there is use in more bytes. Precondition of room().
  bool wants_bytes() const noexcept { return !may_have_line_ && !has_ended_ && unsent().empty(); }

  std::string_view unsent() const noexcept { return std::string_view(out_).substr(sent_); }
  void sent(std::size_t count) noexcept;

  /// Nothing will come of it any more.
  bool is_done() const noexcept { return has_ended_ && !may_have_line_ && unsent().empty(); }

 private:
  Service& service_;
  LineReader lines_;
  Client client_;
  std::string out_;
  std::size_t sent_ = 0;  // bytes of out_
  bool may_have_line_ = false;
  bool has_ended_ = false;
};

}  // namespace keepout::app
