// SPDX-License-Identifier: BSD-3-Clause
#include "serve/serve.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
#include <cstdlib>
#include <cstring>
#include <list>
#include <ostream>
#include <string>
#include <vector>

#include "keepout/error.h"
#include "serve/answer.h"
#include "serve/service.h"
#include "serve/unix_socket.h"
#include "shared/named_mesh.h"
#include "shared/number_text.h"
#include "shared/progress.h"
#include "shared/stop_signal.h"

namespace keepout::app {
namespace {

constexpr short gone = POLLERR | POLLHUP | POLLNVAL;
constexpr int for_ever = -1;

bool is_passing(int error) { return error == EINTR || error == EAGAIN || error == EWOULDBLOCK; }

/// A session, and the open files that its bytes come from and go to. Never waits.
class Connection {
 public:
  enum class Kind : std::uint8_t {
    files,  // such as stdin and stdout: they stay open, and blocking, since others may share them
    socket  // one socket for both, which is closed at the end
  };
  Connection(Service& service, int in, int out, Kind kind)
      : session_(service), in_(in), out_(out), kind_(kind) {}
  ~Connection() {
    if (kind_ == Kind::socket) ::close(in_);
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// What to wait for: bytes, if any are wanted; and a reader who has gone, or, if there is
  /// something unsent, room.
  std::array<pollfd, 2> awaited() const noexcept {
    const bool has_unsent = !session_.unsent().empty();
    return {{{session_.wants_bytes() ? in_ : -1, POLLIN, 0},
             {out_, static_cast<short>(has_unsent ? POLLOUT : 0), 0}}};
  }

  /// One turn, after what was waited for: receives what there is, answers, sends what can be sent.
  void serve(const pollfd* happened) {
    has_gone_ = (happened[1].revents & gone) != 0;
    if (!has_gone_ && happened[0].revents != 0) receive();
    if (has_gone_) return;
    if (session_.has_work()) session_.take_turn();
    if (!session_.unsent().empty()) send();
  }

  bool has_work() const noexcept { return session_.has_work(); }
  bool is_done() const noexcept { return has_gone_ || session_.is_done(); }

  /// What went wrong with the files; empty if nothing did, or if the client just left.
  const std::string& trouble() const noexcept { return trouble_; }

 private:
  void receive() {
    const std::span<char> room = session_.room();
    const ssize_t count = kind_ == Kind::socket
                              ? ::recv(in_, room.data(), room.size(), MSG_DONTWAIT)
                              : ::read(in_, room.data(), room.size());
    if (count > 0) {
      session_.added(static_cast<std::size_t>(count));
    } else if (count == 0) {
      session_.ended();
    } else {
      note_failure("stdin: ");
    }
  }

  void send() {
    const std::string_view text = session_.unsent();
    pollfd file{out_, POLLOUT, 0};
    if (kind_ == Kind::files && ::poll(&file, 1, 0) != 1) return;  // it would wait for room
    // A pipe that has room takes as much as PIPE_BUF without waiting.
    const ssize_t count =
        kind_ == Kind::socket
            ? ::send(out_, text.data(), text.size(), MSG_DONTWAIT | MSG_NOSIGNAL)
            : ::write(out_, text.data(), std::min<std::size_t>(text.size(), PIPE_BUF));
    if (count >= 0) {
      session_.sent(static_cast<std::size_t>(count));
    } else {
      note_failure("stdout: ");
    }
  }

  void note_failure(const char* file) {
    if (is_passing(errno)) return;
    has_gone_ = true;
    if (kind_ == Kind::files && errno != EPIPE) trouble_ = file + std::string(std::strerror(errno));
  }

  Session session_;
  int in_;
  int out_;
  Kind kind_;
  bool has_gone_ = false;  // nobody will read an answer
  std::string trouble_;
};

void turn_away(int client, std::size_t most_clients) {
  std::string out;
  append_error(out, "null", "too_many_clients",
               "there are " + std::to_string(most_clients) +
                   " clients already: close one, or start with a larger --max-clients");
  // A new socket has room for it.
  [[maybe_unused]] const ssize_t sent =
      ::send(client, out.data(), out.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  ::close(client);
}

/// Serves clients in turn until `stop`: of a socket, one more than `most_clients` at a time is told
/// so, and left; without a socket the one client of stdin and stdout, until he ends. Returns what
/// went wrong with these.
std::string serve_clients(Service& service, const StopSignal& stop, UnixSocket* socket,
                          std::size_t most_clients) {
  std::list<Connection> clients;
  if (socket == nullptr) {
    clients.emplace_back(service, STDIN_FILENO, STDOUT_FILENO, Connection::Kind::files);
  }
  std::vector<pollfd> files;  // the same memory each time
  bool is_out_of_files = false;
  while (true) {
    // Without room for another open file, the door is tried again from time to time.
    const int door = socket == nullptr || is_out_of_files ? -1 : socket->file();
    int patience = is_out_of_files ? 100 : for_ever;  // [ms]
    files.assign({{stop.file(), POLLIN, 0}, {door, POLLIN, 0}});
    for (const Connection& client : clients) {
      if (client.has_work()) patience = 0;
      for (const pollfd& file : client.awaited()) files.push_back(file);
    }
    if (::poll(files.data(), files.size(), patience) < 0) {
      for (pollfd& file : files) file.revents = 0;  // interrupted
    }
    if (files[0].revents != 0) return {};
    const pollfd* happened = &files[2];
    for (Connection& client : clients) {
      client.serve(happened);
      happened += 2;
    }
    if (socket == nullptr && clients.front().is_done()) return clients.front().trouble();
    clients.remove_if([](const Connection& client) { return client.is_done(); });
    if (!is_out_of_files && files[1].revents == 0) continue;
    for (int i = 0; i < 8; ++i) {  // at a time, so that nobody who is in waits for long
      const int client = socket->accept(is_out_of_files);
      if (client < 0) break;
      if (clients.size() < most_clients) {
        clients.emplace_back(service, client, client, Connection::Kind::socket);
      } else {
        turn_away(client, most_clients);
      }
    }
  }
}

/// Otherwise the next file that is opened would be taken for it.
void require_stdio() {
  for (const int file : {STDIN_FILENO, STDOUT_FILENO}) {
    if (::fcntl(file, F_GETFD) < 0) {
      throw Error(
          "stdin or stdout is closed: 'keepout serve' reads requests from the one and answers on "
          "the other; connect both, or give --socket");
    }
  }
}

}  // namespace

int serve(const ServeOptions& options, std::ostream& log) {
  if (!options.socket) require_stdio();
  const LoadedMesh loaded = load_named_mesh(options.service.mesh, options.load);
  ServiceSettings settings = options.service;
  settings.constraint.warn = warn_on_stderr;
  settings.space = loaded.space;
  Service service(loaded.mesh, settings);
  const StopSignal stop;
  ::signal(SIGPIPE, SIG_IGN);  // a client who has gone is an error of write() alone
  std::optional<UnixSocket> socket;
  if (options.socket) socket.emplace(*options.socket);
  log << "keepout: serving " << options.service.mesh.string() << " ("
      << counted(loaded.mesh->triangle_count(), "triangle") << ") on "
      << (socket ? options.socket->string() : "stdin and stdout") << std::endl;
  const std::string trouble =
      serve_clients(service, stop, socket ? &*socket : nullptr, options.most_clients);
  if (trouble.empty()) return EXIT_SUCCESS;
  log << "keepout: " << trouble << '\n';
  return EXIT_FAILURE;
}

std::string protocol_help() {
  std::string options;
  for (const auto& option : instrument_options) {
    options += (options.empty() ? "" : ", ") + std::string(option.name);
  }
  return R"(One JSON object a line, answered in order by one line with the same id. Lengths in mm, in the
frame of the mesh. Lines for people go to stderr.

  {"id":1,"do":"step","tip":[0,0,60],"desired":[0,0,-0.5]}
  {"id":1,"ok":true,"status":"free","motion":[0,0,-0.5],"triangles":0,"planes":0,"distance":10}

step      tip, desired: the motion that the tip may make instead of the desired one; zero unless ok.
          'distance' is that of the tip from the surface, before it.
          With jacobian, three rows of n numbers: 'increment' is that of the joints.
          With rows and bounds: rows . u >= bounds holds for the increment u.
steps     motions, an array of [px,py,pz,dx,dy,dz]: as many steps, answered as "steps".
polytope  tip, radius: normals and offsets of the free space around it, normal . d >= offset.
instrument  urdf, a file, and capsules, arrays of [link,x,y,z,link,x,y,z,radius]: opens an
          instrument of this client's. Its options: )" +
         options + R"(.
joint_step  q, and linear and angular of its flange, or an increment: the increment of the joints.
tool      tool, as --tool takes it, and narrow_phase: from now on this client's steps guard it.
guides    guides, texts as --guide of 'keepout replay' takes them, of this client's tip; or with of,
          "instrument", of his instrument: see docs/guides.md.
anatomy   file, and margin: one more mesh that his instrument is kept out of.
place     mesh, its number, frame, and linear and angular: where it is, and how it moves.
info      version, mesh, settings and limits.
statuses  all statuses by name, each with its reason.
ping      whether it is there.

A line that cannot be carried out is answered, moves nothing and ends nothing:

  {"id":2,"error":{"kind":"not_a_request","message":"'tip' must be an array of three numbers"}}

kinds: line_too_long, not_json, not_a_request, no_instrument, no_tool, no_guide,
       no_anatomy, too_many_clients.
All of it: docs/serve.md
)";
}

}  // namespace keepout::app
