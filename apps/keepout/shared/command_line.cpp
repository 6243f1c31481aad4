// SPDX-License-Identifier: BSD-3-Clause
#include "shared/command_line.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <system_error>

#include "keepout/activation/registry.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/adapters/narrow_phase_registry.h"
#include "keepout/error.h"
#include "keepout/factory/convex_tool_text.h"
#include "keepout/factory/guide_text.h"
#include "keepout/mesh/diagnostics.h"
#include "keepout/solvers/registry.h"
#include "shared/named_mesh.h"
#include "shared/names.h"
#include "shared/robot_file.h"

namespace keepout::app {
namespace {

/// Adds an option that takes the name of an anatomical space, in lower or upper case.
CLI::Option* add_space(CLI::App& command, const char* name, AnatomicalSpace& space,
                       const char* description) {
  const auto take = [&space](const std::string& word) { space = space_named(word).value(); };
  return command.add_option_function<std::string>(name, take, description)
      ->type_name("")
      ->check(one_of({"ras", "lps", "RAS", "LPS"}));
}

bool is_option(const std::string& word) { return word.size() > 1 && word.front() == '-'; }

std::string no_such_command(const CLI::App& app, const std::string& word) {
  if (word == run_command && app.get_name() == "./run") {
    return "'" + word + "' must be the first word: './run " + word + " ...'";
  }
  const std::vector<std::string> commands = command_names(app);
  const std::string hint = did_you_mean(word, commands);
  return "there is no command '" + word + "'" +
         (hint.empty() ? "; there are " + enumerated(commands) : hint);
}

std::string unknown_option(const CLI::App& app, const CLI::App& command, const std::string& word) {
  const std::string name = word.substr(0, word.find('='));
  if (app.get_option_no_throw(name) != nullptr) {
    return name + " must precede the command: '" + app.get_name() + " " + name + " ... " +
           command.get_name() + "'";
  }
  const std::string missing = "there is no option " + name;
  const bool reads_mesh = command.get_option_no_throw("MESH") != nullptr;
  const CLI::Option* const of_convert = app.get_subcommand("convert")->get_option_no_throw(name);
  if (reads_mesh && of_convert != nullptr) {
    const std::string value = of_convert->get_items_expected_max() > 0 ? " ..." : "";
    return missing + ": convert the mesh first, 'keepout convert IN OUT " + name + value +
           "', and name OUT";
  }
  return missing + did_you_mean(name, option_names(command));
}

/// Returns the message of CLI11, or a clearer one where CLI11 says too little.
std::string in_words(const CLI::App& app, const CLI::App& command, const CLI::ParseError& error) {
  const std::string told = error.what();
  const std::string kind = error.get_name();
  // If an option is mistyped, this is the most likely cause of the error.
  const std::vector<std::string> extra = app.remaining(true);
  const auto option = std::find_if(extra.begin(), extra.end(), is_option);
  if (option != extra.end()) return unknown_option(app, command, *option);
  if (&command == &app && !extra.empty()) return no_such_command(app, extra.front());
  if (&command == &app && kind == "RequiredError") {
    return "a command is missing; there are " + enumerated(command_names(app));
  }
  // get_name() of an ExtrasError returns the name of the command.
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) {
    return "'" + extra.front() + "' is one argument too many for " + command.get_name();
  }
  if (kind == "RequiredError") return "an argument is missing: " + told;
  if (kind == "ArgumentMismatch") {
    // "--radius: 1 required MM missing", "--radius: At Most 1 required but received 2"
    const std::size_t colon = told.find(':');
    const bool is_surplus = told.find("At Most") != std::string::npos;
    if (colon != std::string::npos) {
      return told.substr(0, colon) +
             (is_surplus ? ": this option is given more than once" : ": a value is missing");
    }
  }
  if (kind == "RequiresError") {
    const std::size_t verb = told.find(" requires ");
    if (verb != std::string::npos) {
      return told.substr(0, verb) + " can only be used together with " + told.substr(verb + 10);
    }
  }
  if (kind == "ExcludesError") {
    const std::size_t verb = told.find(" excludes ");
    if (verb != std::string::npos) {
      return told.substr(0, verb) + " and " + told.substr(verb + 10) + " cannot be given together";
    }
  }
  if (kind == "ConversionError") {
    // "Could not convert: --json = 3"
    constexpr std::string_view lead = "Could not convert: ";
    const std::size_t equals = told.find(" = ");
    if (told.starts_with(lead) && equals != std::string::npos) {
      return told.substr(lead.size(), equals - lead.size()) + ": '" + told.substr(equals + 3) +
             "' is not a value for it";
    }
  }
  return told;
}

}  // namespace

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
  }
  if (app.get_name() == "./run") names.emplace_back(run_command);
  return names;
}

