// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/factory/convex_tool_text.h"

#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "keepout/error.h"
#include "keepout/mesh/load_mesh.h"

namespace keepout {
namespace {

using Fields = std::vector<std::string_view>;

Fields split(std::string_view text, char at) {
  Fields fields;
  for (std::size_t end = text.find(at); end != std::string_view::npos; end = text.find(at)) {
    fields.push_back(text.substr(0, end));
    text.remove_prefix(end + 1);
  }
  fields.push_back(text);
  return fields;
}

std::string in_quotes(std::string_view text) { return "'" + std::string(text) + "'"; }

double number(std::string_view field) {
  double value = 0.0;
  const char* const last = field.data() + field.size();
  const auto [end, error] = std::from_chars(field.data(), last, value);
  if (error != std::errc{} || end != last || !std::isfinite(value)) {
    throw Error(in_quotes(field) + " is not a number");
  }
  return value;
}

double extent(std::string_view field) {
  const double value = number(field);
  if (!(value > 0.0)) throw Error(in_quotes(field) + " is not above 0");
  return value;
}

Vec3 point(std::string_view field) {
  const Fields numbers = split(field, ',');
  if (numbers.size() != 3) throw Error(in_quotes(field) + " is not a point, three numbers x,y,z");
  return {number(numbers[0]), number(numbers[1]), number(numbers[2])};
}

void require(std::size_t count, const Fields& fields) {
  if (fields.size() == count) return;
  throw Error("there are " + std::to_string(fields.size()) + " values where there must be " +
              std::to_string(count));
}

ConvexTool sphere(const Fields& fields) {
  require(1, fields);
  return ConvexTool::sphere(number(fields[0]));
}

ConvexTool capsule(const Fields& fields) {
  require(3, fields);
  return ConvexTool::capsule(point(fields[0]), point(fields[1]), number(fields[2]));
}

ConvexTool box(const Fields& fields) {
  require(2, fields);
  const Vec3 one = point(fields[0]);
  const Vec3 other = point(fields[1]);
  return ConvexTool::box({one.cwiseMin(other), one.cwiseMax(other)});
}

ConvexTool blade(const Fields& fields) {
  require(3, fields);
  const double length = extent(fields[0]);
  const Vec3 half(0.5 * extent(fields[1]), 0.5 * extent(fields[2]), 0.0);
  return ConvexTool::box({-half, half + Vec3(0.0, 0.0, length)});
}

ConvexTool hull_of_file(const std::filesystem::path& file) {
  std::error_code trouble;
  // A pipe would be waited for.
  if (!std::filesystem::is_regular_file(file, trouble)) {
    throw Error("there is no file " + in_quotes(file.string()));
  }
  return ConvexTool::hull(load_mesh(file, {.check = MeshCheck::none}).mesh->vertices());
}

ConvexTool hull(Fields fields) {
  double radius = 0.0;
  if (fields.size() > 1 && fields.back().find(',') == std::string_view::npos) {
    radius = number(fields.back());
    fields.pop_back();
  }
  std::vector<Vec3> points;
  for (const std::string_view field : fields) points.push_back(point(field));
  return ConvexTool::hull(points, radius);
}

/// Whether what follows "hull:" begins with a point, and is no file that is there.
bool are_points(std::string_view text) {
  std::error_code trouble;
  return text.substr(0, text.find(':')).find(',') != std::string_view::npos &&
         !std::filesystem::exists(std::filesystem::path(text), trouble);
}

ConvexTool read(std::string_view kind, std::string_view rest) {
  const Fields fields = split(rest, ':');
  if (kind == "sphere") return sphere(fields);
  if (kind == "capsule") return capsule(fields);
  if (kind == "box") return box(fields);
  if (kind == "blade") return blade(fields);
  if (kind == "hull") return are_points(rest) ? hull(fields) : hull_of_file(rest);
  throw Error("there is no tool " + in_quotes(kind));
}

/// The forms of one kind; of no known kind, all.
std::string forms_of(std::string_view kind) {
  std::string forms;
  std::string all;
  for (const std::string_view form : split(convex_tool_forms, '\n')) {
    all += (all.empty() ? "" : ", ") + std::string(form);
    if (form.starts_with(std::string(kind) + ":")) {
      forms += (forms.empty() ? "" : " or ") + std::string(form);
    }
  }
  return forms.empty() ? all : forms;
}

}  // namespace

const std::string_view convex_tool_forms =
    "sphere:R\ncapsule:X,Y,Z:X,Y,Z:R\nbox:X,Y,Z:X,Y,Z\nblade:LENGTH:WIDTH:THICKNESS\n"
    "hull:X,Y,Z:...[:R]\nhull:FILE";

ConvexTool tool_of_text(std::string_view text) {
  const std::string_view kind = text.substr(0, text.find(':'));
  try {
    return read(kind, kind.size() < text.size() ? text.substr(kind.size() + 1) : "");
  } catch (const Error& error) {
    throw Error("the tool: " + std::string(error.what()) + "; write " + forms_of(kind) + ", not " +
                in_quotes(text));
  }
}

}  // namespace keepout
