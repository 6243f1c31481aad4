// SPDX-License-Identifier: BSD-3-Clause
#include "serve/serve.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <asio/awaitable.hpp>
#include <asio/co_spawn.hpp>
#include <asio/io_context.hpp>
#include <asio/local/stream_protocol.hpp>
#include <asio/posix/stream_descriptor.hpp>
#include <asio/redirect_error.hpp>
#include <asio/steady_timer.hpp>
#include <asio/use_awaitable.hpp>
#include <asio/write.hpp>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <ostream>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "keepout/error.h"
#include "keepout/robot/instrument_options.h"
#include "serve/answer.h"
#include "shared/named_mesh.h"
#include "shared/names.h"
#include "shared/number_text.h"
#include "shared/progress.h"
#include "shared/stop_signal.h"

namespace keepout::app {
namespace {

using Descriptor = asio::posix::stream_descriptor;
using Local = asio::local::stream_protocol;
using std::filesystem::path;

std::error_code last_error() { return {errno, std::system_category()}; }

[[noreturn]] void fail(const path& socket, const std::string& why, std::error_code error = {}) {
  throw Error("--socket " + socket.string() + ": " + why + (error ? ": " + error.message() : ""));
}

/// Removes a socket without a listening server.
void make_way(asio::io_context& io, const path& file, const Local::endpoint& endpoint) {
  std::error_code error;
  const auto type = std::filesystem::symlink_status(file, error).type();
  // bind() reports every other fault.
  if (type == std::filesystem::file_type::none || type == std::filesystem::file_type::not_found) {
    return;
  }
  if (type != std::filesystem::file_type::socket) {
    fail(file, "something else than a socket is there: take another path, or remove it");
  }
  Local::socket probe(io, Local());
  probe.non_blocking(true);
  probe.connect(endpoint, error);
  if (!error || error == asio::error::try_again) {
    fail(file, "another server answers there: end it, or take another path");
  }
  if (error != asio::error::connection_refused) {
    fail(file, "cannot connect to the socket there", error);
  }
  std::filesystem::remove(file, error);
  if (error) fail(file, "cannot remove the socket of an earlier server", error);
}

/// A Unix socket that clients connect to. Its file exists as long as this object, with access for
/// its owner only (0600).
class UnixSocket {
 public:
  /// Replaces a socket that a terminated server has left. Throws Error if another server answers
  /// there, if the path is something else than a socket, if the path is too long, or if the file
  /// cannot be created.
  UnixSocket(asio::io_context& io, path file) : file_(std::move(file)), acceptor_(io) {
    constexpr std::size_t longest = sizeof(sockaddr_un::sun_path) - 1;
    if (file_.empty()) fail(file_, "give the path of a file");
    if (const std::size_t size = file_.native().size(); size > longest) {
      fail(file_, "the path has " + std::to_string(size) + " bytes; a Unix socket's has at most " +
                      std::to_string(longest) + ": take a shorter one, or a relative one");
    }
    const Local::endpoint endpoint(file_.native());
    const path folder = file_.has_parent_path() ? file_.parent_path() : ".";
    // Without this lock, two servers that start simultaneously might each remove the other's new
    // socket.
    const int folder_file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder_file < 0) {
      fail(file_, "its folder " + folder.string() + " cannot be used", last_error());
    }
    const Descriptor lock(io, folder_file);
    ::flock(folder_file, LOCK_EX);

    make_way(io, file_, endpoint);
    std::error_code error;
    acceptor_.open(endpoint.protocol(), error);
    // Set before the file exists, so that it is never open to others: Linux creates it with this
    // mode.
    ::fchmod(acceptor_.native_handle(), S_IRUSR | S_IWUSR);
    if (!error) acceptor_.bind(endpoint, error);
    if (error) fail(file_, "the socket cannot be made", error);
    const bool is_ours =
        ::chmod(file_.c_str(), S_IRUSR | S_IWUSR) == 0 && ::lstat(file_.c_str(), &made_) == 0;
    if (!is_ours) error = last_error();
    if (!error) acceptor_.listen(64, error);
    if (!error) return;
    ::unlink(file_.c_str());
    fail(file_, "cannot listen to the socket", error);
  }
  ~UnixSocket() {
    struct stat there = {};  // another process may have replaced the file
    if (::lstat(file_.c_str(), &there) == 0 && there.st_dev == made_.st_dev &&
        there.st_ino == made_.st_ino) {
      ::unlink(file_.c_str());
    }
  }