std::vector<std::string> option_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

CLI::Validator one_of(std::vector<std::string> names) {
  std::string description = '{' + enumerated(names) + '}';
  const auto check = [names = std::move(names)](std::string& text) -> std::string {
    if (std::find(names.begin(), names.end(), text) != names.end()) return {};
    const std::string hint = did_you_mean(text, names);
    return "there is no '" + text + "'" + (hint.empty() ? "; there are: " : hint + " There are: ") +
           enumerated(names);
  };
  return {check, std::move(description)};
}

CLI::Validator number_within(double low, double high, std::string expected, std::string type) {
  const auto check = [=](const std::string& text) -> std::string {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    const bool is_decimal = text.find_first_of("xX") == std::string::npos;
    if (!text.empty() && is_decimal && *end == '\0' && value >= low && value <= high) return {};
    return "expected " + expected + ", not '" + text + "'";
  };
  return {check, std::move(type)};
}

CLI::Validator length(Zero zero) {
  if (zero == Zero::allowed) {
    return number_within(0.0, 1e30, "a number from 0 to 1e30", "NONNEGATIVE");
  }
  return number_within(std::numeric_limits<double>::denorm_min(), 1e30,
                       "a number above 0 and at most 1e30", "POSITIVE");
}

CLI::Validator whole_number(std::uint64_t low, std::uint64_t high) {
  const auto check = [low, high](std::string& text) -> std::string {
    std::uint64_t value = 0;
    const char* const last = text.data() + text.size();
    const auto [end, error] = std::from_chars(text.data(), last, value);
    bool is_whole = error == std::errc{} && end == last;
    if (!is_whole) {                               // for example 1e6
      constexpr double most = 9007199254740992.0;  // 2^53: larger doubles skip integers
      double number = 0.0;
      const auto [stop, fault] = std::from_chars(text.data(), last, number);
      is_whole = fault == std::errc{} && stop == last && number >= 0.0 && number <= most &&
                 number == std::floor(number) && text.find_first_of("eE") != std::string::npos;
      if (is_whole) value = static_cast<std::uint64_t>(number);
    }
    if (!is_whole || value < low || value > high) {
      return "expected a whole number from " + std::to_string(low) + " to " + std::to_string(high) +
             ", not '" + text + "'";
    }
    text = std::to_string(value);
    return {};
  };
  return {check, ""};
}

CLI::Validator not_empty() {
  const auto check = [](const std::string& text) -> std::string {
    return text.empty() ? "expected a value, not ''" : "";
  };
  return {check, ""};
}

CLI::Option* add_length(CLI::App& command, const std::string& name, double& value, Zero zero,
                        const std::string& description) {
  return command.add_option(name, value, description)
      ->type_name("MM")
      ->check(length(zero))
      ->capture_default_str();
}

CLI::Option* add_name(CLI::App& command, const std::string& name, std::string& value,
                      std::vector<std::string> names, const std::string& description) {
  return command.add_option(name, value, description)
      ->check(one_of(std::move(names)))
      ->capture_default_str();
}

