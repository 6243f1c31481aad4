// SPDX-License-Identifier: BSD-3-Clause
// Runs `keepout igtl` under load, with a client made with the OpenIGTLink library:
//
//     igtl_soak KEEPOUT MESH SECONDS
//
// The client presses the tool over the surface at 1 kHz, and reads all that the server sends. The
// last line is the server's: lost cycles, and its memory at start and end. Fails if the tool came
// nearer to the mesh than it may.
#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <stdexcept>
#include <string>
#include <thread>

#include "apps/igtl/library_peer.h"
#include "keepout/geometry/closest_point.h"
#include "keepout/index/budget.h"
#include "keepout/index/wide_bvh.h"
#include "shared/named_mesh.h"

namespace {

using namespace keepout;
using test::igtl::LibraryPeer;
using Clock = std::chrono::steady_clock;

constexpr double margin = 0.2;       // the default of the server [mm]
constexpr double rounding = 1.6e-5;  // of a float coordinate of up to 256 mm, along a diagonal [mm]

/// A server process.
class Server {
 public:
  Server(const char* keepout, const char* mesh) {
    int ends[2];
    if (::pipe(ends) != 0) throw std::runtime_error("no pipe");
    process_ = ::fork();
    if (process_ == 0) {
      ::dup2(ends[1], STDERR_FILENO);
      ::execl(keepout, keepout, "igtl", mesh, "--port", "0", nullptr);
      ::_exit(127);
    }
    ::close(ends[1]);
    lines_ = ::fdopen(ends[0], "r");
    std::string said;
    do {
      said = line();
    } while (said.find(" on 127.0.0.1:") == std::string::npos);
    port_ = static_cast<std::uint16_t>(std::stoi(said.substr(said.rfind(':') + 1)));
  }

  std::uint16_t port() const { return port_; }

  /// Ends the server. Returns its last line.
  std::string end() {
    ::kill(process_, SIGTERM);
    const std::string last = line();
    ::waitpid(process_, nullptr, 0);
    return last;
  }

 private:
  std::string line() {
    char text[1024];
    if (std::fgets(text, sizeof text, lines_) == nullptr) throw std::runtime_error("no server");
    return text;
  }

  pid_t process_;
  FILE* lines_;
  std::uint16_t port_ = 0;
};

LibraryPeer::Matrix matrix_of(const Vec3& tip) {
  LibraryPeer::Matrix matrix = {};
  for (int i = 0; i < 4; ++i) matrix[i][i] = 1.0F;
  for (int i = 0; i < 3; ++i) matrix[i][3] = static_cast<float>(tip[i]);
  return matrix;
}

/// Presses the tool into the mesh from above, in circles.
Vec3 goal(const Box& bounds, double time) {
  const double radius = 0.2 * bounds.size().x();
  return {bounds.center().x() + radius * std::sin(0.5 * time),
          bounds.center().y() + radius * std::cos(0.5 * time),
          bounds.high.z() + 10.0 * std::cos(2.0 * time)};
}

int soak(const char* keepout, const char* name, double seconds) {
  const auto mesh = app::read_named_mesh(name).mesh;
  const WideBvh index(mesh);
  Server server(keepout, name);
  LibraryPeer peer(server.port());
  const Box box = mesh->bounds();
  peer.send_transform("Tool", matrix_of(goal(box, 0.0)), LibraryPeer::Stamp::now);
  peer.send_string("engage");
  std::atomic<bool> is_done = false;
  std::size_t frames = 0;
  double nearest = 1e9;
  std::string fault;
  std::thread reader([&] {
    try {
      while (!is_done) {
        const LibraryPeer::Message message = peer.receive();
        if (message.type != "TRANSFORM") continue;
        ++frames;
        const Vec3 tip(message.matrix[0][3], message.matrix[1][3], message.matrix[2][3]);
        Budget unlimited;
        const TriangleId t = index.nearest(tip, unlimited);
        if (t != no_triangle) {
          nearest = std::min(nearest, closest_point(mesh->triangle(t), tip).distance);
        }
      }
    } catch (const std::exception& error) {
      fault = error.what();
    }
  });
  std::size_t sent = 0;
  const auto begin = Clock::now();
  for (double time = 0.0; time < seconds; time = 0.001 * static_cast<double>(++sent)) {
    peer.send_transform("Tool", matrix_of(goal(box, time)), LibraryPeer::Stamp::now);
    std::this_thread::sleep_until(begin + sent * std::chrono::milliseconds(1));
  }
  is_done = true;
  reader.join();
  const std::string last = server.end();
  std::printf("client: %zu goals sent, %zu setpoints read, nearest to the mesh %.6f mm%s\n%s", sent,
              frames, nearest, fault.c_str(), last.c_str());
  const bool is_near = nearest < margin - rounding;
  if (is_near) std::printf("the tool came nearer than the margin of %g mm\n", margin);
  return is_near || !fault.empty() || frames == 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}

}  // namespace

int main(int count, char** words) try {
  if (count != 4) throw std::runtime_error("usage: igtl_soak KEEPOUT MESH SECONDS");
  return soak(words[1], words[2], std::atof(words[3]));
} catch (const std::exception& error) {
  std::fprintf(stderr, "igtl_soak: %s\n", error.what());
  return EXIT_FAILURE;
}
