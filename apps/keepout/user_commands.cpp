// SPDX-License-Identifier: BSD-3-Clause
#include "user_commands.h"

#include <cstdlib>
#include <iostream>
#include <memory>
#include <string>
#include <utility>

#include "commands.h"
#include "igtl/igtl.h"
#include "keepout/activation/registry.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/mesh/load_mesh.h"
#include "keepout/solvers/registry.h"
#include "live/live.h"
#include "record/record.h"
#include "record/report.h"
#include "serve/request_schema.h"
#include "serve/serve.h"
#include "shared/command_line.h"
#include "shared/named_mesh.h"
#include "shared/names.h"
#include "simulate/simulated_tool.h"
#include "verify/verify.h"

namespace keepout::app {
namespace {

void add_inspect(CLI::App& app, InspectOptions& options) {
  CLI::App& command = *app.add_subcommand(
      "inspect",
      "Report the contents and the faults of a mesh, with their places: counts, holes, winding, "
      "degenerate and duplicate triangles, size, unit and anatomical space");
  add_mesh(command, options.mesh);
  add_load_options(command, options.load);
  command.add_flag("--json", options.json, "Print JSON instead of text: see docs/records.md");
  command.add_flag("--self-intersections", options.self_intersections,
                   "Also find the pairs of triangles that cut through each other");
  command
      .add_option("--out", options.page,
                  "Where to write a page that shows the mesh with its faults marked")
      ->type_name("PAGE.html")
      ->check(name_of_page());
}

void add_convert(CLI::App& app, ConvertOptions& options) {
  CLI::App& command = *app.add_subcommand(
      "convert",
      "Write a mesh again as binary STL or PLY: welded, without degenerate and duplicate "
      "triangles, and on request in another space, unit or orientation; report the changes");
  command.add_option("IN", options.input, std::string(mesh_help))->type_name("")->required();
  command
      .add_option("OUT", options.output,
                  "Where to write the mesh, in mm: .stl, which rounds coordinates to single "
                  "precision, or .ply, which keeps all digits")
      ->type_name("")
      ->required()
      ->check(CLI::Validator([](const std::string& path) { return fault_of_output(path); }, ""));
  add_load_options(command, options.load);
  command.add_flag("--orient", options.orient,
                   "Turn triangles so that neighbors agree and closed parts face outward; report "
                   "the parts for which this cannot be decided");
}

void add_docs(CLI::App& app, DocsOptions& options) {
  CLI::App& command = *app.add_subcommand("docs", "Print where the pages of the documentation are");
  CLI::Option* page = command.add_option("PAGE", options.page, "The page to find");
  page->type_name("");
  if (const auto pages = pages_of_docs(); !pages.empty()) page->check(one_of(pages));
}

void add_register(CLI::App& app, RegisterOptions& options) {
  CLI::App& command = *app.add_subcommand(
      "register",
      "Compute the pose of the robot in the frame of the mesh from points that are "
      "known in both, and the expected error where the tool works");
  command
      .add_option("FILE", options.fiducials,
                  "One pair a line, 'measured x,y,z, model x,y,z' and optionally a weight; the "
                  "first line may be a header")
      ->type_name("")
      ->required();
  command
      .add_option("--measured-in", options.unit,
                  "Unit of the measured points, which is also that of the robot's poses; the model "
                  "is in mm")
      ->transform(one_of<LengthUnit>({{"mm", LengthUnit::millimetre}, {"m", LengthUnit::metre}}))
      ->default_str("mm");
  command
      .add_option("--target", options.targets,
                  "Place in the mesh where the tool works; may be given several times")
      ->type_name("X Y Z")
      ->type_size(3)
      ->allow_extra_args(false)
      ->check(number_within(-1e6, 1e6, "a number from -1e6 to 1e6", "MM"));
  command
      .add_option("--fle", options.fle,
                  "Fiducial localization error (FLE), root mean square; by default estimated from "
                  "the residuals of the pairs")
      ->type_name("MM")
      ->check(length(Zero::refused));
  command
      .add_option("--confidence", options.confidence, "Probability that the margin is sufficient")
      ->check(number_within(0.01, 0.9999, "a probability from 0.01 to 0.9999", "PROBABILITY"))
      ->capture_default_str();
  command.add_option("--json", options.json, "Where to write the results as JSON")
      ->type_name("FILE.json");
  command.add_flag("--anyway", options.trusted_anyway,
                   "Exit with status 0 even if the fit is doubtful");
}

void add_replay(CLI::App& app, ReplayOptions& options) {
  CLI::App& command = *app.add_subcommand(
      "replay", "Solve one step for each line of a pose file and write every result as CSV");
  add_mesh(command, options.mesh);
  add_load_options(command, options.load);
  command
      .add_option("--poses", options.poses,
                  "One step a line, 'px py pz dx dy dz': tip and desired increment, in mm")
      ->type_name("FILE")
      ->required();
  command.add_option("--out", options.steps, "Where to write the steps")
      ->type_name("STEPS.csv")
      ->required();
  command
      .add_option("--planes", options.planes,
                  "Where to write all planes of each step, whether or not they limited it")
      ->type_name("PLANES.csv");
  add_activation(command, options.constraint.activation);
  add_constraint_options(command, options.constraint);
  add_convex_tool(command, options.constraint);
  add_guides(command, options.guides);
  command.final_callback([&options] { guides_of(options.guides, Guided::tip); });
  CLI::Option* closed = command.add_flag_callback(
      "--closed-loop", [&options] { options.loop = Loop::closed; },
      "Lines are 'gx gy gz rx ry rz', goal and reset position: the tip starts at r of the first "
      "line, the desired increment is goal minus tip, and the tip follows the solved increments");
  add_length(command, "--max-step", options.max_step, Zero::refused,
             "Longest desired increment in a closed loop")
      ->needs(closed);
  command.footer([] {
    return "STEPS.csv: step, status, tip, desired increment, solved increment (u), triangles in "
           "reach,\nplanes, the time of each stage, and the distance of the tip from the surface "
           "before the step, which is\nempty if the step is invalid_input. PLANES.csv: the allowed "
           "u satisfy normal . u >= offset.\nCtrl-C ends the run early and writes the finished "
           "steps.\n\n" +
           listing("Rules", activation_rules()) + listing("Indices", index_backends()) +
           listing("Solvers", solver_backends());
  });
}

void add_simulate(CLI::App& app, SimulateOptions& options) {
  CLI::App& command = *app.add_subcommand(
      "simulate",
      "Push a tool over and into the anatomy with a simulated operator, without a guard and with "
      "each rule, and write an HTML report with pictures");
  command.add_option("MESH", options.meshes, std::string(mesh_help) + "; several with --robot")
      ->type_name("");
  add_load_options(command, options.load);
  options.files.add_to(command);
  command.add_option("--activation", options.rules, "Rules to run, besides the unguarded tool")
      ->check(one_of(names(activation_rules())))
      ->delimiter(',')
      ->capture_default_str();
  if (options.time_parts) {
    command.add_flag("--bench", options.is_timing_parts,
                     "Also time indices, rules and solvers on this mesh, for the same report: a "
                     "quick 'keepout bench'");
  }
  command.add_flag("--verbose", options.is_verbose, "Print the tables of --bench as well");
  add_constraint_options(command, options.constraint);
  add_convex_tool(command, options.constraint);
  add_length(command, "--max-step", options.max_step, Zero::refused,
             "Longest desired increment in a cycle");
  add_number(command, "--seed", options.strokes.seed, 0, largest_seed,
             "Seed of the operator: the same seed gives the same motion");
  add_number(command, "--strokes", options.strokes.count, 1, 100'000,
             "Number of strokes of the operator");
  add_number(command, "--cycles", options.strokes.cycles, 10, 1'000'000,
             "Control cycles of each stroke, at 1 kHz");
  CLI::Option* const robot = add_robot(
      command, options.robot, options.bodies, {"psm"},
      "Drive the instrument of a robot instead, guarded in joint space, guarded in part, and "
      "unguarded; without MESH on skull, airway and brain");
  command
      .add_option("--speed", options.speeds, "Speeds, in multiples of 0.5 mm and 0.02 rad a cycle")
      ->check(number_within(1e-3, 1e3, "a multiple from 0.001 to 1000", "NUMBER"))
      ->delimiter(',')
      ->capture_default_str()
      ->needs(robot);
  CLI::Option* const physics =
      command
          .add_flag(
              "--physics", options.has_physics,
              "Let servos with limited efforts move the robot's masses (MuJoCo), and compare the "
              "measured instrument with its setpoint; without --speed at 20, 50 and 100 mm/s")
          ->needs(robot);
  CLI::Option* const guide = add_guides(command, options.guides);
  physics->excludes(guide);  // a session does not report the guides of an instrument
  for (const char* other : {"--activation", "--verbose", "--index-cache", "--solver", "--max-step",
                            "--inside", "--tool"}) {
    command.get_option(other)->excludes(robot);
  }
  CLI::Option* const tool = command.get_option("--tool");
  tool->excludes(command.get_option("--activation"));  // it has a rule of its own
  if (options.time_parts) {
    CLI::Option* const bench = command.get_option("--bench");  // which times balls without guides
    for (CLI::Option* const other : {robot, tool, guide}) bench->excludes(other);
  }
  for (const auto& option : step_options) {
    if (option.name != "margin") command.get_option("--" + option.flag())->excludes(robot);
  }
  command.footer("Ctrl-C ends the run early and reports the finished strokes.");
  command.final_callback([&options, &command] {
    guides_of(options.guides, options.robot.empty() ? Guided::tip : Guided::instrument);
    if (options.has_physics && command.count("--speed") == 0) options.speeds = {0.04, 0.1, 0.2};
    if (options.has_physics && command.count("--cycles") == 0) options.strokes.cycles = 0;
    if (options.constraint.tool) options.rules = {options.constraint.activation};
    if (!options.robot.empty()) return;
    if (options.meshes.empty()) throw CLI::RequiredError("MESH");
    if (options.meshes.size() > 1) {
      throw CLI::ValidationError("MESH", "must be one mesh; only --robot takes several");
    }
  });
}

void add_serve(CLI::App& app, ServeOptions& options) {
  CLI::App& command = *app.add_subcommand("serve",
                                          "Answer requests of other programs, one JSON object a "
                                          "line, on stdin and stdout or on a Unix socket");
  ServiceSettings& service = options.service;
  add_mesh(command, service.mesh);
  add_load_options(command, options.load);
  CLI::Option* socket =
      command.add_option("--socket", options.socket, "Listen at this path instead of stdin")
          ->type_name("PATH");
  add_number(command, "--max-clients", options.most_clients, 1, 256,
             "Most clients of the socket at a time")
      ->needs(socket);
  add_number(command, "--max-line", service.longest_line, 256, std::uint64_t{1} << 24,
             "Longest request")
      ->type_name("BYTES");
  add_number(command, "--joints", service.limits.joints, 1, 64, "Most columns of a Jacobian");
  add_number(command, "--rows", service.limits.rows, 0, 1024, "Most rows of a request");
  add_activation(command, service.constraint.activation);
  add_constraint_options(command, service.constraint);
  add_convex_tool(command, service.constraint);
  // CLI11 prints the text of this exception, and requires no mesh.
  command.add_flag_callback(
      "--schema",
      [&service] { throw CLI::CallForVersion(request_schema(service.limits), EXIT_SUCCESS); },
      "Print the JSON Schema of requests, with these --joints and --rows, and end");
  command.footer(protocol_help());
}

}  // namespace

std::vector<Command> user_commands(TimeParts time_parts) {
  const auto simulation = std::make_shared<SimulateOptions>();
  simulation->rules = names(activation_rules());
  simulation->time_parts = std::move(time_parts);
  simulation->make_instrument = make_guarded_instrument;
  const auto serve_on_stdin = [](const ServeOptions& options, std::ostream&) {
    return serve(options, std::cerr);
  };
  const auto igtl_server = [](const IgtlOptions& options, std::ostream&) {
    return serve_igtl(options, std::cerr);
  };
  return {command("inspect", add_inspect, inspect),
          command("convert", add_convert, convert),
          command("register", add_register, register_fiducials),
          command("replay", add_replay, replay),
          command("simulate", add_simulate, simulate, simulation),
          command("live", add_live, live),
          command("serve", add_serve, serve_on_stdin),
          command("igtl", add_igtl, igtl_server),
          command("verify", add_verify, verify),
          command("report", add_report, report),
          command("docs", add_docs, docs)};
}

}  // namespace keepout::app
