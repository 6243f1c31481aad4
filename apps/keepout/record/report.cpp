// SPDX-License-Identifier: BSD-3-Clause
#include "record/report.h"

#include <CLI/CLI.hpp>
#include <array>
#include <fstream>
#include <ostream>

#include "keepout/error.h"
#include "record/plain_page.h"
#include "record/record.h"
#include "record/report_page.h"
#include "shared/number_text.h"
#include "shared/output_file.h"
#include "shared/progress.h"

namespace keepout::app {
namespace {

/// Returns the page of a record: skull.html for skull.json and skull.html.json.
std::filesystem::path page_of(const std::filesystem::path& record) {
  std::filesystem::path page = record;
  if (page.extension() == ".json") page.replace_extension();
  return page.extension() == ".html" ? page : std::filesystem::path(page.string() + ".html");
}

Json read_record(const std::filesystem::path& path) {
  std::ifstream file = open_record(path);
  constexpr int deepest = 64;  // nesting; our records have at most ten levels
  const auto is_shallow = [](int depth, Json::parse_event_t, const Json&) {
    if (depth > deepest) throw Error("nested too deeply");
    return true;
  };
  Json record;
  try {
    record = Json::parse(file, is_shallow, false);
  } catch (const Error&) {
    record = nullptr;
  }
  if (const std::string fault = fault_of(record); !fault.empty()) {
    throw Error(path.string() + ": " + fault);
  }
  return record;
}

}  // namespace

void add_report(CLI::App& app, ReportOptions& options) {
  CLI::App& command = *app.add_subcommand(
      "report", "Make the report of a record that another command wrote with --json");
  command.add_option("FILE", options.record, "The record")->type_name(".json")->required();
  command
      .add_option("--out", options.page, "Where to write the report; default: beside the record")
      ->type_name("REPORT.html")
      ->check(name_of_page());
}

void report(const ReportOptions& options, std::ostream& out) {
  Progress progress("report", 2);
  const Json record = read_record(options.record);
  progress.advance();
  const std::filesystem::path page = options.page.value_or(page_of(options.record));
  OutputFiles outputs(std::array{NamedPath{"FILE", options.record}}, {{"--out", page}});
  // Other commands have already made a plain page of their record, but `experiments` has not.
  const bool is_first = record.at("keepout_record") == "experiments";
  const std::string missing = is_first ? missing_template(record) : "";
  if (missing.empty()) {
    print_report(*outputs.stream("--out"), record);
  } else {
    try {
      print_plain_page(*outputs.stream("--out"), record);
    } catch (const Json::exception&) {
      throw Error(options.record.string() +
                  ": is no whole record: a table or a picture of an experiment is damaged");
    }
    out << "a plain page of tables and pictures: " << missing << '\n';
  }
  outputs.commit();
  progress.interrupt();
  out << for_terminal(record.at("headline").get<std::string>()) << "\nreport: " << page.string()
      << '\n';
}

}  // namespace keepout::app