void add_mesh(CLI::App& command, std::filesystem::path& mesh) {
  command.add_option("MESH", mesh, std::string(mesh_help))->type_name("")->required();
}

void add_load_options(CLI::App& command, LoadOptions& load) {
  add_space(command, "--space", load.space,
            "Anatomical space of the mesh in memory: the mesh is converted if the file states the "
            "other one with SPACE=LPS or SPACE=RAS. Default: as in the file");
  add_space(command, "--untagged", load.untagged,
            "Anatomical space of a file that does not state one");
  std::vector<std::string> units;
  for (const UnitGuess& known : length_units()) units.emplace_back(known.unit);
  CLI::Option* const unit =
      command
          .add_option("--unit", load.unit,
                      "Unit of the lengths in the file, which are scaled to mm. Default: mm")
          ->type_name("")
          ->check(one_of(std::move(units)));
  command
      .add_option("--scale", load.scale,
                  "Factor from lengths in the file to mm, for a unit without a name")
      ->check(number_within(1e-30, 1e30, "a number from 1e-30 to 1e30", "NUMBER"))
      ->type_name("NUMBER")
      ->excludes(unit);
  command.add_flag("--flip", load.flip,
                   "Reverse the winding of each triangle, if the normals point into the solid");
}

CLI::Option* add_plugins(CLI::App& command) {
  const auto load = [](const std::vector<std::string>& files) {
    for (const std::string& file : files) {
      if (!std::filesystem::is_regular_file(file))
        throw Error("--plugin: there is no file " + file);
      const std::string path = std::filesystem::absolute(file);
      if (add_index_backends(path) + add_solver_backends(path) > 0) continue;
      throw Error("the plugin " + path +
                  " exports no parts: it needs a table keepout_indices or keepout_solvers");
    }
  };
  return command
      .add_option_function<std::vector<std::string>>(
          "--plugin", load,
          "Shared objects with indices or solvers of your own: docs/adding_a_backend.md")
      ->delimiter(',')
      ->type_name("FILES");
}

void add_constraint_options(CLI::App& command, MotionConstraintSettings& settings) {
  add_plugins(command);
  add_part(command, "--index", settings.index, index_names(), index_backends,
           "Spatial index that finds triangles");
  command
      .add_option("--index-cache", settings.index_cache,
                  "Directory that stores the structure built by --index wide_bvh for the next run")
      ->type_name("FOLDER");
  add_part(command, "--solver", settings.solver, solver_names(), solver_backends,
           "Solver of the optimization problem of a step");
  for (const auto& option : step_options) add_option_of(command, option, settings.options);
  for (const auto& option : motion_settings) {
    if (option.kind != OptionKind::part) add_option_of(command, option, settings);
  }
}

void add_activation(CLI::App& command, std::string& activation) {
  add_name(command, "--activation", activation, names(activation_rules()),
           "Rule that chooses the planes");
}

void add_convex_tool(CLI::App& command, MotionConstraintSettings& settings) {
  const auto take = [&settings](const std::string& text) {
    try {
      settings.tool = tool_of_text(text);
    } catch (const Error& error) {
      throw CLI::ValidationError("--tool", error.what());
    }
  };
  CLI::Option* tool =
      command
          .add_option_function<std::string>(
              "--tool", take,
              "A convex tool, instead of the ball, that must not touch the surface; it does not "
              "turn. The tip is its origin, and a blade extends from it along z. One of: " +
                  std::string(convex_tool_forms))
          ->type_name("TOOL")
          ->excludes(command.get_option("--tool-radius"));
  add_part(
      command, "--narrow-phase", settings.narrow_phase, narrow_phase_names(), narrow_phase_backends,
      "Narrow phase that proposes the planes of --tool; each proposed plane is proved before use")
      ->needs(tool);
}

