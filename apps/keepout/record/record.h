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
}

namespace keepout::app {

// A record is what a command found, as docs/records.md describes it; a report is a page that shows
// one.

/// What every record has. A command adds the rest.
struct RecordHead {
  std::string_view kind = {};     // "simulate", "bench", ...
  std::string date = date_now();  // ISO 8601, UTC
  std::string command = {};       // that does it again
  bool complete = true;
  std::string subject = {};               // what was done, in a line
  std::string headline = {};              // what came out, in a sentence
  std::vector<std::string> account = {};  // what is to be said beside it
  std::optional<Machine> machine = {};    // none: several
  Json settings = Json::object();         // what it was told: names and values
};
Json new_record(const RecordHead& head);

/// Opens a record to be read. Throws Error if there is none, or a folder.
std::ifstream open_record(const std::filesystem::path& path);

/// Why this is no record of the format that is known, as far as its head goes; empty where it is.
std::string fault_of(const Json& json);

/// The files that a command writes: its record, its report, and its rows as a table.
struct RecordFiles {
  std::optional<std::filesystem::path> json, page, csv = {};

  /// Adds --json and --out to a command; a `page` that is set is the one by default.
  void add_to(CLI::App& command);

  /// Returns the JSON file to write. Without --json, if the report will be a plain page
  /// (see write_record), it is kept beside the page, so that the report can be made later; unless
  /// the page goes to stdout or another open file.
  std::optional<std::filesystem::path> kept_json() const;

  /// Returns the names of all files that are written, as a list for a sentence.
  std::string names() const;

  /// Opens all of them: "--json", "--csv" and "--out". Throws Error as OutputFiles and file_of_mesh
  /// do. `meshes`: files and fixtures that the command reads. `option`: what the user calls them.
  template <class Meshes = std::initializer_list<std::filesystem::path>>
  OutputFiles open(const Meshes& meshes, std::string_view option = "MESH") const {
    std::vector<NamedPath> inputs;
    for (const auto& mesh : meshes) inputs.push_back({option, file_of_mesh(mesh)});
    return {inputs, {{"--out", page}, {"--csv", csv}, {"--json", kept_json()}}};
  }
};

/// Writes a record to the stream "--json" and its report to "--out", as far as these are among the
/// outputs, and commits them. Without the front end of pages (see page_template.h) the report is a
/// plain page of tables, and a notice says so.
void write_record(OutputFiles& outputs, const Json& record, const RecordFiles& files);

/// The record itself, in lines that can be read and compared.
void print_json(std::ostream& out, const Json& record);

/// Prints a text, or each of a list, in lines that fit a terminal.
void print_wrapped(std::ostream& out, const Json& text);

}  // namespace keepout::app
