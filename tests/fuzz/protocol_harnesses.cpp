// SPDX-License-Identifier: BSD-3-Clause
// Bytes of clients: lines of `keepout serve`, and messages of OpenIGTLink.
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "fuzz/harness.h"
#include "igtl/bodies.h"
#include "igtl/polydata.h"
#include "igtl/server.h"
#include "igtl/stream.h"
#include "keepout/fixtures/shapes.h"
#include "serve/service.h"

namespace keepout::fuzz {
namespace {

std::shared_ptr<const Mesh> cube() {
  static const auto mesh = std::make_shared<const Mesh>(make_cube(50.0));
  return mesh;
}

/// Returns the answers to a client that sends its bytes in pieces of this length.
std::string answers(app::Service& service, std::string_view sent, std::size_t piece) {
  app::Client client{service};
  std::string received, all;
  for (std::size_t at = 0; at < sent.size();) {
    const std::size_t room = app::most_received(service) - received.size();
    require(room > 0, "a client may always send more");
    const std::string_view part = sent.substr(at, std::min(piece, room));
    at += part.size();
    received += part;
    for (std::size_t done = 1; done > 0; received.erase(0, done)) {
      std::string turn;
      done = app::take_turn(client, received, turn);
      require(done <= received.size(), "a turn uses only received bytes");
      all += turn;
    }
  }
  return all;
}

std::string_view without_blanks(std::string_view line) {
  while (line.ends_with('\r') || line.ends_with(' ') || line.ends_with('\t')) {
    line.remove_suffix(1);
  }
  while (line.starts_with('\r') || line.starts_with(' ') || line.starts_with('\t')) {
    line.remove_prefix(1);
  }
  return line;
}

void read_lines(Bytes bytes) {
  static app::Service service = [] {
    app::ServiceSettings settings;
    settings.constraint.options.damping = 1e-3;
    settings.limits = {.joints = 7, .rows = 4, .motions = 8};
    settings.longest_line = 2000;
    return app::Service(cube(), settings);
  }();
  const std::string sent = std::string(text_of(bytes)) + "\n";
  const std::string all = answers(service, sent, sent.size());
  std::size_t lines = 0;
  for (std::string_view rest = sent; !rest.empty();) {
    const std::size_t end = rest.find('\n');
    const bool is_too_long = end > service.longest_line + 1;
    lines += is_too_long || !without_blanks(rest.substr(0, end)).empty() ? 1 : 0;
    rest.remove_prefix(end + 1);
  }
  require(static_cast<std::size_t>(std::ranges::count(all, '\n')) == lines,
          "each line has one answer");
  for (std::string_view rest = all; !rest.empty();) {
    const std::size_t end = rest.find('\n');
    const auto answer = nlohmann::json::parse(rest.substr(0, end), nullptr, false);
    require(answer.is_object() && answer.contains("id"), "an answer is JSON with an id");
    rest.remove_prefix(end + 1);
  }
  require(answers(service, sent, 1 + bytes.size() / 7) == all,
          "answers do not depend on how the bytes arrive");
}

namespace igtl = app::igtl;

constexpr std::array<std::string_view, 6> types{"TRANSFORM", "STRING",     "POINT",
                                                "POLYDATA",  "GET_STATUS", "OTHER"};
constexpr std::array<std::string_view, 4> devices{"Tool", "Measured", "Model", "Command"};

/// Returns messages whose headers are valid, except for some: a type, a device and a body each.
igtl::ByteList messages(Source& source) {
  igtl::ByteList sent;
  while (!source.is_empty()) {
    const std::size_t begin = sent.size();
    const std::size_t kind = source.below(2 * types.size());
    const bool is_valid = !source.once_in(8);
    igtl::Writer writer(sent, types[kind % types.size()], devices[source.below(devices.size())],
                        0.0);
    const std::size_t size = std::min<std::size_t>(source.byte(), source.rest().size());
    if (kind == 1) {  // the commands that a server takes
      constexpr std::array<std::string_view, 3> commands{"engage", "release", "register"};
      const std::string_view command = commands[size % commands.size()];
      writer.number(std::uint16_t{3});
      writer.number(static_cast<std::uint16_t>(command.size()));
      writer.text(command);
    } else {
      for (std::size_t i = 0; i < size; ++i) writer.number(source.byte());
    }
    writer.finish();
    if (is_valid) continue;
    // The version, a length or the checksum of the header is wrong.
    sent[begin + source.below(igtl::header_size)] = source.byte();
  }
  return sent;
}

/// Returns the events of a stream, and the bodies of its messages, as bytes.
igtl::ByteList events(igtl::Bytes sent, std::size_t piece) {
  igtl::MessageStream stream(1000);
  igtl::ByteList all;
  while (!sent.empty()) {
    igtl::Bytes part = sent.first(std::min(piece, sent.size()));
    sent = sent.subspan(part.size());
    while (true) {
      const auto event = stream.next(part);
      if (event == igtl::MessageStream::Event::needs_more) break;
      all.push_back(static_cast<std::uint8_t>(event));
      if (event == igtl::MessageStream::Event::broken) return all;
      if (event == igtl::MessageStream::Event::header) stream.store_body();
      if (event != igtl::MessageStream::Event::message) continue;
      all.push_back(stream.is_intact() ? 1 : 0);
      all.insert(all.end(), stream.body().begin(), stream.body().end());
    }
  }
  return all;
}

void read_messages(Bytes bytes) {
  for (const std::uint16_t version : {std::uint16_t{1}, std::uint16_t{2}}) {
    const auto content = igtl::content_of({.version = version}, bytes);
    if (!content) continue;
    igtl::read_transform(*content);
    igtl::read_string(*content);
    igtl::read_points(*content);
    ignore_errors([&] {
      const Surface surface = igtl::read_polydata(*content);
      require(!surface.triangles.empty(), "a mesh has a triangle");
      for (const Corners& corners : surface.triangles) {
        require(std::ranges::max(corners) < surface.vertices.size(), "corners exist");
      }
    });
  }
  Source source(bytes);
  const igtl::ByteList sent =
      source.once_in(2) ? messages(source) : igtl::ByteList(bytes.begin(), bytes.end());
  require(events(sent, sent.size()) == events(sent, 1 + sent.size() / 5),
          "messages do not depend on how the bytes arrive");
}

/// A socket that is connected to a server on this machine.
class Peer {
 public:
  explicit Peer(std::uint16_t port) : file_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in to = {};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    require(::connect(file_, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0,
            "the server accepts a client");
    const linger at_once{.l_onoff = 1, .l_linger = 0};  // no port waits after the end
    ::setsockopt(file_, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
  }
  ~Peer() { ::close(file_); }
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  void send(igtl::Bytes bytes) { ::send(file_, bytes.data(), bytes.size(), MSG_NOSIGNAL); }

 private:
  int file_;
};

/// A tool moves under the commands of a client, and never comes too close.
void run_server(Bytes bytes) {
  Source source(bytes);
  igtl::ServerOptions options;
  options.port = 0;
  options.longest_body = 4096;
  options.stamps = igtl::Stamps::ignored;
  igtl::Server server(options, cube());
  Peer peer(server.port());
  const igtl::ByteList sent = messages(source);
  igtl::Moment moment{.now = 1.0, .unix = 1e9};
  for (std::size_t at = 0; at < sent.size();) {
    const igtl::Bytes part =
        igtl::Bytes(sent).subspan(at, std::min<std::size_t>(512, sent.size() - at));
    at += part.size();
    peer.send(part);
    server.receive(moment);
    server.tick(moment);
    moment.now += 1e-3;
    moment.unix += 1e-3;
  }
  for (int i = 0; i < 3; ++i) {
    server.receive(moment);
    server.tick(moment);
  }
}

}  // namespace

std::span<const Harness> protocol_harnesses() noexcept {
  static constexpr Harness all[] = {
      {"serve", "apps/keepout/serve", read_lines},
      {"igtl",
       "apps/keepout/igtl/bodies.cpp apps/keepout/igtl/message.cpp apps/keepout/igtl/polydata.cpp "
       "apps/keepout/igtl/stream.cpp apps/keepout/igtl/stream.h",
       read_messages},
      {"igtl_server", "apps/keepout/igtl/server.cpp apps/keepout/igtl/connection.cpp", run_server},
  };
  return all;
}

}  // namespace keepout::fuzz
