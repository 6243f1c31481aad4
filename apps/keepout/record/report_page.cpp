// SPDX-License-Identifier: BSD-3-Clause
#include "record/report_page.h"

#include <filesystem>
#include <ostream>
#include <span>

#include "keepout/error.h"
#include "page/base64.h"
#include "page/gzip.h"
#include "page/page_template.h"
#include "record/plain_page.h"

namespace keepout::app {
namespace {

constexpr const char* place = "<!-- keepout report: the record goes here -->";

/// What shows anatomy comes with what draws it.
std::filesystem::path template_for(const Json& record) {
  const auto kind = record.at("keepout_record").get<std::string>();
  return page_template_file(kind == "simulate" || kind == "plan" ? "report_with_anatomy.html"
                                                                 : "report.html");
}

}  // namespace

bool has_report_template() { return std::filesystem::exists(page_template_file("report.html")); }

std::string print_report(std::ostream& out, const Json& record) {
  PageTemplate parts;
  try {
    parts = read_page_template(template_for(record), place);
  } catch (const Error& missing) {
    print_plain_page(out, record);
    return missing.what();
  }
  const std::string text = record.dump(-1, ' ', false, Json::error_handler_t::replace);
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  out << parts.before << "<script type=\"application/octet-stream\" id=\"record\">"
      << to_base64(gzipped(bytes)) << "</script>" << parts.after;
  return {};
}

}  // namespace keepout::app
