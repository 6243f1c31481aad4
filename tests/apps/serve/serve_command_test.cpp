// SPDX-License-Identifier: BSD-3-Clause
// 'keepout serve' as other programs meet it: a process at the end of a pipe or a socket.
#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <chrono>
#include <optional>
#include <sstream>
#include <thread>
#include <utility>

#include "apps/command_process.h"
#include "keepout/fixtures/poses.h"
#include "keepout/fixtures/shapes.h"
#include "keepout/mesh/binary_stl.h"
#include "serve/answer.h"

namespace keepout {
namespace {

// The sanitizers keep what was freed for a while.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool memory_is_plain = false;
#else
constexpr bool memory_is_plain = true;
#endif

constexpr int patience = 60'000;  // until a server on a busy machine has done something [ms]

/// One end of a conversation.
class Talk {
 public:
  Talk(int in, int out) : in_(in), out_(out) {}
  Talk(Talk&& other) noexcept
      : in_(std::exchange(other.in_, -1)), out_(std::exchange(other.out_, -1)) {}
  ~Talk() {
    close_out();
    close_in();
  }

  bool send(std::string_view text) const {
    while (!text.empty()) {
      const ssize_t count = ::write(out_, text.data(), text.size());
      if (count < 0) return false;
      text.remove_prefix(static_cast<std::size_t>(count));
    }
    return true;
  }

  /// The next line that arrives; "" at the end, "?" if nothing comes.
  std::string line() {
    while (true) {
      if (const std::size_t end = received_.find('\n'); end != std::string::npos) {
        const std::string first = received_.substr(0, end);
        received_.erase(0, end + 1);
        return first;
      }
      pollfd file{in_, POLLIN, 0};
      if (::poll(&file, 1, patience) != 1) return "?";
      char part[65536];
      const ssize_t count = ::read(in_, part, sizeof part);
      if (count <= 0) return {};
      received_.append(part, static_cast<std::size_t>(count));
    }
  }

  std::string ask(std::string_view text) {
    return send(std::string(text) + "\n") ? line() : "could not send";
  }

  void close_out() {
    if (out_ >= 0 && out_ != in_) ::close(out_);
    out_ = -1;
  }
  void close_in() {
    if (in_ >= 0) ::close(in_);
    in_ = -1;
  }
  int out() const { return out_; }

 private:
  int in_;
  int out_;
  std::string received_;
};

class ServeCommand : public testing::Test {
 protected:
  void SetUp() override {
    ::signal(SIGPIPE, SIG_IGN);
    write_binary_stl(folder_.file("cube.stl"), make_cube(100.0));
  }
  void TearDown() override {
    if (process_ > 0) {
      ::kill(process_, SIGKILL);
      ::waitpid(process_, nullptr, 0);
    }
  }

  /// Starts a server in the folder; what it says to people goes into the file "log".
  Talk start(std::vector<std::string> options = {}) {
    int to[2];
    int from[2];
    EXPECT_EQ(::pipe2(to, O_CLOEXEC), 0);
    EXPECT_EQ(::pipe2(from, O_CLOEXEC), 0);
    options.insert(options.begin(), {"keepout", "serve", "cube.stl"});
    std::vector<char*> arguments;
    for (std::string& option : options) arguments.push_back(option.data());
    arguments.push_back(nullptr);
    const std::string folder = folder_.path().string();
    process_ = ::fork();
    if (process_ == 0) {
      ::signal(SIGPIPE, SIG_DFL);
      ::dup2(to[0], STDIN_FILENO);
      ::dup2(from[1], STDOUT_FILENO);
      if (::chdir(folder.c_str()) != 0 || std::freopen("log", "w", stderr) == nullptr) ::_exit(126);
      ::execv(KEEPOUT_COMMAND, arguments.data());
      ::_exit(127);
    }
    ::close(to[0]);
    ::close(from[1]);
    return {from[0], to[1]};
  }

