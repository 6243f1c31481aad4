// SPDX-License-Identifier: BSD-3-Clause
//
// The exports of keepout to a web page: the page makes anatomy of a surface, a file or a shape, and
// tools on anatomy, with the parts and in the way of the command. No export throws: one that fails
// to make an object or a text returns null, and keepout_failure says why. Texts stay valid until
// the next call that returns one; all are UTF-8.
#include <cstddef>
#include <cstdint>
#include <exception>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "anatomy.h"
#include "json_text.h"
#include "keepout/fixtures/counterexamples.h"
#include "keepout/fixtures/shapes.h"
#include "keepout/mesh/doctor.h"
#include "keepout/mesh/load_mesh.h"
#include "shared/findings.h"
#include "tool.h"

namespace {

using keepout::Vec3;
using keepout::web::json;
using keepout::web::json_list;

std::string failure;  // reason why the last call that returned null failed
std::string text;     // the last one that was handed out

/// Returns what make() returns; `otherwise`, with a message, where it throws.
template <class Make, class Result>
Result made(const Make& make, Result otherwise) noexcept {
  try {
    return make();
  } catch (const std::bad_alloc&) {
    failure = "there is not enough memory for it";
  } catch (const std::exception& error) {
    failure = error.what();
  }
  return otherwise;
}

Anatomy* made_anatomy(const auto& make) noexcept {
  return made([&] { return new Anatomy(make()); }, static_cast<Anatomy*>(nullptr));
}

Tool* made_tool(const auto& make) noexcept {
  return made([&] { return make().release(); }, static_cast<Tool*>(nullptr));
}

const char* made_text(const auto& make) noexcept {
  return made(
      [&] {
        text = make();
        return text.c_str();
      },
      static_cast<const char*>(nullptr));
}

}  // namespace

/// The vertices (vertex_count, 3) [mm] and the corners (triangle_count, 3) of a mesh, as they lie
/// in memory.
struct Surface {
  const double* vertices;
  std::size_t vertex_count;
  const std::uint32_t* corners;
  std::size_t triangle_count;
};

