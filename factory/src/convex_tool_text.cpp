// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/factory/convex_tool_text.h"

#include <algorithm>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "keepout/error.h"
#include "keepout/mesh/load_mesh.h"
#include "text_fields.h"

namespace keepout {
namespace {

using text::Fields;
using text::in_quotes;
using text::number;
using text::point;
using text::split;

ConvexTool blade(double length, double width, double thickness) {
  if (!(std::min({length, width, thickness}) > 0.0)) {
    throw Error("length, width and thickness of a blade must be above 0");
  }
  const Vec3 half(0.5 * width, 0.5 * thickness, 0.0);
  return ConvexTool::box({-half, half + Vec3(0.0, 0.0, length)});
}

ConvexTool hull_of_points(Fields fields) {
  double radius = 0.0;
  if (fields.size() > 1 && fields.back().find(',') == std::string_view::npos) {
    radius = number(fields.back());
    fields.pop_back();
  }
  std::vector<Vec3> points;
  for (const std::string_view field : fields) points.push_back(point(field));
  return ConvexTool::hull(points, radius);
}

ConvexTool read(std::string_view kind, std::string_view rest) {
  const Fields f = split(rest, ':');
  if (kind == "sphere" && f.size() == 1) return ConvexTool::sphere(number(f[0]));
  if (kind == "capsule" && f.size() == 3) {
    return ConvexTool::capsule(point(f[0]), point(f[1]), number(f[2]));
  }
  if (kind == "box" && f.size() == 2) return ConvexTool::box({point(f[0]), point(f[1])});
  if (kind == "blade" && f.size() == 3) return blade(number(f[0]), number(f[1]), number(f[2]));
  if (kind != "hull") {
    throw Error(text::misfit(kind, {"sphere", "capsule", "box", "blade"}, "form"));
  }
  std::error_code trouble;
  const std::filesystem::path file(rest);
  // A pipe would block.
  if (std::filesystem::is_regular_file(file, trouble)) {
    return ConvexTool::hull(load_mesh(file, {.check = MeshCheck::none}).mesh->vertices());
  }
  if (f[0].find(',') == std::string_view::npos) throw Error("there is no file " + in_quotes(rest));
  return hull_of_points(f);
}

}  // namespace

ConvexTool tool_of_text(std::string_view text) {
  const std::string_view kind = text.substr(0, text.find(':'));
  try {
    return read(kind, kind.size() < text.size() ? text.substr(kind.size() + 1) : "");
  } catch (const Error& error) {
    throw Error("the tool " + in_quotes(kind) + ": " + error.what() + "; write " +
                std::string(convex_tool_forms));
  }
}

}  // namespace keepout