  /// A client of the server that listens at "s", as soon as there is one.
  Talk connect() const {
    for (int tries = 0;; ++tries) {
      const int socket = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
      sockaddr_un address = {};
      address.sun_family = AF_UNIX;
      folder_.file("s").native().copy(address.sun_path, sizeof address.sun_path - 1);
      if (::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) {
        return {socket, socket};
      }
      ::close(socket);
      if (tries > patience / 10) throw std::runtime_error("no server");
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }

  /// Its exit status, or 1000 and the signal that has ended it.
  int end(std::optional<int> signal = std::nullopt) {
    if (signal) ::kill(process_, *signal);
    int status = 0;
    ::waitpid(std::exchange(process_, -1), &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
  }

  std::string log() const { return folder_.contents("log"); }

  /// [KiB]
  long resident() const {
    std::ifstream status("/proc/" + std::to_string(process_) + "/status");
    for (std::string line; std::getline(status, line);) {
      if (line.starts_with("VmRSS:")) return std::stol(line.substr(6));
    }
    return -1;
  }

  test::CommandFolder folder_;
  pid_t process_ = -1;
};

constexpr std::string_view ping = R"({"id":1,"do":"ping"})";
constexpr std::string_view pong = R"({"id":1,"ok":true})";

TEST_F(ServeCommand, APipeIsServedUntilItEnds) {
  Talk talk = start();
  EXPECT_EQ(talk.ask(ping), pong);
  EXPECT_EQ(talk.ask(R"({"id":2,"do":"step","tip":[0,0,60],"desired":[0,0,-0.5]})"),
            R"({"id":2,"ok":true,"status":"free","motion":[0,0,-0.5],"triangles":0,"planes":0,)"
            R"("distance":10})");
  EXPECT_CONTAINS(talk.ask("nonsense"), "not_json");
  EXPECT_TRUE(talk.send("\r\n\n  \n" + std::string(ping) + "\r\n" + std::string(ping)));
  EXPECT_EQ(talk.line(), pong);
  talk.close_out();
  EXPECT_EQ(talk.line(), pong);  // the last line, which has no end
  EXPECT_EQ(talk.line(), "");
  EXPECT_EQ(end(), 0);
  EXPECT_CONTAINS(log(), "keepout: serving cube.stl (12 triangles) on stdin and stdout");
}

TEST_F(ServeCommand, ALineTooLongIsSkippedToItsEnd) {
  Talk talk = start({"--max-line", "256"});
  ASSERT_TRUE(talk.send(std::string(1'000'000, '[') + "\n" + std::string(ping) + "\n"));
  EXPECT_CONTAINS(talk.line(), "line_too_long");
  EXPECT_EQ(talk.line(), pong);
}

TEST_F(ServeCommand, SignalsEndItCleanly) {
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) {
    {
      Talk talk = start();
      EXPECT_EQ(talk.ask(ping), pong);
      EXPECT_EQ(end(signal), 0);
    }
    start({"--socket", "s"});
    EXPECT_EQ(connect().ask(ping), pong);
    EXPECT_EQ(end(signal), 0);
    EXPECT_FALSE(std::filesystem::exists(folder_.file("s")));
  }
}

TEST_F(ServeCommand, AReaderWhoHasGoneEndsIt) {
  Talk talk = start();
  EXPECT_EQ(talk.ask(ping), pong);
  talk.close_in();
  EXPECT_EQ(end(), 0);  // and nothing had to be sent
}

TEST_F(ServeCommand, AClientWhoNeverReadsHoldsUpHimselfAlone) {
  const Talk unused = start({"--socket", "s"});
  Talk greedy = connect();
  ::fcntl(greedy.out(), F_SETFL, O_NONBLOCK);
  std::string lines;
  for (int i = 0; i < 1000; ++i) lines += "{\"do\":\"statuses\"}\n";
  Talk other = connect();
  const auto flood = [&] {
    for (int i = 0; i < 200; ++i) {
      [[maybe_unused]] const ssize_t sent = ::write(greedy.out(), lines.data(), lines.size());
      EXPECT_EQ(other.ask(ping), pong);
    }
  };
  flood();
  const long before = resident();
  flood();
  if (memory_is_plain) {
    EXPECT_LT(resident(), before + 512);
  }
  EXPECT_EQ(end(SIGTERM), 0);
}

TEST_F(ServeCommand, ClientsComeAndGoAsTheyLike) {
  const Talk unused = start({"--socket", "s", "--max-clients", "3"});
  struct stat status = {};
  Talk first = connect();
  ASSERT_EQ(::stat(folder_.file("s").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0600u);
  {
    Talk second = connect();
    Talk third = connect();
    for (Talk* talk : {&first, &second, &third}) EXPECT_EQ(talk->ask(ping), pong);
    Talk fourth = connect();
    EXPECT_CONTAINS(fourth.line(), "too_many_clients");
    EXPECT_EQ(fourth.line(), "");
    EXPECT_TRUE(second.send("{\"id\":5"));  // and leaves
  }
  for (int i = 0; i < 200; ++i) {
    // Who asks and leaves at once may still be there when the next one comes.
    Talk hasty = connect();
    hasty.send(std::string(ping) + "\n" + std::string(ping) + "\n");
  }
  EXPECT_EQ(first.ask(ping), pong);
  std::string answer;
  for (int tries = 0; tries < 1000 && answer != pong; ++tries) answer = connect().ask(ping);
  EXPECT_EQ(answer, pong);
  Talk half = connect();
  EXPECT_EQ(half.ask(ping), pong);
  ASSERT_TRUE(half.send(std::string(ping) + "\n" + std::string(ping)));
  ::shutdown(half.out(), SHUT_WR);
  EXPECT_EQ(half.line(), pong);
  EXPECT_EQ(half.line(), pong);
  EXPECT_EQ(half.line(), "");
  EXPECT_EQ(end(SIGTERM), 0);
}

TEST_F(ServeCommand, ASocketThatIsLeftBehindIsReplacedAndALiveOneIsNot) {
  start({"--socket", "s"});
  EXPECT_EQ(connect().ask(ping), pong);
  const auto second = folder_.run("serve cube.stl --socket s < /dev/null");
  EXPECT_EQ(second.status, 1);
  EXPECT_CONTAINS(second.output, "another server answers there");
  EXPECT_EQ(connect().ask(ping), pong);
  EXPECT_EQ(end(SIGKILL), 1000 + SIGKILL);
  EXPECT_TRUE(std::filesystem::exists(folder_.file("s")));
  start({"--socket", "s"});
  EXPECT_EQ(connect().ask(ping), pong);
  // One that somebody else has put in its place stays.
  std::filesystem::remove(folder_.file("s"));
  folder_.write("s", "mine");
  EXPECT_EQ(end(SIGTERM), 0);
  EXPECT_TRUE(std::filesystem::exists(folder_.file("s")));
}

TEST_F(ServeCommand, WhereNoSocketCanBeItSaysSo) {
  folder_.write("file", "mine");
  const std::vector<std::pair<std::string, std::string>> table{
      {"file", "something else than a socket is there"},
      {".", "something else than a socket is there"},
      {"no/such/s", "its folder no/such cannot be used"},
      {std::string(108, 'x'), "the path has 108 bytes; a Unix socket's has at most 107"},
      {"''", "give the path of a file"}};
  for (const auto& [path, message] : table) {
    const auto outcome = folder_.run("serve cube.stl --socket " + path);
    EXPECT_EQ(outcome.status, 1) << path;
    EXPECT_CONTAINS(outcome.output, message);
  }
  EXPECT_TRUE(std::filesystem::exists(folder_.file("file")));
}

TEST_F(ServeCommand, WithoutStdinOrStdoutItSaysSo) {
  EXPECT_CONTAINS(folder_.run("serve cube.stl <&-").output, "stdin or stdout is closed");
  const auto folder = folder_.run("serve cube.stl < .");
  EXPECT_EQ(folder.status, 1);
  EXPECT_CONTAINS(folder.output, "stdin: Is a directory");
  folder_.write("in", std::string(ping) + "\n");
  const auto file = folder_.run("serve cube.stl < in");
  EXPECT_EQ(file.status, 0);
  EXPECT_TRUE(file.output.ends_with("\n" + std::string(pong) + "\n")) << file.output;
  EXPECT_EQ(folder_.run("serve cube.stl < in > /dev/full").status, 1);
}

TEST_F(ServeCommand, ItsAnswersAreThoseOfReplayBitForBit) {
  const Mesh mesh(make_shape("cortex"));
  write_binary_stl(folder_.file("cube.stl"), make_shape("cortex"));
  Random random(5);
  std::string poses;
  std::string batch = "{\"do\":\"steps\",\"motions\":[";
  for (const Vec3& tip : surface_points(mesh, 500, 0.5, random)) {
    const Vec3 desired = 0.9 * random.direction();
    batch += batch.back() == '[' ? "[" : ",[";
    for (int i = 0; i < 6; ++i) {
      const double number = i < 3 ? tip[i] : desired[i - 3];
      if (i > 0) batch += ',';
      app::append_number(batch, number);
      char text[32];
      std::snprintf(text, sizeof text, "%.17g ", number);
      poses += text;
    }
    batch += ']';
    poses += '\n';
  }
  folder_.write("poses", poses);
  ASSERT_EQ(folder_.run("replay cube.stl --poses poses --out steps.csv --radius 1").status, 0);
  Talk talk = start({"--radius", "1"});
  const std::string answer = talk.ask(batch + "]}");
  std::string expected = "{\"id\":null,\"steps\":[";
  std::ifstream csv(folder_.file("steps.csv"));
  std::string row;
  std::getline(csv, row);
  std::size_t limited = 0;
  while (std::getline(csv, row)) {
    std::vector<std::string> cells;
    std::istringstream rest(row);
    for (std::string cell; std::getline(rest, cell, ',');) cells.push_back(cell);
    ASSERT_EQ(cells.size(), 18u);
    if (expected.back() == '}') expected += ',';
    limited += cells[1] == "limited";
    expected += "{\"ok\":true,\"status\":\"" + cells[1] + "\",";
    const bool is_limited = cells[1] == "limited" || (cells[1] == "recovering" && cells[12] != "0");
    if (is_limited) expected += "\"limits\":[\"mesh\"],";
    expected += "\"motion\":[";
    for (std::size_t i = 8; i < 11; ++i) {
      app::append_number(expected, std::stod(cells[i]));
      expected += i < 10 ? ',' : ']';
    }
    expected += ",\"triangles\":" + cells[11] + ",\"planes\":" + cells[12] + ",\"distance\":";
    app::append_number(expected, std::stod(cells[17]));
    expected += '}';
  }
  EXPECT_EQ(answer, expected + "]}");
  EXPECT_GT(limited, 100u);
}

TEST_F(ServeCommand, ItsMemoryDoesNotGrowWithWhatItIsAsked) {
  if (!memory_is_plain) GTEST_SKIP() << "not under sanitizers";
  Talk talk = start();
  const std::vector<std::string> lines{
      R"({"id":2,"do":"step","tip":[0,0,50.4],"desired":[0.1,0,-0.5]})",
      R"({"id":"three","do":"polytope","tip":[0,0,50.4],"radius":2})",
      R"({"id":4,"do":"steps","motions":[[0,0,60,0,0,-0.5],[0,0,50.4,0,0,-0.5]]})",
      R"({"id":5,"do":"step","tip":[0,0,NaN]})", R"({"id":6,"do":"step","tip":[0,0,1],"tip":2})"};
  const auto ask = [&](std::size_t times) {
    std::string batch;
    for (std::size_t i = 0; i < 10; ++i) {
      for (const std::string& line : lines) batch += line + "\n";
    }
    for (std::size_t asked = 0; asked < times; asked += 10 * lines.size()) {
      ASSERT_TRUE(talk.send(batch));
      for (std::size_t i = 0; i < 10 * lines.size(); ++i) ASSERT_GT(talk.line().size(), 10u);
    }
  };
  ask(10'000);
  const long early = resident();
  ask(100'000);
  // Less than a byte for each.
  EXPECT_LT(resident() - early, 64) << early;
}

/// What a client program prints.
std::string printed(const std::string& line) {
  FILE* pipe = ::popen(line.c_str(), "r");
  std::string text;
  for (char part[4096]; std::fgets(part, sizeof part, pipe) != nullptr;) text += part;
  EXPECT_EQ(::pclose(pipe), 0);
  return text;
}

TEST_F(ServeCommand, TheClientInPythonStopsAtTheMargin) {
  const std::string mesh = folder_.file("cube.stl").string();
  const std::string text = printed(
      "python3 '" KEEPOUT_EXAMPLES "/python/serve_client.py' '" KEEPOUT_COMMAND "' '" + mesh + "'");
  double x = 0, y = 0, z = 0;
  ASSERT_EQ(std::sscanf(text.c_str(), "limited at %lf %lf %lf", &x, &y, &z), 3) << text;
  EXPECT_NEAR(z, 50.5, 1e-3);
}

TEST_F(ServeCommand, TheClientInShellIsAnswered) {
  const std::string mesh = folder_.file("cube.stl").string();
  const std::string text =
      printed("'" KEEPOUT_EXAMPLES "/serve_client.sh' '" KEEPOUT_COMMAND "' '" + mesh + "'");
  EXPECT_TRUE(text.starts_with(std::string(pong) + "\n{\"id\":2,\"ok\":true")) << text;
  EXPECT_CONTAINS(text, "'desired' is missing");
}

}  // namespace
}  // namespace keepout