  Local::acceptor& acceptor() noexcept { return acceptor_; }

 private:
  path file_;
  struct stat made_ = {};
  Local::acceptor acceptor_;
};

void rethrow(const std::exception_ptr& failure) {
  if (failure) std::rethrow_exception(failure);
}

/// Serves a client until it leaves. Reads no line while answers are unsent, so that a client that
/// does not read uses no more memory than the answers of one turn. Returns the fault of the files;
/// empty if the client just left.
template <class In, class Out>
asio::awaitable<std::string> converse(Service& service, In& in, Out& out) {
  Client client{service};
  std::string answers;
  const std::size_t room = most_received(service);
  std::vector<char> received(room + 1);  // plus the end of the last line
  std::size_t size = 0;                  // of the received bytes
  std::error_code error;
  auto noting = asio::redirect_error(asio::use_awaitable, error);
  for (bool has_ended = false; !has_ended;) {
    size += co_await in.async_read_some(asio::buffer(received.data() + size, room - size), noting);
    has_ended = error == asio::error::eof;
    if (error && !has_ended) co_return "stdin: " + error.message();
    if (has_ended) received[size++] = '\n';
    std::string_view unread(received.data(), size);
    while (const std::size_t done = take_turn(client, unread, answers)) {
      unread.remove_prefix(done);
      // Other clients have their turn before async_write returns.
      co_await asio::async_write(out, asio::buffer(answers), noting);
      if (error) co_return error == asio::error::broken_pipe ? "" : "stdout: " + error.message();
      answers.clear();
    }
    size = unread.size();
    std::memmove(received.data(), unread.data(), size);
  }
  co_return "";
}

asio::awaitable<void> serve_socket(Service& service, Local::socket socket) {
  co_await converse(service, socket, socket);
}

/// Serves all clients of a socket, at most `most_clients` at a time; refuses others.
asio::awaitable<void> serve_clients(Service& service, Local::acceptor& door,
                                    std::size_t most_clients) {
  const auto executor = door.get_executor();
  std::size_t clients = 0;
  std::error_code error;
  while (true) {
    Local::socket client =
        co_await door.async_accept(asio::redirect_error(asio::use_awaitable, error));
    if (error) {  // most likely too many open files: try again after a pause
      asio::steady_timer pause(executor, std::chrono::milliseconds(100));
      co_await pause.async_wait(asio::use_awaitable);
    } else if (clients < most_clients) {
      ++clients;
      asio::co_spawn(executor, serve_socket(service, std::move(client)),
                     [&clients](const std::exception_ptr& failure) {
                       --clients;
                       rethrow(failure);
                     });
    } else {
      std::string out;
      append_error(out, "null", "too_many_clients",
                   "there are " + std::to_string(most_clients) +
                       " clients already: close one, or start with a larger --max-clients");
      client.write_some(asio::buffer(out), error);  // always fits into the buffer of a new socket
    }
  }
}

/// Returns stdin or stdout for Asio, which makes a file non-blocking. Opens the file anew if
/// possible, since other processes may share it.
int own_file(int file, int mode) {
  struct stat status = {};
  if (::fstat(file, &status) == 0 && (S_ISFIFO(status.st_mode) || S_ISCHR(status.st_mode))) {
    const std::string name = "/proc/self/fd/" + std::to_string(file);
    const int own = ::open(name.c_str(), mode | O_CLOEXEC | O_NOCTTY | O_NONBLOCK);
    if (own >= 0) return own;
  }
  return ::fcntl(file, F_DUPFD_CLOEXEC, 0);
}

/// Throws Error if stdin cannot be read or stdout cannot be written, as if they were closed (see
/// run_program).
void require_stdio() {
  for (const auto& [file, useless] :
       {std::pair(STDIN_FILENO, O_WRONLY), std::pair(STDOUT_FILENO, O_RDONLY)}) {
    if ((::fcntl(file, F_GETFL) & O_ACCMODE) == useless) {
      throw Error(
          "stdin or stdout is closed: 'keepout serve' reads requests from the one and answers on "
          "the other; connect both, or give --socket");
    }
  }
}

/// Serves the one client of stdin and stdout. Returns their fault, or an empty text.
std::string serve_stdio(Service& service, asio::io_context& io) {
  const int flags[] = {::fcntl(STDIN_FILENO, F_GETFL), ::fcntl(STDOUT_FILENO, F_GETFL)};
  Descriptor in(io, own_file(STDIN_FILENO, O_RDONLY));
  Descriptor out(io, own_file(STDOUT_FILENO, O_WRONLY));
  out.async_wait(Descriptor::wait_error, [&](std::error_code error) {
    if (!error) io.stop();  // the reader has ended
  });
  std::string trouble;
  asio::co_spawn(io, converse(service, in, out),
                 [&](const std::exception_ptr& failure, std::string text) {
                   rethrow(failure);
                   trouble = std::move(text);
                   io.stop();
                 });
  io.run();
  ::fcntl(STDIN_FILENO, F_SETFL, flags[0]);
  ::fcntl(STDOUT_FILENO, F_SETFL, flags[1]);
  return trouble;
}

}  // namespace

