// SPDX-License-Identifier: BSD-3-Clause
#include "record/report_page.h"

#include <ostream>
#include <span>

#include "keepout/error.h"
#include "page/base64.h"
#include "page/gzip.h"
#include "page/page_template.h"

namespace keepout::app {
namespace {

constexpr const char* record_mark = "<!-- keepout report: the record goes here -->";

/// Returns the template for a record. Only the template for anatomy contains the code that draws
/// it.
PageTemplate template_for(const Json& record) {
  const std::string kind = record.value("keepout_record", "");
  const bool shows_anatomy = kind.starts_with("simulate") || kind == "plan" || kind == "inspect";
  return read_page_template(
      page_template_file(shows_anatomy ? "report_with_anatomy.html" : "report.html"), record_mark);
}

}  // namespace

std::string missing_template(const Json& record) {
  try {
    if (record.is_object()) {
      template_for(record);
    } else {
      for (const char* kind : {"simulate", "bench"}) template_for({{"keepout_record", kind}});
    }
  } catch (const Error& missing) {
    return missing.what();
  }
  return {};
}

void print_report(std::ostream& out, const Json& record) {
  const PageTemplate parts = template_for(record);
  const std::string text = record.dump(-1, ' ', false, Json::error_handler_t::replace);
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  out << parts.before << "<script type=\"application/octet-stream\" id=\"record\">"
      << to_base64(gzipped(bytes)) << "</script>" << parts.after;
}

}  // namespace keepout::app
