// SPDX-License-Identifier: BSD-3-Clause
// Measures how long a client of `keepout serve` waits for an answer, and whether the server's
// memory stays constant. An operator presses a tool over the mesh in closed loop, one request at a
// time.
#include <fcntl.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "keepout/fixtures/poses.h"
#include "keepout/mesh/load_mesh.h"
#include "shared/clip.h"
#include "shared/machine.h"
#include "shared/timing.h"

namespace {

using namespace keepout;

struct Load {
  std::string command;
  std::string mesh;
  std::string transport = "pipe";
  double requests = 1e6;
  double malformed = 0.01;  // fraction of the lines
};

/// A server process, and the connection to it.
class Server {
 public:
  explicit Server(const Load& load) {
    int to[2];
    int from[2];
    if (::pipe(to) != 0 || ::pipe(from) != 0) throw std::runtime_error("no pipes");
    const std::string socket = std::filesystem::temp_directory_path() /
                               ("keepout_serve_load_" + std::to_string(::getpid()) + ".sock");
    const bool is_pipe = load.transport == "pipe";
    process_ = ::fork();
    if (process_ == 0) {
      ::dup2(to[0], STDIN_FILENO);
      ::dup2(from[1], STDOUT_FILENO);
      for (const int file : {to[0], to[1], from[0], from[1]}) ::close(file);
      const char* command = load.command.c_str();
      // Without a socket, the null pointer ends the arguments before its option.
      ::execl(command, command, "serve", load.mesh.c_str(), "--radius", "1",
              is_pipe ? nullptr : "--socket", socket.c_str(), nullptr);
      std::_Exit(127);
    }
    ::close(to[0]);
    ::close(from[1]);
    in_ = from[0];
    out_ = to[1];
    if (!is_pipe) connect(socket);
  }
  ~Server() {
    ::close(out_);
    ::kill(process_, SIGTERM);
    ::waitpid(process_, nullptr, 0);
  }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// Sends a line and returns the answer, which is valid until the next call.
  std::string_view ask(std::string_view line) {
    if (::write(out_, line.data(), line.size()) != std::ssize(line))
      throw std::runtime_error("write");
    std::size_t size = 0;
    do {
      const ssize_t count = ::read(in_, answer_.data() + size, answer_.size() - size);
      if (count <= 0) throw std::runtime_error("the server has closed the connection");
      size += static_cast<std::size_t>(count);
    } while (answer_[size - 1] != '\n');
    return {answer_.data(), size};
  }

  /// Returns the resident memory of the server, with its unit.
  std::string resident() const {
    std::ifstream status("/proc/" + std::to_string(process_) + "/status");
    for (std::string line; std::getline(status, line);) {
      if (line.starts_with("VmRSS:")) return line.substr(line.find_first_of("0123456789"));
    }
    return "?";
  }

 private:
  void connect(const std::string& path) {
    sockaddr_un address = {};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    ::close(in_);
    ::close(out_);
    in_ = out_ = ::socket(AF_UNIX, SOCK_STREAM, 0);
    const auto* generic = reinterpret_cast<const sockaddr*>(&address);
    for (int tries = 0; ::connect(in_, generic, sizeof address) != 0; ++tries) {
      if (tries == 6000) throw std::runtime_error("the server does not start");
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }

  pid_t process_ = -1;
  int in_ = -1;
  int out_ = -1;
  std::vector<char> answer_ = std::vector<char>(1 << 20);
};

/// An operator who moves to one place of the surface after the other, as deep as possible.
class Operator {
 public:
  explicit Operator(const Mesh& mesh) : starts_(places(mesh, 3.0)), goals_(places(mesh, -3.0)) {}

  std::string_view request(std::size_t number) {
    if (number % 200 == 0) {
      const std::size_t place = number / 200 % starts_.size();
      tip_ = starts_[place];
      goal_ = goals_[(place + number / 200 / starts_.size()) % goals_.size()];
    }
    Vec3 desired = goal_ - tip_;
    // Move along the surface after arrival.
    const double angle = 0.1 * static_cast<double>(number % 200);
    desired += Vec3(2.0 * std::cos(angle), 2.0 * std::sin(angle), std::cos(1.7 * angle));
    desired = app::clipped(desired, 0.2);
    const int size =
        std::snprintf(line_, sizeof line_,
                      "{\"id\":%zu,\"do\":\"step\",\"tip\":[%.17g,%.17g,%.17g],"
                      "\"desired\":[%.17g,%.17g,%.17g]}\n",
                      number, tip_.x(), tip_.y(), tip_.z(), desired.x(), desired.y(), desired.z());
    return {line_, static_cast<std::size_t>(size)};
  }

