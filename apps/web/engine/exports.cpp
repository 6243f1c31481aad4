// SPDX-License-Identifier: BSD-3-Clause
//
// The interface of keepout to a web page, bound by Embind. The page makes anatomy from a surface, a
// file or a shape, and tools on anatomy, with the same parts as the command. A function that fails
// throws a JavaScript Error. src/engine/keepout.ts declares this interface for TypeScript.
#include <emscripten/bind.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "anatomy.h"
#include "keepout/error.h"
#include "keepout/fixtures/counterexamples.h"
#include "keepout/fixtures/shapes.h"
#include "keepout/index/query.h"
#include "keepout/mesh/diagnostics.h"
#include "keepout/mesh/load_mesh.h"
#include "keepout/status.h"
#include "shared/findings.h"
#include "tool.h"

namespace {

using emscripten::typed_memory_view;
using emscripten::val;
using keepout::Vec3;

/// Returns the result of make(). Converts its exceptions into a JavaScript Error with the same
/// message.
auto or_error(const auto& make) {
  std::string message;
  try {
    return make();
  } catch (const std::bad_alloc&) {
    message = "there is not enough memory for it";
  } catch (const std::exception& error) {
    message = error.what();
  }
  val::global("Error").new_(message).throw_();
}

/// Returns a JavaScript value.
template <class T>
val value(const T& of) {
  if constexpr (std::is_convertible_v<const T&, std::string_view>) {
    return val(std::string(std::string_view(of)));
  } else {
    return val(of);
  }
}

/// Returns a JavaScript array of the results of `item`.
val list(const auto& range, const auto& item) {
  val all = val::array();
  for (const auto& each : range) all.call<void>("push", item(each));
  return all;
}
val list(const auto& range) {
  return list(range, [](const auto& each) { return value(each); });
}

/// Returns a JavaScript object; arguments are names and members in turn.
val object(const auto&... names_and_members) {
  val made = val::object();
  const auto fill = [&](const auto& self, const char* name, const auto& member,
                        const auto&... rest) {
    made.set(name, value(member));
    if constexpr (sizeof...(rest) > 0) self(self, rest...);
  };
  fill(fill, names_and_members...);
  return made;
}

/// Returns memory with triples of numbers as a typed array.
val view(const auto& triples) {
  return val(typed_memory_view(3 * triples.size(), triples.data()->data()));
}

/// Returns the anatomy of a surface without duplicate vertices: vertices (n, 3) in mm, and corners
/// (m, 3), as typed arrays, which are copied.
Anatomy* anatomy_of_surface(const val& vertices, const val& corners) {
  return or_error([&] {
    keepout::Surface surface;
    surface.vertices.resize(vertices["length"].as<std::size_t>() / 3);
    surface.triangles.resize(corners["length"].as<std::size_t>() / 3);
    view(surface.vertices).call<void>("set", vertices);
    view(surface.triangles).call<void>("set", corners);
    return new Anatomy(std::move(surface));
  });
}

/// Returns the anatomy of the bytes of a mesh file, whose name states the format: STL, PLY, OBJ,
/// OFF or VTK, in mm.
Anatomy* anatomy_of_file(const std::string& name, const val& content) {
  return or_error([&] {
    const auto bytes = emscripten::convertJSArrayToNumberVector<std::uint8_t>(content);
    // The file system is in memory.
    std::FILE* const file = std::fopen(name.c_str(), "wb");
    if (file == nullptr) throw keepout::Error("a file cannot be named '" + name + "'");
    const bool is_whole = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
    const std::unique_ptr<const char, int (*)(const char*)> removal(name.c_str(), std::remove);
    if (std::fclose(file) != 0 || !is_whole) throw std::bad_alloc();
    return new Anatomy(keepout::load_mesh(name, {.check = keepout::MeshCheck::none}));
  });
}

/// Returns the anatomy of a generated shape; shapes() returns the names.
Anatomy* anatomy_of_shape(const std::string& name) {
  return or_error([&] { return new Anatomy(keepout::make_shape(name)); });
}

/// Returns the coordinates (n, 3) [mm] and the corners (m, 3) of a mesh as views, which stay valid
/// until the engine's memory grows.
val surface(const Anatomy& anatomy) {
  static_assert(sizeof(Vec3) == 24 && sizeof(keepout::Corners) == 12);
  return object("vertices", view(anatomy.mesh->vertices()), "corners",
                view(anatomy.mesh->triangles()));
}

/// Returns the facts of the mesh: watertight, size, the warnings of its file, and the findings of
/// `keepout inspect` except self-intersections, the worst first.
val findings(const Anatomy& anatomy) {
  return or_error([&] {
    const keepout::MeshFindings mesh = examine(*anatomy.mesh);
    const auto told = [](const keepout::app::Finding& finding) {
      return object("text", text_of(finding), "advice", finding.advice);
    };
    return object("watertight", mesh.is_watertight(), "size", list(mesh.bounds.size()), "warnings",
                  list(anatomy.warnings), "findings",
                  list(keepout::app::findings_of(mesh, std::nullopt), told));
  });
}

/// Returns true if the surface is between two positions, or touches the segment between them.
bool is_between(const Anatomy& anatomy, double x, double y, double z, double u, double v,
                double w) {
  constexpr double touch = 0.01;  // [mm]
  const Vec3 from(x, y, z);
  const Vec3 way = Vec3(u, v, w) - from;
  const double length = way.norm();
  keepout::NearestTriangle nearest(*anatomy.mesh, *anatomy.index);
  // No surface is nearer than the distance, so this advance crosses none.
  for (double along = 0.0; along < length;) {
    const double distance = nearest(from + (along / length) * way).closest.distance;
    if (distance < touch) return true;
    along += distance;
  }
  return false;
}

/// See make_tool().
Tool* tool_on(Anatomy& anatomy, const val& settings) {
  return or_error([&] { return make_tool(anatomy, settings).release(); });
}

/// Returns a guide as a page draws it: its name, the kind of its region, and the region.
val drawn(const keepout::Guide& guide) {
  constexpr std::array kinds{"half_space", "slab", "tube", "ball"};
  const keepout::Region& region = guide.region();
  return object("name", guide.name(), "isAngular", guide.is_angular(), "kind",
                kinds[static_cast<std::size_t>(region.kind())], "origin", list(region.origin()),
                "direction", list(region.direction()), "radius", region.radius());
}

/// Returns the constant properties of a tool. They are the count of numbers of a position, the
/// curvature allowance [mm], the period of a cycle [s], and names and radii of bodies [mm]. Also
/// returns the point that follows the hand, as a link and a position in its frame, and the guides.
val facts(const Tool& tool) {
  const auto body = [](const keepout::Body& each) {
    return object("name", each.name, "radius", each.radius);
  };
  return object("positions", tool.positions, "asked", tool.asked, "band", tool.band, "period",
                tool.period, "bodies", list(tool.bodies, body), "link", tool.end.link, "end",
                list(tool.end.position), "guides", list(tool.guides, drawn));
}

/// Returns the numbers of the last cycle in their memory layout, as a view that is valid until the
/// next call.
val last(const Tool& tool) {
  static_assert(sizeof(Cycle) == 8 * (42 + 6 * keepout::Instrument::most_bodies));
  return val(typed_memory_view(42 + 6 * tool.bodies.size(), tool.cycle.positions));
}

/// See Tool::place().
val place(Tool& tool, const val& positions) {
  tool.cycle = {};
  tool.planes = {};
  tool.active = {};
  tool.place(emscripten::convertJSArrayToNumberVector<double>(positions));
  return last(tool);
}

/// See Tool::follow(). The orientation of the hand is a quaternion i, j, k, w.
val follow(Tool& tool, double x, double y, double z, double i, double j, double k, double w) {
  tool.follow({x, y, z}, {w, i, j, k});
  return last(tool);
}

/// See Tool::step().
val step(Tool& tool, double x, double y, double z, double u, double v, double w) {
  tool.step({x, y, z}, {u, v, w});
  return last(tool);
}

/// See Tool::contact(). Returns both points (6), or an empty list.
val contact(Tool& tool, std::size_t body) {
  const std::optional<Contact> found = tool.contact(body);
  val numbers = val::array();
  for (const Vec3& point :
       found ? std::array{found->core, found->surface} : std::array<Vec3, 2>{}) {
    for (const double number : point) {
      if (found) numbers.call<void>("push", number);
    }
  }
  return numbers;
}

/// Returns all planes of the last step of a tip, relative to the tip before it.
val planes(const Tool& tool) {
  std::uint32_t number = 0;
  return list(tool.planes, [&](const keepout::HalfSpace& plane) {
    const bool is_active = std::ranges::find(tool.active, number++) != tool.active.end();
    return object("normal", list(plane.normal), "offset", plane.offset, "triangle", plane.source,
                  "isActive", is_active);
  });
}

/// Returns all statuses by number: name, and a line on what it means and what to do. `subject`:
/// "tip" or "instrument".
val statuses(const std::string& subject) {
  const auto of = subject == "tip" ? keepout::Subject::tip : keepout::Subject::instrument;
  val all = val::array();
  for (keepout::Status status{}; name(status) != "unknown";) {
    const auto number =
        all.call<int>("push", object("name", name(status), "reason", reason(status, of)));
    status = static_cast<keepout::Status>(number);
  }
  return all;
}

/// Returns the names of the generated shapes.
val shapes() {
  return list(keepout::shapes(), [](const keepout::Shape& shape) { return value(shape.name); });
}

/// Returns the counterexamples to the rule of Li et al. (2020).
val counterexamples() {
  const auto row = [](const auto& numbers) { return list(numbers); };
  return list(keepout::counterexamples(), [&](const keepout::Counterexample& example) {
    return object("name", example.name, "vertices", list(example.surface.vertices, row),
                  "triangles", list(example.surface.triangles, row), "tip", list(example.tip),
                  "desired", list(example.desired), "radius", example.radius);
  });
}

}  // namespace

EMSCRIPTEN_BINDINGS(keepout) {
  using emscripten::allow_raw_pointers;
  using emscripten::class_;
  using emscripten::function;
  class_<Anatomy>("Anatomy")
      .function("surface", &surface)
      .function("findings", &findings)
      .function("clearance", &Anatomy::clearance)
      .function("isBetween", &is_between);
  class_<Tool>("Tool")
      .function("facts", &facts)
      .function("place", &place)
      .function("follow", &follow)
      .function("step", &step)
      .function("clearance", &Tool::clearance)
      .function("contact", &contact)
      .function("planes", &planes);
  function("anatomyOfSurface", &anatomy_of_surface, allow_raw_pointers());
  function("anatomyOfFile", &anatomy_of_file, allow_raw_pointers());
  function("anatomyOfShape", &anatomy_of_shape, allow_raw_pointers());
  function("makeTool", &tool_on, allow_raw_pointers());
  function("statuses", &statuses);
  function("shapes", &shapes);
  function("counterexamples", &counterexamples);
}