CLI::Option* add_robot(CLI::App& command, std::string& robot, std::filesystem::path& bodies,
                       std::vector<std::string> names, const std::string& help) {
  const auto check = [known = one_of(names)](std::string& text) -> std::string {
    if (!is_robot_file(text)) {
      const std::string problem = known(text);
      return problem.empty() ? "" : problem + "; or name a URDF file, such as my.urdf";
    }
    std::error_code none;
    return std::filesystem::exists(text, none) ? "" : "there is no file '" + text + "'";
  };
  CLI::Option* const option =
      command.add_option("--robot", robot, help + ": a name, or a URDF file of yours")
          ->check(CLI::Validator(check, '{' + enumerated(names) + ", FILE.urdf}"));
  command
      .add_option("--bodies", bodies,
                  "Bodies of the robot of a URDF file: docs/robots.md. Default: its collision "
                  "elements, or capsules that enclose them")
      ->type_name("FILE.json")
      ->check(not_empty())
      ->needs(option);
  return option;
}

CLI::Option* add_guides(CLI::App& command, std::vector<std::string>& guides) {
  const auto is_guide = [](const std::string& text) -> std::string {
    try {
      guide_of_text(text);
      return {};
    } catch (const Error& error) {
      return error.what();
    }
  };
  std::string help =
      "A region that the tip must not leave; may be given several times. [NAME=] and one of: " +
      std::string(region_forms);
  if (command.get_option_no_throw("--robot") != nullptr) {
    help += ". With --robot, for a link: " + std::string(guide_forms);
  }
  return command.add_option("--guide", guides, help)
      ->type_name("GUIDE")
      ->check(CLI::Validator(is_guide, ""))
      ->allow_extra_args(false);  // the next word may be the mesh
}

std::string unknown_command(const CLI::App& app, const std::string& word) {
  return no_such_command(app, word) + "\nSee '" + app.get_name() + " --help'.";
}

std::vector<Guide> guides_of(std::span<const std::string> texts, Guided guided) {
  if (texts.size() > Guide::most) {
    throw CLI::ValidationError("--guide", "at most " + std::to_string(Guide::most) +
                                              " guides, not " + std::to_string(texts.size()));
  }
  std::vector<Guide> guides;
  for (const std::string& text : texts) {
    const Guide& guide = guides.emplace_back(guide_of_text(text));
    const bool is_of_tip = guide.kind() == Guide::Kind::point && guide.link() == 0 &&
                           guide.first().position.isZero(0.0);
    if (guided == Guided::tip ? is_of_tip : guide.link() > 0) continue;
    const std::string forms(guided == Guided::tip ? region_forms : guide_forms);
    throw CLI::ValidationError(
        "--guide", "'" + text + "' is " +
                       (guided == Guided::tip ? "for a link of an instrument, but this is a tip"
                                              : "for a tip, but this is an instrument") +
                       ": write [NAME=] and one of " + forms);
  }
  return guides;
}

void refuse_empty_items(const CLI::App& command, std::span<const std::string> words) {
  const CLI::Option* open = nullptr;  // to which the next words belong
  for (const std::string& word : words) {
    const std::size_t equals = is_option(word) ? word.find('=') : std::string::npos;
    if (is_option(word)) open = command.get_option_no_throw(word.substr(0, equals));
    if (is_option(word) && equals == std::string::npos) continue;
    if (open == nullptr || open->get_delimiter() != ',') continue;
    const std::string list = equals == std::string::npos ? word : word.substr(equals + 1);
    if ((',' + list + ',').find(",,") == std::string::npos) continue;
    throw CLI::ValidationError(open->get_name(),
                               "expected a value before and behind each comma, not '" + list + "'");
  }
}

std::string usage_error(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  const CLI::App& command = chosen.empty() ? app : *chosen.front();
  const std::string words = in_words(app, command, error);
  const bool is_of_all =
      app.get_option_no_throw(words.substr(0, words.find_first_of(": "))) != nullptr;
  return words + "\nSee '" + app.get_name() +
         (chosen.empty() || is_of_all ? "" : " " + command.get_name()) + " --help'.";
}

}  // namespace keepout::app
