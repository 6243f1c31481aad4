// SPDX-License-Identifier: BSD-3-Clause
// A node with the interface of CRTK: see docs/ros1.md and docs/ros2.md.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <exception>
#include <iostream>
#include <memory>

#include "guard_node.h"
#include "keepout/error.h"
#include "loop.h"
#include "queued_transport.h"
#include "settings.h"
#include "simulated_robot.h"

namespace {

using namespace keepout::crtk;

volatile std::sig_atomic_t is_stopped = 0;

void stop(int) { is_stopped = 1; }

int run(int argc, char** argv) {
  CLI::App app{std::string("Keeps a robot's tool out of a triangle mesh, between a teleoperation "
                           "and a robot that follow CRTK. ") +
               program_help};
  app.name(program_name);
  Settings settings;
  add_options(app, settings);
  std::vector<std::string> names, arguments(argv + 1, argv + argc);
  for (const CLI::Option* option : app.get_options()) {
    if (!option->get_lnames().empty() && option != app.get_help_ptr())
      names.push_back(option->get_lnames().front());
  }
  std::unique_ptr<Transport> transport;
  try {
    // Help needs no middleware.
    const bool is_help = std::ranges::any_of(
        arguments, [](const std::string& word) { return word == "--help" || word == "-h"; });
    if (!is_help) transport = std::make_unique<QueuedTransport>(connect(arguments, names));
    std::ranges::reverse(arguments);  // as CLI11 takes them
    app.parse(arguments);
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  }
  complete(settings);
  const Scene scene = load_scene(settings);
  std::unique_ptr<Node> node;
  if (settings.role == Role::guard) {
    node = std::make_unique<GuardNode>(settings, scene, *transport);
  } else {
    if (!settings.robot.empty())
      throw keepout::Error("the simulated robot has a tip only: omit --robot");
    node = std::make_unique<SimulatedRobot>(settings, scene, *transport);
  }
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, &stop);
  const LoopReport report = run_loop(
      *node, settings.period, settings.seconds, +[] { return is_stopped != 0; });
  std::cout << report.text() << '\n' << node->summary() << '\n';
  return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) try {
  return run(argc, argv);
} catch (const std::exception& error) {
  std::cerr << program_name << ": " << error.what() << '\n';
  return EXIT_FAILURE;
}
