// SPDX-License-Identifier: BSD-3-Clause
#include "igtl/server.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <utility>

#include "igtl/polydata.h"
#include "keepout/control/rigid_fit.h"
#include "keepout/error.h"
#include "keepout/mesh/diagnostics.h"
#include "shared/names.h"
#include "shared/number_text.h"

namespace keepout::app::igtl {
namespace {

constexpr std::size_t read_of_controller = std::size_t{1} << 15;  // in a cycle [bytes]
constexpr std::size_t read_of_others = std::size_t{1} << 12;      // in a cycle [bytes]
constexpr std::size_t longest_metadata = 4096;                    // of a small message [bytes]

Registration in_the_mesh() {
  return Registration::mesh_from_robot(Eigen::Matrix4d::Identity(),
                                       {.transform = LengthUnit::millimetre,
                                        .robot = LengthUnit::millimetre,
                                        .mesh = LengthUnit::millimetre});
}

CrtkOptions session_options(const ServerOptions& options) {
  CrtkOptions session;
  session.haptic.period = 1.0 / options.rate;
  session.haptic.fade = std::max(session.haptic.fade, session.haptic.period);
  session.haptic.guides = options.guides;
  session.longest_silence = options.longest_silence;
  session.frame = options.device;
  session.needs_feedback = false;
  return session;
}

/// Returns the largest content of a type that is stored; 0 for a type that the server does not
/// take. [bytes]
std::size_t longest_content(std::string_view type, std::size_t longest_body) {
  if (type == "TRANSFORM") return transform_size;
  if (type == "STRING") return longest_string;
  if (type == "POINT") return point_size * most_points;
  return type == "POLYDATA" ? longest_body : 0;
}

/// Returns true for messages that Slicer and the library send by themselves, and that need no
/// answer.
bool is_ignored(std::string_view type) {
  return type == "STATUS" || type == "CAPABILITY" || type.starts_with("GET_") ||
         type.starts_with("STT_") || type.starts_with("STP_") || type.starts_with("RTS_");
}

/// Returns the text without spaces and zeros at its ends.
std::string_view trimmed_command(std::string_view text) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\0'; };
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

/// Returns a socket that listens. Throws Error.
int listening_socket(const std::string& address, std::uint16_t port) {
  sockaddr_in to = {};
  to.sin_family = AF_INET;
  to.sin_port = htons(port);
  if (::inet_pton(AF_INET, address.c_str(), &to.sin_addr) != 1) {
    throw Error("--address " + in_quotes(address) +
                ": expected the IPv4 address of this machine, such as 127.0.0.1");
  }
  const int file = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  const int one = 1;
  // Without much memory for received bytes, a flood cannot delay a goal by many cycles.
  const int room = 1 << 17;
  ::setsockopt(file, SOL_SOCKET, SO_REUSEADDR, &one, sizeof one);
  ::setsockopt(file, SOL_SOCKET, SO_RCVBUF, &room, sizeof room);
  if (file < 0 || ::bind(file, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0 ||
      ::listen(file, 64) != 0) {
    const int why = errno;
    if (file >= 0) ::close(file);
    throw Error("cannot listen at " + address + ":" + std::to_string(port) + ": " +
                std::strerror(why) +
                (why == EADDRINUSE ? "; end the other server, or take another --port" : ""));
  }
  return file;
}

std::uint16_t port_of(int file) {
  sockaddr_in at = {};
  socklen_t size = sizeof at;
  ::getsockname(file, reinterpret_cast<sockaddr*>(&at), &size);
  return ntohs(at.sin_port);
}

}  // namespace

Server::Server(const ServerOptions& options, std::shared_ptr<const Mesh> mesh)
    : options_(options),
      mesh_(std::move(mesh)),
      index_(make_or_load_index(mesh_, options.constraint)),
      session_(make_motion_constraint(mesh_, index_, options.constraint), in_the_mesh(),
               session_options(options)),
      near_(most_candidates) {
  options_.constraint.warn = {};  // indices of later meshes are built on another thread
  for (auto& client : clients_) client = std::make_unique<Connection>(options.longest_body);
  message_.reserve(std::size_t{1} << 16);
  for (auto* list : {&shown_, &active_}) list->reserve(most_shown);
  drawn_.reserve(most_shown);
  door_ = listening_socket(options.address, options.port);
  port_ = port_of(door_);
}

Server::~Server() {
  note(StatusCode::shut_down, "shut_down", "the server ends", {});
  ::close(door_);
}

void Server::receive(const Moment& moment) {
  accept_clients();
  for (auto& client : clients_) {
    client->was_refused = false;
    if (!client->is_open()) continue;
    const bool controls = client.get() == controller_ || controller_ == nullptr;
    receive_from(*client, controls ? read_of_controller : read_of_others, moment);
  }
}

void Server::accept_clients() {
  while (true) {
    const int file = ::accept4(door_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (file < 0) return;
    const auto free = std::ranges::find_if(clients_, [](auto& one) { return !one->is_open(); });
    if (free == clients_.end()) {
      ::close(file);
      continue;
    }
    (*free)->open(file);
    state_due_ = 0.0;  // the new client gets the state, too
  }
}

void Server::receive_from(Connection& client, std::size_t most, const Moment& moment) {
  Bytes received = client.receive(most);
  if (!client.is_open()) return end(client);
  while (true) {
    switch (client.stream.next(received)) {
      case MessageStream::Event::needs_more:
        return;
      case MessageStream::Event::header:
        judge_header(client, moment);
        break;
      case MessageStream::Event::message:
        ++counts_.messages;
        if (client.stream.is_stored()) take(client, moment);
        break;
      case MessageStream::Event::broken: {
        const bool is_known = client.stream.header().version <= newest_version;
        refuse(client,
               {is_known ? StatusCode::overflow : StatusCode::unknown_version,
                is_known ? "too_long" : "unknown_version",
                is_known ? "the declared body is longer than --max-body: the connection ends"
                         : "the header has another version, or is no header: the connection ends"},
               moment);
        return end(client);
      }
    }
  }
}

/// Stores the body of a message only if it is taken.
void Server::judge_header(Connection& client, const Moment& moment) {
  const Header& header = client.stream.header();
  const std::string_view type = header.type_name();
  const std::size_t longest = longest_content(type, options_.longest_body);
  if (longest == 0) {
    if (is_ignored(type)) return;
    return refuse(client,
                  {StatusCode::unknown_instruction, "unknown_type",
                   "the server takes TRANSFORM, STRING, POINT and POLYDATA only"},
                  moment);
  }
  if (header.body_size > longest + (header.version > 1 ? longest_metadata : 0)) {
    if (&client == controller_) session_.refuse(CycleStatus::invalid_pose);
    return refuse(client, {StatusCode::overflow, "too_long", "the body is too long for its type"},
                  moment);
  }
  if (type == "POLYDATA") {
    if (!takes_control(client, moment)) return;
    if (session_.engaged()) {
      return refuse(client,
                    {StatusCode::busy, "engaged",
                     "a mesh is exchanged only while the tool is released: send 'release' first"},
                    moment);
    }
    if (is_preparing()) {
      return refuse(
          client, {StatusCode::busy, "preparing", "the last mesh is still being prepared"}, moment);
    }
  }
  client.stream.store_body();
}

void Server::take(Connection& client, const Moment& moment) {
  const Header& header = client.stream.header();
  const bool controls = &client == controller_;
  if (!client.stream.is_intact()) {
    if (controls) session_.refuse(CycleStatus::invalid_pose);
    return refuse(client,
                  {StatusCode::checksum_error, "wrong_crc",
                   "the CRC is wrong: the message was damaged on its way, or the sender is faulty"},
                  moment);
  }
  const std::string_view type = header.type_name();
  if (type == "POLYDATA") {
    if (!takes_control(client, moment)) return;
    next_mesh_ = std::async(std::launch::async, prepared, header, client.stream.take_body(),
                            options_.constraint);
    return;
  }
  const std::optional<Bytes> content = content_of(header, client.stream.body());
  if (!content) {
    if (controls) session_.refuse(CycleStatus::invalid_pose);
    return refuse(client, {StatusCode::config_error, "wrong_size", "the extended header is wrong"},
                  moment);
  }
  if (type == "TRANSFORM") return take_transform(client, *content, moment);
  if (type == "STRING") return take_command(client, *content, moment);
  take_points(client, *content, moment);
}

void Server::take_transform(Connection& client, Bytes content, const Moment& moment) {
  if (!takes_control(client, moment)) return session_.refuse(CycleStatus::contested);
  const std::optional<Pose> pose = read_transform(content);
  if (!pose) {
    session_.refuse(CycleStatus::invalid_pose);
    return refuse(client, {StatusCode::config_error, "wrong_size", "a TRANSFORM has 48 bytes"},
                  moment);
  }
  const Header& header = client.stream.header();
  const bool has_stamp = options_.stamps == Stamps::checked && header.stamp > 0.0;
  const double age = has_stamp ? moment.unix - header.stamp : 0.0;
  if (!(std::abs(age) <= options_.longest_silence)) {
    session_.refuse(CycleStatus::stale);
    return refuse(client,
                  {StatusCode::time_out, "wrong_stamp",
                   "the time stamp is not within --silence of now: set it, or set it to 0, "
                   "synchronize the clocks, or start with --ignore-stamps"},
                  moment);
  }
  const MessageHeader sent{.stamp = moment.now - age, .frame = header.device_name()};
  session_.on_servo_cp(*pose, sent);
  if (!session_.engaged()) session_.on_setpoint_cp(*pose, sent);  // where the tool would engage
}

void Server::take_command(Connection& client, Bytes content, const Moment& moment) {
  const std::optional<std::string_view> text = read_string(content);
  const std::string_view command = text ? trimmed_command(*text) : std::string_view();
  if (command == "release") {  // any client may stop the tool
    session_.release();
    cause_ = "released by a client; send 'engage' to start";
    return;
  }
  if (!takes_control(client, moment)) return;
  if (command == "register") return fit_registration(client, moment);
  if (command != "engage") {
    return refuse(client,
                  {StatusCode::unknown_instruction, "unknown_command",
                   "the commands are 'engage', 'release' and 'register'"},
                  moment);
  }
  if (session_.engaged()) {  // the tool would jump to where it was engaged
    return refuse(client, {StatusCode::busy, "engaged", "the tool is engaged already"}, moment);
  }
  if (is_preparing()) {
    return refuse(
        client,
        {StatusCode::busy, "preparing", "a mesh is being prepared: engage after the note 'mesh'"},
        moment);
  }
  const CycleStatus status = session_.engage(moment.now);
  if (!is_ok(status)) {
    refuse(client, {StatusCode::not_ready, name(status), session_.reason()}, moment);
  } else {
    cause_ = {};
  }
}

void Server::take_points(Connection& client, Bytes content, const Moment& moment) {
  if (!takes_control(client, moment)) return;
  std::optional<std::vector<Vec3>> points = read_points(content);
  const std::string_view device = client.stream.header().device_name();
  if (!points) {
    return refuse(client,
                  {StatusCode::config_error, "wrong_size",
                   "a POINT message has 136 bytes for each of at most 1000 points"},
                  moment);
  }
  if (device != "Measured" && device != "Model") {
    return refuse(client,
                  {StatusCode::config_error, "unknown_list",
                   "name the list 'Measured' (frame of the tool) or 'Model' (frame of the mesh)"},
                  moment);
  }
  (device == "Model" ? model_ : measured_) = std::move(*points);
}

void Server::fit_registration(Connection& client, const Moment& moment) {
  if (session_.engaged()) {
    return refuse(
        client,
        {StatusCode::busy, "engaged", "the registration changes only while the tool is released"},
        moment);
  }
  try {
    const RigidFit fit = fit_rigid(std::exchange(measured_, {}), std::exchange(model_, {}));
    if (!fit.doubt.empty()) throw Error(fit.doubt);
    session_.set_registration(
        Registration::mesh_from_robot(fit.matrix(), {.transform = LengthUnit::millimetre,
                                                     .robot = LengthUnit::millimetre,
                                                     .mesh = LengthUnit::millimetre}));
    note(StatusCode::ok, "registered",
         counted(fit.residuals.size(), "pair") +
             formatted(", FRE %.3f mm: see docs/controllers.md for the margin", fit.fre),
         moment);
  } catch (const Error& error) {
    refuse(client, {StatusCode::config_error, "not_registered", error.what()}, moment);
  }
}

bool Server::takes_control(Connection& client, const Moment& moment) {
  if (controller_ == nullptr) controller_ = &client;
  if (controller_ == &client) return true;
  refuse(client,
         {StatusCode::access_denied, "other_controls",
          "another client controls the tool: this one may read, and send 'release'"},
         moment);
  return false;
}

void Server::end(Connection& client) noexcept {
  client.close();
  if (&client != controller_) return;
  controller_ = nullptr;
  session_.release();
  measured_.clear();
  model_.clear();
  cause_ = "the controlling client has left; connect, send the tool and 'engage'";
}

void Server::refuse(Connection& client, const Refusal& refusal, const Moment& moment) {
  ++counts_.refused;
  if (std::exchange(client.was_refused, true)) return;
  message_.clear();
  write_status(message_, "KeepoutNote", moment.unix, refusal.code, counts_.refused, refusal.name,
               refusal.text);
  if (!client.send(message_, Outgoing::note)) ++counts_.dropped;
}

Server::IndexedMesh Server::prepared(const Header& header, const ByteList& body,
                                     const MotionConstraintSettings& settings) {
  const std::optional<Bytes> content = content_of(header, body);
  if (!content) throw Error("POLYDATA: the extended header is wrong");
  const auto mesh = std::make_shared<const Mesh>(weld(read_polydata(*content)));
  IndexedMesh made{mesh, make_or_load_index(mesh, settings)};
  for (const std::string& warning : quick_check(*mesh)) made.warning += "; " + warning;
  return made;
}

}  // namespace keepout::app::igtl
