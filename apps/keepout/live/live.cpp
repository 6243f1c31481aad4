// SPDX-License-Identifier: BSD-3-Clause
#include "live/live.h"

#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "keepout/activation/registry.h"
#include "keepout/error.h"
#include "keepout/factory/make_instrument_constraint.h"
#include "keepout/index/index_cache.h"
#include "keepout/option_table.h"
#include "keepout/version.h"
#include "live/browser.h"
#include "page/base64.h"
#include "page/gzip.h"
#include "page/packed_mesh.h"
#include "page/page_template.h"
#include "record/record.h"
#include "shared/clip.h"
#include "shared/columns.h"
#include "shared/command_line.h"
#include "shared/named_mesh.h"
#include "shared/names.h"
#include "shared/number_text.h"
#include "shared/output_file.h"
#include "shared/progress.h"
#include "shared/robot_file.h"
#include "simulate/simulated_tool.h"
#include "verify/robot/start.h"

namespace keepout::app {
namespace {

constexpr std::string_view no_fixture = "none";

/// A mesh in the page: the facts that the page reads, and the packed mesh.
struct Anatomy {
  Json facts;
  std::string text;  // gzipped, in base64
};

/// Returns warnings about the mesh, and about the settings on it. Builds the constraint only to
/// collect its warnings. `start`: the start of an instrument, if there is one.
std::vector<std::string> warnings_of(const LoadedMesh& loaded, const LiveOptions& options,
                                     const std::optional<RobotStart>& start) {
  std::vector<std::string> warnings = loaded.notices;
  warnings.insert(warnings.end(), loaded.warnings.begin(), loaded.warnings.end());
  const auto warn = [&warnings](const std::string& text) {
    warn_on_stderr(text);
    warnings.push_back(text);
  };
  if (start) {
    make_instrument_constraint(
        loaded.mesh, robot_named(options.robot).make(start->base),
        {.options = {.margin = options.constraint.options.margin}, .warn = warn})
        .set_guides(guides_of(options.guides, Guided::instrument));
    return warnings;
  }
  MotionConstraintSettings settings = options.constraint;
  // The rule with the fewest requirements.
  if (settings.activation == no_fixture) settings.activation = "all_faces";
  settings.warn = warn;
  make_motion_constraint(loaded.mesh, settings).set_guides(guides_of(options.guides, Guided::tip));
  return warnings;
}

/// Returns the start of an instrument: position and rotation rows of link 0, and the joints.
Json record_of(const RobotStart& start) {
  Json base = Json::array();
  for (const double x : start.base.position) base.push_back(x);
  for (const auto& row : start.base.rotation.rowwise()) {
    for (const double x : row) base.push_back(x);
  }
  return {{"base", base}, {"positions", start.positions}};
}

constexpr std::uint64_t starts_tried = 64;

/// Returns the start of an instrument before a mesh; all of it is farther away than the margin.
/// Draws the start as campaigns do, if possible with the port outside the mesh's box, as in
/// practice. Returns the same start on every run. Throws Error with the mesh's name if no start is
/// found. [mm]
RobotStart instrument_start(const std::string& mesh_name, const std::shared_ptr<const Mesh>& mesh,
                            const RobotUnderTest& robot, double margin) {
  Scene scene(mesh_name, mesh, "wide_bvh");
  const Box box = mesh->bounds();
  std::optional<RobotStart> first;
  for (std::uint64_t seed = 1; seed <= starts_tried; ++seed) {
    Random random(seed);
    auto start = find_start(scene, robot, Begin::apart, margin, random);
    if (!start) break;  // thousands of drawn places were too narrow
    const Vec3& port = start->base.position;
    if ((port.array() < box.low.array()).any() || (port.array() > box.high.array()).any()) {
      return *start;
    }
    if (!first) first = std::move(start);
  }
  if (!first) {
    throw Error(mesh_name + ": there is no room for the instrument of '" + std::string(robot.name) +
                "' in front of its surface: lower --margin");
  }
  return *first;
}

Anatomy anatomy_of(const std::filesystem::path& name, const LiveOptions& options) {
  const LoadedMesh loaded = load_named_mesh(name, options.load);
  const PackedMesh bytes = packed(loaded.mesh->vertices(), loaded.mesh->triangles());
  std::optional<RobotStart> start;
  if (!options.robot.empty()) {
    start = instrument_start(name.string(), loaded.mesh, robot_named(options.robot),
                             options.constraint.options.margin);
  }
  Anatomy anatomy{.facts = {{"name", name.filename().string()},
                            {"command_name", mesh_words(name, options.load)},
                            {"vertices", loaded.mesh->vertex_count()},
                            {"triangles", loaded.mesh->triangle_count()},
                            {"coordinates", bytes.coordinates},
                            {"warnings", warnings_of(loaded, options, start)}},
                  .text = to_base64(gzipped(bytes.bytes))};
  if (start) {
    anatomy.facts["start"] = record_of(*start);
    // The cache names the index of a mesh by the digest of the mesh.
    anatomy.facts["digest"] = index_cache_file(*loaded.mesh, {}).stem().string();
  }
  return anatomy;
}

/// Returns the JSON for a script element: no text in it can end the element.
std::string in_script(const Json& json) {
  // A file name may be invalid UTF-8, which JSON does not allow.
  const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string safe;
  for (const char c : text) safe += c == '<' ? std::string("\\u003c") : std::string(1, c);
  return safe;
}

void write_anatomy(std::ostream& page, const LiveOptions& options,
                   const std::vector<Anatomy>& anatomy) {
  const MotionConstraintSettings& constraint = options.constraint;
  Json settings{{"format", "keepout live"},
                {"version", 1},
                {"keepout", KEEPOUT_VERSION},
                {"activation", constraint.activation},
                {"radius", constraint.options.radius},
                {"tool_radius", constraint.options.tool_radius},
                {"margin", constraint.options.margin},
                {"max_step", options.max_step},
                {"guides", options.guides},
                {"meshes", Json::array()}};
  if (!options.robot.empty()) settings["robot"] = options.robot;
  for (const Anatomy& one : anatomy) settings["meshes"].push_back(one.facts);
  page << R"(<script type="application/json" id="settings">)" << in_script(settings) << "</script>";
  for (std::size_t i = 0; i < anatomy.size(); ++i) {
    page << "\n<script type=\"application/octet-stream\" id=\"mesh-" << i << "\">"
         << anatomy[i].text << "</script>";
  }
}

/// Prints the last lines on the terminal.
void print_page(std::ostream& out, const LiveOptions& options, const std::string& url,
                std::uintmax_t size, bool opened) {
  out << options.page.string() << ", " << formatted("%.1f MB", 1e-6 * static_cast<double>(size))
      << (opened ? ", is being opened in a browser; or open it yourself:"
                 : "; open it in a browser:")
      << "\n  " << url << '\n'
      << (options.robot.empty()
              ? "Drag the red ring, which is your hand, into the anatomy: the ball is the tool, "
                "which "
                "follows\nas far as keepout allows."
              : "Drag the jaw into the anatomy: the instrument follows as far as keepout proves "
                "that shaft,\nwrist and jaw maintain their clearance.")
      << " Drag elsewhere to turn the view, and use the wheel to zoom.\n";
}

constexpr const char* recorded_only =
    "This page shows a recorded run only: the tool in it cannot be dragged. The engine inside a "
    "live "
    "page has the instrument of psm, and not that of a URDF file.";

/// Writes the page of a recorded run with the robot of a URDF file. Returns the exit status.
int record_run(const LiveOptions& options, std::ostream& out) {
  SimulateOptions run;
  run.meshes = options.meshes;
  run.load = options.load;
  run.files.page = options.page;
  run.constraint = options.constraint;
  run.guides = options.guides;
  run.strokes.count = manners.size();
  run.make_instrument = make_guarded_instrument;
  run.robot = options.robot;
  run.bodies = options.bodies;
  run.speeds = {1.0};
  run.notice = recorded_only;
  run.called_as = "";
  run.command = options.command;
  const int status = simulate(run, out);
  print_wrapped(out, recorded_only);
  if (status != exit_interrupted && options.opening == Opening::by_the_desktop &&
      !entry_of_open_file(options.page)) {
    open_in_browser(file_url(options.page));
  }
  return status;
}

}  // namespace

void add_live(CLI::App& app, LiveOptions& options) {
  CLI::App& command =
      *app.add_subcommand("live",
                          "Make a page that contains keepout and a mesh, in which you drag the "
                          "tool over the anatomy, and open it in the browser");
  command.add_option("MESH", options.meshes, std::string(mesh_help) + "; several to choose from")
      ->type_name("")
      ->capture_default_str();
  add_load_options(command, options.load);
  CLI::Option* const robot = add_robot(
      command, options.robot, options.bodies, {"psm"},
      "Drag the jaw of a whole instrument, in joint space, instead of a ball; the page of a URDF "
      "file shows a recorded run");
  command.add_option("--out", options.page, "Where to write the page")
      ->type_name("PAGE.html")
      ->check(name_of_page())
      ->capture_default_str();
  command.add_flag_callback(
      "--no-open", [&options] { options.opening = Opening::by_hand; },
      "Do not open the page in a browser");
  std::vector<std::string> rules = names(activation_rules());
  rules.emplace_back(no_fixture);
  add_name(command, "--activation", options.constraint.activation, std::move(rules),
           "Rule that chooses the planes; none: unguarded")
      ->excludes(robot);
  StepOptions& step = options.constraint.options;
  add_option_of(command, "tool_radius", step)->excludes(robot);
  add_option_of(command, "margin", step);
  add_option_of(command, "radius", step)->excludes(robot);
  const CLI::Option* const max_step =
      add_length(command, "--max-step", options.max_step, Zero::refused,
                 "Longest motion of the tool in a cycle of 1 ms");
  add_guides(command, options.guides);
  command.final_callback([&options, max_step] {
    if (is_robot_file(options.robot) && !max_step->empty()) {
      throw CLI::ValidationError(
          "--max-step", "the page of a URDF file shows a recorded run: use keepout simulate");
    }
    guides_of(options.guides, options.robot.empty() ? Guided::tip : Guided::instrument);
  });
  command.footer(
      "These options set the initial values of the page; there you can change them while the tool "
      "moves.\nThe page is one file that needs no server and no network. It contains the meshes: "
      "share it only if\nyou may share them.");
}

int live(const LiveOptions& options, std::ostream& out) {
  if (is_robot_file(options.robot)) return record_run(options, out);
  if (!options.robot.empty()) chosen_robot(options.robot, options.bodies);  // refuses --bodies
  if (options.robot.empty())
    require_within_reach(options.max_step, options.constraint.options.radius);
  const std::filesystem::path template_file = page_template_file("live.html");
  std::vector<NamedPath> inputs{{"the page template", template_file}};
  for (const std::filesystem::path& mesh : options.meshes) {
    inputs.push_back({"MESH", file_of_mesh(mesh)});
  }
  OutputFiles outputs(inputs, {{"--out", options.page}});
  std::vector<Anatomy> anatomy;
  {
    Progress progress("live", options.meshes.size());
    for (const std::filesystem::path& mesh : options.meshes) {
      progress.show(mesh.filename().string());
      anatomy.push_back(anatomy_of(mesh, options));
      progress.advance();
    }
  }
  const PageTemplate parts =
      read_page_template(template_file, "<!-- keepout live: the anatomy goes here -->");
  std::ostream& page = *outputs.stream("--out");
  page << parts.before;
  write_anatomy(page, options, anatomy);
  page << parts.after;
  outputs.commit();
  if (entry_of_open_file(options.page)) return EXIT_SUCCESS;  // a browser cannot open it
  const std::string url = file_url(options.page);
  const bool opened = options.opening == Opening::by_the_desktop && open_in_browser(url);
  print_page(out, options, url, std::filesystem::file_size(options.page), opened);
  return EXIT_SUCCESS;
}

}  // namespace keepout::app
