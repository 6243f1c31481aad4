// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "serve/answer.h"

#include "serve/json_text.h"

namespace keepout::app {
namespace {

void append_vector(std::string& out, const Vec3& vector) {
  out += '[';
  append_number(out, vector.x());
  out += ',';
  append_number(out, vector.y());
  out += ',';
  append_number(out, vector.z());
  out += ']';
}

/// Of a step that is not ok there is none to tell, but a client who looks at nothing else shall
/// stand still.
void append_increment(std::string& out, const Step& step, std::size_t joints) {
  out += ",\"increment\":[";
  for (std::size_t i = 0; i < joints; ++i) {
    if (i > 0) out += ',';
    append_number(out, i < step.increment.size() ? step.increment[i] : 0.0);
  }
  out += ']';
}

template <class Ending>
void append_status(std::string& out, Ending status, bool is_ok) {
  out += is_ok ? "\"ok\":true,\"status\":" : "\"ok\":false,\"status\":";
  append_string(out, name(status));
}

template <class Ending>
void append_statuses(std::string& out, std::string_view key, Ending last, bool (*is_ok)(Ending)) {
  append_string(out, key);
  out += ":[";
  for (unsigned i = 0; i <= static_cast<unsigned>(last); ++i) {
    const auto status = static_cast<Ending>(i);
    out += i == 0 ? "{" : ",{";
    append_status(out, status, is_ok(status));
    out += ",\"reason\":";
    append_string(out, reason(status));
    out += '}';
  }
  out += ']';
}

}  // namespace

void begin_answer(std::string& out, std::string_view id) {
  out += "{\"id\":";
  out += id;
}

void end_answer(std::string& out) { out += "}\n"; }

void append_step(std::string& out, const Step& step, std::size_t joints) {
  append_status(out, step.status, step.ok());
  if (!step.ok()) {
    out += ",\"reason\":";
    append_string(out, step.reason());
  }
  out += ",\"motion\":";
  append_vector(out, step.motion);
  if (joints > 0) append_increment(out, step, joints);
  out += ",\"triangles\":";
  append_count(out, step.triangles);
  out += ",\"planes\":";
  append_count(out, step.planes.size());
  if (step.distance) {
    out += ",\"distance\":";
    append_number(out, *step.distance);
  }
}

void append_polytope(std::string& out, const Polytope& polytope) {
  append_status(out, polytope.status, polytope.ok());
  if (!polytope.ok()) {
    out += ",\"reason\":";
    append_string(out, polytope.reason());
  }
  out += ",\"normals\":[";
  for (const HalfSpace& plane : polytope.planes) {
    if (&plane != polytope.planes.data()) out += ',';
    append_vector(out, plane.normal);
  }
  out += "],\"offsets\":[";
  for (const HalfSpace& plane : polytope.planes) {
    if (&plane != polytope.planes.data()) out += ',';
    append_number(out, plane.offset);
  }
  out += ']';
}

void append_error(std::string& out, std::string_view id, std::string_view kind,
                  std::string_view message) {
  begin_answer(out, id);
  out += ",\"error\":{\"kind\":";
  append_string(out, kind);
  out += ",\"message\":";
  append_string(out, message);
  out += '}';
  end_answer(out);
}

std::string status_members() {
  std::string text;
  append_statuses<Status>(text, "statuses", Status::margin_too_small, &is_ok);
  text += ',';
  append_statuses<PolytopeStatus>(text, "polytope_statuses", PolytopeStatus::whole_tool,
                                  [](PolytopeStatus s) { return s == PolytopeStatus::found; });
  return text;
}

}  // namespace keepout::app
