// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <initializer_list>
#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/columns.h"
#include "shared/machine.h"
#include "shared/named_mesh.h"
#include "shared/output_file.h"

namespace CLI {
class App;
class Validator;
}  // namespace CLI

namespace keepout::app {

// A record contains the results of a command (docs/records.md); a report is a page that shows one.

/// The common members of all records. A command adds the others.
struct RecordHead {
  std::string_view kind = {};     // "simulate", "bench", ...
  std::string date = date_now();  // ISO 8601, UTC
  std::string command = {};       // the command that repeats the run
  bool complete = true;
  std::string subject = {};               // the purpose of the run, in a line
  std::string headline = {};              // the result, in a sentence
  std::vector<std::string> account = {};  // further sentences about the result
  std::optional<Machine> machine = {};    // empty if there were several machines
  Json settings = Json::object();         // settings of the run: names and values
};
Json new_record(const RecordHead& head);

/// Opens a record for reading. Throws Error if it is missing or a directory.
std::ifstream open_record(const std::filesystem::path& path);

/// Returns why this is not a record of the known format, judged by its common members; empty if it
/// is.
std::string fault_of(const Json& json);

/// Accepts the name of an HTML page: with .html, .htm or no extension.
CLI::Validator name_of_page();

/// The files that a command writes: its record, its report, and its rows as a table.
struct RecordFiles {
  std::optional<std::filesystem::path> json, page, csv = {};

  /// Adds --json and --out to a command; if `page` is set, it is the default.
  void add_to(CLI::App& command);

  /// Returns the JSON file to write. Without --json, if the report will be a plain page (see
  /// write_record), the record is written beside the page, so that the report can be made later. It
  /// is not written if the page goes to stdout or another open file.
  std::optional<std::filesystem::path> kept_json() const;

  /// Returns the names of all files that are written, as a list for a sentence.
  std::string names() const;

  /// Opens the files of "--json", "--csv" and "--out". Throws Error as OutputFiles and file_of_mesh
  /// do. `meshes`: the meshes that the command reads. `option`: their name on the command line.
  /// `inputs`: other files that it reads.
  template <class Meshes = std::initializer_list<std::filesystem::path>>
  OutputFiles open(const Meshes& meshes, std::string_view option = "MESH",
                   std::vector<NamedPath> inputs = {}) const {
    for (const auto& mesh : meshes) inputs.push_back({option, file_of_mesh(mesh)});
    return {inputs, {{"--out", page}, {"--csv", csv}, {"--json", kept_json()}}};
  }
};

/// Writes a record to the stream "--json" and its report to "--out", as far as these are among the
/// outputs, and commits them. Without page templates (see page_template.h) the report is a plain
/// page of tables, and a notice reports it.
void write_record(OutputFiles& outputs, const Json& record, const RecordFiles& files);

/// Prints the record in lines that people and tools can compare.
void print_json(std::ostream& out, const Json& record);

/// Prints a text, or each text of a list, in lines that fit a terminal.
void print_wrapped(std::ostream& out, const Json& text);

}  // namespace keepout::app
