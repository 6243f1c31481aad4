// SPDX-License-Identifier: BSD-3-Clause
#include "shared/output_file.h"

#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>

#include "temporary_folder.h"

namespace keepout::app {
namespace {

namespace fs = std::filesystem;

class OutputFileTest : public testing::Test {
 protected:
  fs::path file(const std::string& name) const { return folder_.path() / name; }

  std::size_t entries() const {
    const fs::directory_iterator all(folder_.path());
    return static_cast<std::size_t>(std::distance(begin(all), end(all)));
  }

  void expect_refused(const fs::path& path, const std::string& kind) const {
    const std::string message = error_of([&] { OutputFile output(path); });
    EXPECT_CONTAINS(message, path.string());
    EXPECT_CONTAINS(message, kind);
  }

  TemporaryFolder folder_;
};

TEST_F(OutputFileTest, AppearsWholeWhenItIsCommitted) {
  folder_.write("a.csv", "old");
  OutputFile output(file("a.csv"));
  output.stream() << "new";
  EXPECT_EQ(contents_of(file("a.csv")), "old");
  output.commit();
  EXPECT_EQ(contents_of(file("a.csv")), "new");
  EXPECT_EQ(entries(), 1u);
}

TEST_F(OutputFileTest, WithoutACommitNothingRemains) {
  folder_.write("a.csv", "old");
  { OutputFile(file("a.csv")).stream() << "new"; }
  EXPECT_EQ(contents_of(file("a.csv")), "old");
  EXPECT_EQ(entries(), 1u);
}

TEST_F(OutputFileTest, FoldersAndPipesAreRefusedAndStayWhatTheyAre) {
  fs::create_directory(file("folder"));
  ASSERT_EQ(::mkfifo(file("pipe").c_str(), 0600), 0);
  fs::create_symlink("pipe", file("link"));
  expect_refused(file("folder"), "folder");
  expect_refused(file("pipe"), "pipe");
  expect_refused(file("link"), "pipe");
  EXPECT_TRUE(fs::is_directory(file("folder")));
  EXPECT_TRUE(fs::is_fifo(file("pipe")));
  EXPECT_EQ(entries(), 3u);
}

TEST_F(OutputFileTest, APathWithoutAFileNameIsRefused) {
  EXPECT_NE(error_of([] { OutputFile output{fs::path()}; }), "no error");
  expect_refused(file("none/"), "cannot write");
}

TEST_F(OutputFileTest, ALinkIsFollowedAndStays) {
  fs::create_directory(file("results"));
  fs::create_symlink("results/a.csv", file("one"));  // a file that does not exist yet
  fs::create_symlink("one", file("two"));
  for (const char* text : {"first", "second"}) {
    OutputFile output(file("two"));
    output.stream() << text;
    output.commit();
    EXPECT_TRUE(fs::is_symlink(file("one")));
    EXPECT_TRUE(fs::is_symlink(file("two")));
    EXPECT_FALSE(fs::is_symlink(file("results/a.csv")));
    EXPECT_EQ(contents_of(file("results/a.csv")), text);
  }
}

TEST_F(OutputFileTest, LinksThatLeadInACircleAreAnError) {
  fs::create_symlink("one", file("two"));
  fs::create_symlink("two", file("one"));
  expect_refused(file("one"), "circle");
}

TEST_F(OutputFileTest, AnOutputThatIsAnInputIsRefusedByWhateverName) {
  folder_.write("mesh.stl", "mesh");
  fs::create_symlink("mesh.stl", file("link.stl"));
  fs::create_hard_link(file("mesh.stl"), file("hard.stl"));
  const std::array inputs{NamedPath{"MESH", file("mesh.stl")}};
  for (const char* name : {"mesh.stl", "./mesh.stl", "link.stl", "hard.stl"}) {
    const std::string message = error_of([&] {
      OutputFiles outputs(inputs, {{"--out", file(name)}});
    });
    EXPECT_CONTAINS(message, "MESH") << name;
    EXPECT_CONTAINS(message, "--out") << name;
  }
  EXPECT_EQ(error_of([&] {
              OutputFiles outputs(inputs, {{"--out", file("report")}});
            }),
            "no error");
}

TEST_F(OutputFileTest, TwoOutputsAreRefusedWhenTheyWouldBeTheSameFile) {
  fs::create_symlink("new.csv", file("link.csv"));
  fs::create_directory_symlink(".", file("here"));
  for (const char* name : {"new.csv", "none/../new.csv", "link.csv", "here/new.csv"}) {
    const std::string message = error_of([&] {
      OutputFiles outputs({}, {{"--out", file("new.csv")}, {"--planes", file(name)}});
    });
    EXPECT_CONTAINS(message, "--out") << name;
    EXPECT_CONTAINS(message, "--planes") << name;
  }
  const auto make_two = [&] {
    OutputFiles outputs({}, {{"--out", file("a.csv")}, {"--planes", file("b.csv")}});
  };
  EXPECT_EQ(error_of(make_two), "no error");
}

/// Returns the status of a child process, as waitpid reports it.
int status_of(auto&& act) {
  const pid_t child = ::fork();
  if (child == 0) {
    act();
    ::_exit(0);
  }
  int status = -1;
  ::waitpid(child, &status, 0);
  return status;
}

TEST_F(OutputFileTest, ASignalEndsTheProcessAndLeavesNoPartialFile) {
  folder_.write("a.csv", "old");
  for (const int signal : {SIGHUP, SIGINT, SIGPIPE, SIGTERM}) {
    const int status = status_of([&] {
      ::signal(signal, SIG_DFL);
      OutputFile one(file("a.csv"));
      OutputFile other(file("b.csv"));
      one.stream() << "half" << std::flush;
      if (entries() != 3) ::_exit(3);  // the partial files exist
      ::raise(signal);
    });
    EXPECT_TRUE(WIFSIGNALED(status)) << status;
    EXPECT_EQ(WTERMSIG(status), signal);
    EXPECT_EQ(entries(), 1u);
    EXPECT_EQ(contents_of(file("a.csv")), "old");
  }
}

TEST_F(OutputFileTest, ASignalThatIsIgnoredStaysIgnored) {
  const int status = status_of([&] {
    ::signal(SIGHUP, SIG_IGN);  // as nohup does
    OutputFile output(file("a.csv"));
    ::raise(SIGHUP);
    output.commit();
  });
  EXPECT_EQ(status, 0);
  EXPECT_TRUE(fs::exists(file("a.csv")));
}

TEST_F(OutputFileTest, ASignalAfterTheCommitLeavesTheResult) {
  const int status = status_of([&] {
    ::signal(SIGTERM, SIG_DFL);
    OutputFile output(file("a.csv"));
    output.stream() << "whole";
    output.commit();
    ::raise(SIGTERM);
  });
  EXPECT_TRUE(WIFSIGNALED(status)) << status;
  EXPECT_EQ(contents_of(file("a.csv")), "whole");
}

TEST_F(OutputFileTest, AFileThatCannotBeWrittenToTheEndIsReported) {
  const int status = status_of([&] {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{4096, 4096};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    OutputFile output(file("a.csv"));
    output.stream() << std::string(5000, 'x');
    const std::string message = error_of([&] { output.commit(); });
    ::_exit(message.find("to the end") != std::string::npos ? 7 : 0);
  });
  EXPECT_EQ(WEXITSTATUS(status), 7);
  EXPECT_FALSE(fs::exists(file("a.csv")));
}

}  // namespace
}  // namespace keepout::app
