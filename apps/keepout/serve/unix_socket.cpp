// SPDX-License-Identifier: BSD-3-Clause
#include "serve/unix_socket.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include "keepout/error.h"

namespace keepout::app {
namespace {

constexpr int waiting_clients = 64;  // at most, until they are accepted

/// An open file that closes itself, unless it is let go.
class OpenFile {
 public:
  explicit OpenFile(int file) noexcept : file_(file) {}
  ~OpenFile() {
    if (file_ >= 0) ::close(file_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  int get() const noexcept { return file_; }
  int let_go() noexcept { return std::exchange(file_, -1); }

 private:
  int file_;
};

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& why) {
  throw Error("--socket " + path.string() + ": " + why);
}

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& why, int error) {
  fail(path, why + ": " + std::strerror(error));
}

sockaddr_un address_of(const std::filesystem::path& path) {
  sockaddr_un address = {};
  address.sun_family = AF_UNIX;
  const std::string& name = path.native();
  if (name.empty() || name.find('\0') != std::string::npos) fail(path, "give the path of a file");
  if (name.size() >= sizeof address.sun_path) {
    fail(path, "the path has " + std::to_string(name.size()) +
                   " bytes; a Unix socket's has at most " +
                   std::to_string(sizeof address.sun_path - 1) +
                   ": take a shorter one, or one that is relative");
  }
  name.copy(address.sun_path, name.size());
  return address;
}

const sockaddr* generic(const sockaddr_un& address) {
  return reinterpret_cast<const sockaddr*>(&address);  // as the sockets of POSIX want it
}

int new_socket() { return ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0); }

/// Removes a socket that nobody listens to.
void make_way(const std::filesystem::path& path, const sockaddr_un& address) {
  struct stat there = {};
  if (::lstat(path.c_str(), &there) != 0) return;  // what else may be wrong, bind() will tell
  if (!S_ISSOCK(there.st_mode)) {
    fail(path, "something else than a socket is there: take another path, or remove it");
  }
  const OpenFile probe(new_socket());
  const bool is_taken = ::connect(probe.get(), generic(address), sizeof address) == 0;
  if (is_taken || errno == EAGAIN) {
    fail(path, "another server answers there: end it, or take another path");
  }
  if (errno != ECONNREFUSED) {
    fail(path, "a socket is there that cannot be asked", errno);
  }
  if (::unlink(path.c_str()) != 0 && errno != ENOENT) {
    fail(path, "what an earlier server has left cannot be removed", errno);
  }
}

}  // namespace

UnixSocket::UnixSocket(std::filesystem::path path) : path_(std::move(path)) {
  const sockaddr_un address = address_of(path_);
  const std::filesystem::path folder = path_.has_parent_path() ? path_.parent_path() : ".";
  // Of two servers that start at once, each might remove the other's new socket for an old one.
  const OpenFile lock(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (lock.get() < 0) {
    fail(path_, "its folder " + folder.string() + " cannot be used", errno);
  }
  ::flock(lock.get(), LOCK_EX);

  make_way(path_, address);
  OpenFile listener(new_socket());
  // Before there is a file, so that it never is open to others: Linux makes it with this mode.
  ::fchmod(listener.get(), S_IRUSR | S_IWUSR);
  if (listener.get() < 0 || ::bind(listener.get(), generic(address), sizeof address) != 0) {
    fail(path_, "the socket cannot be made", errno);
  }
  struct stat made = {};
  const bool is_ours = ::chmod(path_.c_str(), S_IRUSR | S_IWUSR) == 0 &&
                       ::lstat(path_.c_str(), &made) == 0 &&
                       ::listen(listener.get(), waiting_clients) == 0;
  if (!is_ours) {
    const int error = errno;
    ::unlink(path_.c_str());
    fail(path_, "the socket cannot be listened to", error);
  }
  device_ = made.st_dev;
  inode_ = made.st_ino;
  file_ = listener.let_go();
}

UnixSocket::~UnixSocket() {
  struct stat there = {};
  if (::lstat(path_.c_str(), &there) == 0 && there.st_dev == device_ && there.st_ino == inode_) {
    ::unlink(path_.c_str());
  }
  ::close(file_);
}

int UnixSocket::accept(bool& is_out_of_files) noexcept {
  const int client = ::accept4(file_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  is_out_of_files =
      client < 0 && (errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM);
  return client;
}

}  // namespace keepout::app