extern "C" {

/// Why the last call that returned null failed, and what to do about it.
const char* keepout_failure() { return failure.c_str(); }

/// Anatomy of a surface whose equal vertices are one already: vertices (vertex_count, 3) in mm,
/// corners (triangle_count, 3). It is copied.
Anatomy* keepout_anatomy_of_surface(const double* vertices, std::uint32_t vertex_count,
                                    const std::uint32_t* corners, std::uint32_t triangle_count) {
  return made_anatomy([&] {
    keepout::Surface surface;
    surface.vertices.reserve(vertex_count);
    for (std::size_t v = 0; v < vertex_count; ++v) surface.vertices.emplace_back(vertices + 3 * v);
    surface.triangles.reserve(triangle_count);
    for (std::size_t t = 0; t < triangle_count; ++t) {
      const std::uint32_t* const c = corners + 3 * t;
      surface.triangles.push_back({c[0], c[1], c[2]});
    }
    return surface;
  });
}

/// Anatomy of a file of the file system in memory: STL, PLY, OBJ or OFF, in mm.
Anatomy* keepout_anatomy_of_file(const char* path) {
  return made_anatomy(
      [&] { return keepout::load_mesh(path, {.check = keepout::MeshCheck::none}); });
}

/// Anatomy of a generated shape: keepout_shapes() has the names.
Anatomy* keepout_anatomy_of_shape(const char* name) {
  return made_anatomy([&] { return keepout::make_shape(name); });
}

/// Frees anatomy. The caller must discard the tools on it first.
void keepout_discard_anatomy(Anatomy* anatomy) { delete anatomy; }

/// Returns the surface of anatomy, which stays valid until the next call.
const Surface* keepout_surface(const Anatomy* anatomy) {
  static_assert(sizeof(Vec3) == 24 && sizeof(keepout::Corners) == 12);
  static Surface surface;
  const keepout::Mesh& mesh = *anatomy->mesh;
  surface = {mesh.vertices().data()->data(), mesh.vertex_count(), mesh.triangles().data()->data(),
             mesh.triangle_count()};
  return &surface;
}

/// What is to be known of the mesh, as JSON: watertight, size, the warnings of its file, and the
/// findings of `keepout inspect` but for self-intersections, the worst first. Null on failure.
const char* keepout_findings(const Anatomy* anatomy) {
  return made_text([&] {
    const keepout::MeshFindings mesh = examine(*anatomy->mesh);
    const auto findings = keepout::app::findings_of(mesh, std::nullopt);
    const auto object = [](const keepout::app::Finding& finding) {
      return R"({"key":)" + json(finding.key) + R"(,"count":)" + json(finding.count) +
             R"(,"text":)" + json(text_of(finding)) + R"(,"advice":)" + json(finding.advice) + '}';
    };
    return std::string(R"({"watertight":)") + (mesh.is_watertight() ? "true" : "false") +
           R"(,"size":)" + json_list(mesh.bounds.size()) + R"(,"warnings":)" +
           json_list(anatomy->warnings) + R"(,"findings":)" + json_list(findings, object) + '}';
  });
}

/// Returns the distance from a place to the nearest triangle, below 0 inside a watertight mesh, NaN
/// where it is not known. [mm]
double keepout_clearance(Anatomy* anatomy, double x, double y, double z) {
  return made(
      [&] {
        return anatomy->clearance({x, y, z});
      },
      std::numeric_limits<double>::quiet_NaN());
}

/// See make_tip().
Tool* keepout_make_tip(Anatomy* anatomy, const char* rule, const TipSettings* settings) {
  return made_tool([&] { return make_tip(*anatomy, rule, *settings); });
}

/// See make_instrument().
Tool* keepout_make_instrument(Anatomy* anatomy, const char* robot,
                              const InstrumentSettings* settings) {
  return made_tool([&] { return make_instrument(*anatomy, robot, *settings); });
}

/// Frees a tool.
void keepout_discard_tool(Tool* tool) { delete tool; }

/// Returns the facts of a tool as JSON: numbers of a position, band [mm], period [s], and name and
/// radius [mm] of each body.
const char* keepout_tool_facts(const Tool* tool) { return tool->facts.c_str(); }

/// See Tool::place().
const Cycle* keepout_place(Tool* tool, const double* positions) {
  tool->cycle = {};
  tool->place(positions);
  return &tool->cycle;
}

/// See Tool::follow().
const Cycle* keepout_follow(Tool* tool, const double* hand) {
  tool->follow(hand);
  return &tool->cycle;
}

/// See Tool::step().
const Cycle* keepout_step(Tool* tool, const double* asked) {
  tool->step(asked);
  return &tool->cycle;
}

/// See Tool::clearance(); NaN if there is no memory for it.
double keepout_body_clearance(Tool* tool, std::uint32_t body) {
  return made([&] { return tool->clearance(body); }, std::numeric_limits<double>::quiet_NaN());
}

/// Returns all statuses by number, as a JSON list of objects: name, and reason, one line on what it
/// means and what to do about it. `subject`: 0 a tip, 1 an instrument.
const char* keepout_statuses(std::uint32_t subject) {
  return made_text([&] {
    std::vector<keepout::Status> all;
    for (keepout::Status next{}; name(next) != "unknown";) {
      all.push_back(next);
      next = static_cast<keepout::Status>(all.size());
    }
    return json_list(all, [&](keepout::Status status) {
      return R"({"name":)" + json(name(status)) + R"(,"reason":)" +
             json(reason(status, static_cast<keepout::Subject>(subject))) + '}';
    });
  });
}

/// The names of the generated shapes, as a JSON list.
const char* keepout_shapes() {
  return made_text([] {
    return json_list(keepout::shapes(),
                     [](const keepout::Shape& shape) { return json(shape.name); });
  });
}

/// The counterexamples to the paper's rule, as a JSON list of objects: name, vertices, triangles,
/// tip, desired, radius.
const char* keepout_counterexamples() {
  return made_text([] {
    const auto lists = [](const auto& rows) {
      return json_list(rows, [](const auto& row) { return json_list(row); });
    };
    return json_list(keepout::counterexamples(), [&](const keepout::Counterexample& example) {
      return R"({"name":)" + json(example.name) + R"(,"vertices":)" +
             lists(example.surface.vertices) + R"(,"triangles":)" +
             lists(example.surface.triangles) + R"(,"tip":)" + json_list(example.tip) +
             R"(,"desired":)" + json_list(example.desired) + R"(,"radius":)" +
             json(example.radius) + '}';
    });
  });
}

}  // extern "C"
