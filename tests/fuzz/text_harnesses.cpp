// SPDX-License-Identifier: BSD-3-Clause
// Readers of lines and words: poses, fiducials, guides, tools, options and command lines.
#include <cmath>
#include <iostream>
#include <sstream>

#include "fuzz/harness.h"
#include "keepout/control/rigid_fit.h"
#include "keepout/control/target_error.h"
#include "keepout/factory/convex_tool_text.h"
#include "keepout/factory/for_each_option.h"
#include "keepout/factory/guide_text.h"
#include "keepout/geometry/separation.h"
#include "shared/pose_file.h"
#include "user_commands.h"

namespace keepout::fuzz {
namespace {

void read_pose_file(Bytes bytes) {
  ignore_errors([&] {
    const auto poses = app::read_poses(scratch_file("poses.txt", bytes));
    require(!poses.empty(), "a pose file has a pose");
    for (const app::PoseLine& line : poses) {
      require(line.first.allFinite() && line.second.allFinite(), "poses are finite");
    }
  });
}

void read_fiducial_file(Bytes bytes) {
  ignore_errors([&] {
    const app::FiducialPairs pairs = app::read_fiducials(scratch_file("fiducials.csv", bytes));
    const std::size_t count = pairs.lines.size();
    require(pairs.measured.size() == count && pairs.model.size() == count &&
                (pairs.weights.empty() || pairs.weights.size() == count),
            "all lists of fiducials have the same length");
    const RigidFit fit = fit_rigid(pairs.measured, pairs.model, pairs.weights);
    require(fit.matrix().allFinite() && std::isfinite(fit.fre), "a fit is finite");
    const Mat3 rotation = fit.matrix().topLeftCorner<3, 3>();
    require((rotation.transpose() * rotation - Mat3::Identity()).norm() < 1e-9 &&
                rotation.determinant() > 0.0,
            "a fit has a rotation");
    require(std::isfinite(target_error(fit, Vec3::Zero()).rms()), "a target error is finite");
  });
}

void read_guide(Bytes bytes) {
  ignore_errors([&] {
    const Guide guide = guide_of_text(text_of(bytes));
    require(guide.region().origin().allFinite() && std::isfinite(guide.region().radius()) &&
                guide.band() > 0.0,
            "a guide is finite");
    require(!std::isnan(guide.region().excess(Vec3(1, 2, 3))), "an excess is a number");
  });
}

void read_tool(Bytes bytes) {
  ignore_errors([&] {
    const ConvexTool tool = tool_of_text(text_of(bytes));
    const Ball& ball = tool.bounding_ball();
    require(tool.points().size() <= ConvexTool::most_points && std::isfinite(ball.radius),
            "a tool is finite");
    const Triangle triangle{Vec3(9, 0, 0), Vec3(0, 9, 0), Vec3(0, 0, 9)};
    require(!std::isnan(separation(tool, Vec3::Zero(), triangle).distance),
            "a distance is a number");
  });
}

/// The first byte chooses the option.
void read_option(Bytes bytes) {
  Source source(bytes);
  std::size_t chosen = source.byte();
  const std::string text(text_of(source.rest()));
  const auto set = [&](auto settings) {
    for_each_option(settings, [&](const auto& option, auto& of) {
      if (chosen-- != 0) return;
      ignore_errors([&] {
        option.set(of, option.parsed(text));
        const OptionValue value = option.get(of);
        option.set(of, option.parsed(keepout::text_of(value)));
        require(option.get(of) == value, "the text of an option reads back as the same value");
      });
    });
  };
  set(MotionConstraintSettings());
  set(InstrumentConstraintSettings());
}

/// Exchanges a stream's buffer as long as it lives.
class Redirected {
 public:
  explicit Redirected(std::ostream& stream)
      : stream_(stream), before_(stream.rdbuf(text_.rdbuf())) {}
  ~Redirected() { stream_.rdbuf(before_); }
  Redirected(const Redirected&) = delete;
  Redirected& operator=(const Redirected&) = delete;

  std::string text() const { return text_.str(); }

 private:
  std::ostream& stream_;
  std::ostringstream text_;
  std::streambuf* before_;
};

/// Each line is a word of a command line. No command is run.
void read_command_line(Bytes bytes) {
  std::vector<std::string> words{"keepout"};
  std::istringstream lines{std::string(text_of(bytes))};
  for (std::string line; std::getline(lines, line);) {
    words.push_back(line.substr(0, line.find('\0')));  // as the system ends each word
    if (words.back().starts_with("--plugin")) return;  // it would run code of the file
  }
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  std::vector<app::Command> commands = app::user_commands();
  for (app::Command& command : commands) {
    command.run = [](const app::Call&) { return EXIT_SUCCESS; };
  }
  const Redirected out(std::cout);
  const Redirected err(std::cerr);
  const int status = app::run_program(commands, static_cast<int>(words.size()), arguments.data());
  const std::string message = err.text();
  require(status == EXIT_SUCCESS ? message.empty() : message.starts_with("keepout: "),
          "a wrong command line is named, and only such a one: " + message);
  require(message.find("unexpected") == std::string::npos, message);
}

}  // namespace

std::span<const Harness> text_harnesses() noexcept {
  static constexpr Harness all[] = {
      {"poses", "apps/keepout/shared/pose_file.cpp", read_pose_file},
      {"fiducials", "apps/keepout/shared/pose_file.cpp control/src/rigid_fit.cpp",
       read_fiducial_file},
      {"guide", "factory/src/guide_text.cpp factory/src/text_fields.cpp", read_guide},
      {"tool", "factory/src/convex_tool_text.cpp engine/src/geometry/convex_tool.cpp", read_tool},
      {"option", "engine/src/option_table.cpp", read_option},
      {"command_line",
       "apps/keepout/shared/command_line.cpp apps/keepout/shared/completion.cpp "
       "apps/keepout/shared/program.cpp apps/keepout/user_commands.cpp",
       read_command_line},
  };
  return all;
}

}  // namespace keepout::fuzz
