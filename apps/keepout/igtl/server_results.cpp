// SPDX-License-Identifier: BSD-3-Clause
// The part of Server that runs the tool and sends.
#include <algorithm>
#include <chrono>
#include <exception>

#include "igtl/polydata.h"
#include "igtl/server.h"
#include "keepout/error.h"
#include "keepout/geometry/closest_point.h"
#include "shared/number_text.h"

namespace keepout::app::igtl {
namespace {

constexpr double state_period = 1.0;             // the state is sent at least this often [s]
constexpr double triangles_period = 1.0 / 30.0;  // triangles are sent at most this often [s]

/// Returns the code that describes a status best.
StatusCode code_of(CycleStatus status) noexcept {
  switch (status) {
    case CycleStatus::guarded:
      return StatusCode::ok;
    case CycleStatus::not_engaged:
      return StatusCode::disabled;
    case CycleStatus::stale:
      return StatusCode::time_out;
    case CycleStatus::contested:
      return StatusCode::access_denied;
    case CycleStatus::too_far:
    case CycleStatus::far_from_mesh:
      return StatusCode::overflow;
    case CycleStatus::invalid_pose:
    case CycleStatus::other_frame:
      return StatusCode::config_error;
    default:
      return StatusCode::not_ready;
  }
}

}  // namespace

void Server::tick(const Moment& moment) {
  exchange_mesh(moment);
  session_.tick(moment.now);
  for (auto& client : clients_) {
    client->flush();
    if (!client->is_open() && client.get() == controller_) end(*client);
  }
  send_transform(moment);
  send_triangles(moment);
  send_state(moment);
}

/// A mesh is prepared only while the tool is released, and the tool does not engage meanwhile.
void Server::exchange_mesh(const Moment& moment) {
  if (!next_mesh_.valid() ||
      next_mesh_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) {
    return;
  }
  try {
    IndexedMesh next = next_mesh_.get();
    session_.set_mesh(next.mesh, next.index);
    mesh_ = std::move(next.mesh);
    index_ = std::move(next.index);
    shown_.clear();
    note(StatusCode::ok, "mesh",
         "the tool is guarded from a new mesh: " + counted(mesh_->triangle_count(), "triangle") +
             next.warning,
         moment);
  } catch (const std::exception& error) {  // Error, or out of memory
    ++counts_.refused;
    note(StatusCode::config_error, "no_mesh",
         "the mesh was refused, and the last one stays: " + std::string(error.what()), moment);
  }
}

void Server::send_transform(const Moment& moment) {
  if (!session_.setpoint_cp()) return;
  message_.clear();
  write_transform(message_, "GuardedTool", moment.unix, *session_.setpoint_cp());
  send_to_all(Outgoing::frame);
}

/// The active triangles are those that the tool could come too close to in the next cycle.
void Server::send_triangles(const Moment& moment) {
  if (moment.now < triangles_due_) return;
  triangles_due_ = moment.now + triangles_period;
  active_.clear();
  if (session_.engaged()) {
    const HapticOptions& haptic = session_.tip()->options();
    const Ball reach{session_.cycle().proxy, required_clearance(options_.constraint.options) +
                                                 haptic.top_speed / options_.rate};
    near_.clear();
    index_->collect(reach, near_);
    for (const TriangleId t : near_.view()) {
      if (active_.size() == most_shown) break;
      if (closest_point(mesh_->triangle(t), reach.center).distance <= reach.radius) {
        active_.push_back(t);
      }
    }
    std::ranges::sort(active_);
  }
  if (active_ == shown_) return;
  drawn_.clear();
  for (const TriangleId t : active_) drawn_.push_back(mesh_->triangle(t));
  message_.clear();
  write_polydata(message_, "ActiveTriangles", moment.unix, drawn_);
  send_to_all(Outgoing::frame);
  std::swap(active_, shown_);
}

void Server::send_state(const Moment& moment) {
  const CycleStatus status = session_.cycle().status;
  const std::string_view reason =
      status == CycleStatus::not_engaged && !cause_.empty() ? cause_ : session_.reason();
  const bool has_changed = status != sent_status_ || reason != sent_reason_;
  if (!has_changed && moment.now < state_due_) return;
  state_due_ = moment.now + state_period;
  sent_status_ = status;
  sent_reason_ = reason;
  message_.clear();
  write_status(message_, "Keepout", moment.unix, code_of(status), counts_.refused, name(status),
               reason);
  send_to_all(Outgoing::note);
}

void Server::note(StatusCode code, std::string_view name, std::string_view text,
                  const Moment& moment) {
  message_.clear();
  write_status(message_, "KeepoutNote", moment.unix, code, counts_.refused, name, text);
  send_to_all(Outgoing::note);
}

void Server::send_to_all(Outgoing kind) {
  for (auto& client : clients_) {
    if (client->is_open() && !client->send(message_, kind)) ++counts_.dropped;
  }
}

}  // namespace keepout::app::igtl