int serve(const ServeOptions& options, std::ostream& log) {
  if (!options.socket) require_stdio();
  const LoadedMesh loaded = load_named_mesh(options.service.mesh, options.load);
  ServiceSettings settings = options.service;
  settings.constraint.warn = warn_on_stderr;
  settings.space = loaded.space;
  settings.notices = loaded.notices;
  Service service(loaded.mesh, settings);
  const StopSignal stop;
  ::signal(SIGPIPE, SIG_IGN);  // makes a lost client an error of write() only
  asio::io_context io(1);
  Descriptor stopped(io, ::dup(stop.file()));
  stopped.async_wait(Descriptor::wait_read, [&](std::error_code) { io.stop(); });
  std::optional<UnixSocket> socket;
  if (options.socket) socket.emplace(io, *options.socket);
  std::ostream nowhere(nullptr);
  (is_quiet() ? nowhere : log) << "keepout: serving " << options.service.mesh.string() << " ("
                               << counted(loaded.mesh->triangle_count(), "triangle") << ") on "
                               << (socket ? options.socket->string() : "stdin and stdout")
                               << std::endl;
  if (!socket) {
    const std::string trouble = serve_stdio(service, io);
    if (!trouble.empty()) log << "keepout: " << trouble << '\n';
    return trouble.empty() ? EXIT_SUCCESS : EXIT_FAILURE;
  }
  asio::co_spawn(io, serve_clients(service, socket->acceptor(), options.most_clients), rethrow);
  io.run();
  return EXIT_SUCCESS;
}

std::string protocol_help() {
  return R"(One JSON object a line, answered in order by one line with the same id. Lengths in mm, in the
frame of the mesh. Lines for people go to stderr.

  {"id":1,"do":"step","tip":[0,0,60],"desired":[0,0,-0.5]}
  {"id":1,"ok":true,"status":"free","motion":[0,0,-0.5],"triangles":0,"planes":0,"distance":10}

step      tip, desired: the motion that the tip may execute instead of the desired one; zero unless
          ok. 'distance' is the distance of the tip from the surface before the motion.
          With jacobian, three rows of n numbers: 'increment' is the increment of the joints.
          With rows and bounds: rows . u >= bounds holds for the increment u.
steps     motions, an array of [px,py,pz,dx,dy,dz]: as many steps, answered as "steps".
polytope  tip, radius: normals and offsets of the free space around it, normal . d >= offset.
instrument  urdf, a file, and bodies, a file, or capsules, arrays of
          [link,x,y,z,link,x,y,z,radius], or neither: opens an instrument for this client. Files:
          docs/robots.md
          Its options: index, solver, )" +
         enumerated(names(instrument_options)) + R"(.
joint_step  q, and linear and angular of the flange, or an increment: the increment of the joints.
tool      tool, as for --tool, and narrow_phase: from now on this client's steps guard this tool.
guides    guides, texts as for --guide of 'keepout replay', for this client's tip; or, with of
          "instrument", for its instrument: see docs/guides.md.
anatomy   file, and margin: another mesh for this client's instrument; unit or scale, flip, space
          and untagged as for the mesh of the command.
place     mesh, its number, frame, and linear and angular: the pose and the velocity of the mesh.
info      version, mesh, settings and limits.
statuses  all statuses by name, each with its reason.
ping      tests the connection.

A line that cannot be carried out gets an answer, and has no other effect:

  {"id":2,"error":{"kind":"not_a_request","message":"'tip' must be an array of three numbers"}}

kinds: line_too_long, not_json, not_a_request, no_instrument, no_tool, no_guide,
       no_anatomy, too_many_clients.
All of it: docs/serve.md
)";
}

}  // namespace keepout::app
