// SPDX-License-Identifier: BSD-3-Clause
#include "record/record.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <fstream>
#include <ostream>
#include <sstream>

#include "keepout/error.h"
#include "keepout/version.h"
#include "record/json_parts.h"
#include "record/plain_page.h"
#include "record/report_page.h"
#include "shared/names.h"
#include "shared/number_text.h"
#include "shared/progress.h"

namespace keepout::app {
namespace {

constexpr int oldest_format = 1;
constexpr int format = 2;  // see docs/records.md

/// Prints JSON with one line for each member of the outer objects and each entry of their arrays.
void print_lines(std::ostream& out, const Json& value, int depth) {
  const bool has_lines =
      !value.empty() && ((value.is_object() && depth < 2) ||
                         (value.is_array() && depth < 3 && value.front().is_structured()));
  if (!has_lines) {
    // A file name may be invalid UTF-8, which JSON does not allow.
    out << value.dump(-1, ' ', false, Json::error_handler_t::replace);
    return;
  }
  const bool is_object = value.is_object();
  out << (is_object ? '{' : '[');
  const char* between = "\n";
  for (const auto& [key, member] : value.items()) {
    out << std::exchange(between, ",\n");
    if (is_object) out << Json(key).dump() << ": ";
    print_lines(out, member, depth + 1);
  }
  out << (is_object ? "\n}" : "\n]");
}

/// Returns the number of characters, not bytes: our texts are in UTF-8.
std::size_t characters_in(const std::string& word) {
  std::size_t width = 0;
  for (const char c : word) width += (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  return width;
}

}  // namespace

Json new_record(const RecordHead& head) {
  return {{"keepout_record", head.kind}, {"format", format},          {"version", KEEPOUT_VERSION},
          {"date", head.date},           {"command", head.command},   {"complete", head.complete},
          {"subject", head.subject},     {"headline", head.headline}, {"account", head.account},
          {"machine", head.machine},     {"settings", head.settings}};
}

std::ifstream open_record(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::error_code none;
  if (std::filesystem::is_directory(path, none)) {
    throw Error(path.string() + ": is a folder; name a record in it");
  }
  if (!file) throw Error(path.string() + ": cannot be read; does it exist?");
  return file;
}

std::string fault_of(const Json& json) {
  constexpr std::array kinds{"simulate",     "simulate_robot", "bench",      "speed",
                             "compare",      "plan",           "plan_robot", "verify",
                             "verify_robot", "experiments",    "inspect"};
  const std::string none =
      "is no whole record; 'keepout simulate', 'bench', 'compare', 'plan' and 'verify' write "
      "records with --json";
  if (!json.is_object() || !json.contains("keepout_record") || !json.contains("format") ||
      std::ranges::find(kinds, json["keepout_record"]) == kinds.end()) {
    return none;
  }
  if (json["format"] < oldest_format || json["format"] > format) {
    return "is a record of format " + json["format"].dump() + ", and this keepout reads format " +
           std::to_string(oldest_format) + " to " + std::to_string(format);
  }
  const Json head = new_record({});
  const bool is_whole = std::ranges::all_of(head.items(), [&](const auto& member) {
    return json.contains(member.key()) && (json[member.key()].type() == member.value().type() ||
                                           member.key() == "machine" || member.key() == "format");
  });
  const bool has_texts =
      is_whole && std::ranges::all_of(json["account"].get<std::vector<Json>>(), &Json::is_string);
  return has_texts ? "" : none;
}

CLI::Validator name_of_page() {
  const auto check = [](const std::string& text) -> std::string {
    const std::string extension = std::filesystem::path(text).extension().string();
    if (extension.empty() || extension == ".html" || extension == ".htm") return "";
    return "expected a name that ends with .html, as it is an HTML page, not '" + text + "'";
  };
  return {check, ""};
}

void RecordFiles::add_to(CLI::App& command) {
  command.add_option("--json", json, "Where to write all results as JSON: see docs/records.md")
      ->type_name("FILE");
  CLI::Option* out =
      command.add_option("--out", page, "Where to write a report with pictures, plots and tables")
          ->type_name("REPORT.html")
          ->check(name_of_page());
  if (page) out->default_str(page->string());
}

std::optional<std::filesystem::path> RecordFiles::kept_json() const {
  if (json || !page || entry_of_open_file(*page) || missing_template().empty()) return json;
  return page->string() + ".json";
}

std::string RecordFiles::names() const {
  std::vector<std::string> names;
  for (const auto& path : {page, kept_json(), csv}) {
    if (path) names.push_back(path->string());
  }
  return listed(names);
}

void write_record(OutputFiles& outputs, const Json& record, const RecordFiles& files) {
  Progress progress("writing", 1);
  if (std::ostream* const json = outputs.stream("--json")) print_json(*json, record);
  if (std::ostream* const page = outputs.stream("--out")) {
    const std::string missing = missing_template(record);
    if (missing.empty()) {
      print_report(*page, record);
    } else {
      print_plain_page(*page, record);
      progress.interrupt();
      notices() << "keepout: " << files.page->string()
                << " is a plain page of tables, without pictures and plots: " << missing << ".\n";
      if (const auto kept = files.kept_json()) {
        notices() << "Once the template is there, the command 'report " << kept->string()
                  << "' makes the whole page.\n";
      }
    }
  }
  outputs.commit();
}

void print_json(std::ostream& out, const Json& record) {
  print_lines(out, record, 0);
  out << '\n';
}

void print_wrapped(std::ostream& out, const Json& text) {
  constexpr std::size_t longest = 88;
  if (text.is_array()) {
    for (const Json& one : text) print_wrapped(out, one);
    return;
  }
  std::istringstream words(for_terminal(text.get<std::string>()));
  std::size_t width = 0;
  for (std::string word; words >> word;) {
    const std::size_t more = characters_in(word);
    if (width > 0) {
      const bool fits = width + 1 + more <= longest;
      out << (fits ? ' ' : '\n');
      width = fits ? width + 1 : 0;
    }
    out << word;
    width += more;
  }
  out << '\n';
}

}  // namespace keepout::app