  void follow(std::string_view answer) {
    const char* at = answer.data() + answer.find("\"motion\":[") + 9;
    for (double& x : tip_) {
      double moved = 0.0;
      at = std::from_chars(at + 1, answer.data() + answer.size(), moved).ptr;
      x += moved;
    }
  }

 private:
  /// Returns the same places for any height above the surface. [mm]
  static std::vector<Vec3> places(const Mesh& mesh, double height) {
    Random random(1);
    return surface_points(mesh, 5000, height, random);
  }

  std::vector<Vec3> starts_, goals_;
  Vec3 tip_ = Vec3::Zero(), goal_ = Vec3::Zero();
  char line_[512];
};

void run(const Load& load) {
  const LoadedMesh loaded = load_mesh(load.mesh);
  Server server(load);
  Operator operates(*loaded.mesh);
  server.ask("{\"do\":\"ping\"}\n");
  const auto count = static_cast<std::size_t>(load.requests);
  const auto every = load.malformed > 0.0 ? static_cast<std::size_t>(1.0 / load.malformed) : count;
  std::vector<double> steps;
  steps.reserve(count);
  std::size_t limited = 0;
  std::string resident_early;
  for (std::size_t number = 0; number < count; ++number) {
    if (number == 10'000) resident_early = server.resident();
    std::string_view line = operates.request(number);
    const bool is_bad = load.malformed > 0.0 && number % every == every - 1;
    std::string cut;
    if (is_bad) line = cut = std::string(line.substr(0, 20 + number % 60)) + "\n";
    const app::BenchClock::time_point start = app::BenchClock::now();
    const std::string_view answer = server.ask(line);
    const double waited = app::microseconds_since(start);
    if ((answer.find("\"error\"") != std::string_view::npos) != is_bad) {
      throw std::runtime_error("a wrong answer: " + std::string(answer));
    }
    if (is_bad) continue;
    steps.push_back(waited);
    limited += answer.find("\"limited\"") != std::string_view::npos;
    operates.follow(answer);
  }
  const app::Machine machine = app::this_machine();
  std::printf("machine: %s, %u cores, %s, %s\n", machine.processor.c_str(), machine.cores,
              machine.compiler.c_str(), machine.simd.c_str());
  const app::Timing waited = app::timing_of(steps);
  std::printf(
      "| over | requests | of them cut off | limited by the surface | p50, µs | p99 | p99.9 "
      "| max | resident after 10,000 | at the end |\n"
      "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n");
  std::printf("| a %s | %zu | %zu | %.0f %% | %.1f | %.1f | %.0f | %.0f | %s | %s |\n",
              load.transport.c_str(), count, count - steps.size(),
              100.0 * static_cast<double>(limited) / static_cast<double>(steps.size()), waited.p50,
              waited.p99.value_or(waited.max), waited.p999.value_or(waited.max), waited.max,
              resident_early.c_str(), server.resident().c_str());
}

}  // namespace

int main(int argc, char** argv) {
  Load load;
  CLI::App app("Round trips to 'keepout serve', one at a time", "keepout_serve_load");
  app.add_option("KEEPOUT", load.command, "The keepout command")->required();
  app.add_option("MESH", load.mesh, "Mesh file, in mm")->required();
  app.add_option("--transport", load.transport, "pipe or socket")
      ->check(CLI::IsMember({"pipe", "socket"}))
      ->capture_default_str();
  app.add_option("--requests", load.requests, "Number of requests")
      ->check(CLI::Range(1.0, 1e9))
      ->capture_default_str();
  app.add_option("--malformed", load.malformed, "Fraction of lines that are cut off")
      ->check(CLI::Range(0.0, 0.5))
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    run(load);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "keepout_serve_load: %s\n", error.what());
    return EXIT_FAILURE;
  }
}
