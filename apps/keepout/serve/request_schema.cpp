// SPDX-License-Identifier: BSD-3-Clause
#include "serve/request_schema.h"

#include <limits>
#include <nlohmann/json.hpp>

#include "serve/service.h"

namespace keepout::app {
namespace {

/// Returns a reference to a definition of the schema.
Json definition(std::string_view name) { return {{"$ref", "#/$defs/" + std::string(name)}}; }

Json array_of(Json items, const Field::Count& count) {
  return {{"type", "array"},
          {"items", std::move(items)},
          {"minItems", count.least},
          {"maxItems", count.most}};
}

/// Appends the members that limit a number to a range.
void append_range(Json& schema, const Range& range) {
  const bool excludes_zero = range.least == std::numeric_limits<double>::denorm_min();
  Json limits;
  if (excludes_zero) {
    limits["exclusiveMinimum"] = 0;
  } else {
    limits["minimum"] = range.least;
  }
  limits["maximum"] = range.most;
  if (range.has_zero && range.least > 0.0) {
    schema["anyOf"] = {{{"const", 0}}, limits};
  } else {
    schema.update(limits);
  }
}

Json schema_of(const OptionText& option) {
  Json schema;
  switch (option.kind) {
    case OptionKind::number:
    case OptionKind::whole_number:
      schema["type"] = option.kind == OptionKind::number ? "number" : "integer";
      append_range(schema, option.range);
      break;
    case OptionKind::flag:
      schema["type"] = "boolean";
      break;
    case OptionKind::choice:
      schema["enum"] = option.names;
      break;
    case OptionKind::part:
      schema["type"] = "string";
      break;
  }
  std::string meaning(option.meaning);
  if (!option.unit.empty()) meaning.append(" [").append(option.unit).append("]");
  schema["description"] = meaning;
  return schema;
}

Json schema_of(const Field& field) {
  if (field.option != nullptr) return schema_of(*field.option);
  Json schema = {{"type", field.is_text ? "string" : field.is_flag ? "boolean" : "number"}};
  if (field.rank > 0) schema = array_of(std::move(schema), field.columns);
  if (field.rank > 1) schema = array_of(std::move(schema), field.rows);
  schema["description"] = field.expected;
  return schema;
}

Json schema_of(const Verb& verb) {
  Json members{{"id", definition("id")}, {"do", {{"const", verb.name}}}};
  Json required{"do"};
  for (const std::string_view name : verb.needed) {
    members[std::string(name)] = definition(name);
    required.push_back(name);
  }
  for (const std::string_view name : verb.optional) members[std::string(name)] = definition(name);
  return {{"title", verb.name},
          {"type", "object"},
          {"properties", members},
          {"required", required},
          {"additionalProperties", false}};
}

}  // namespace

std::string request_schema(const RequestLimits& limits) {
  const RequestReader reader(limits, verbs());
  Json definitions{{"id",
                    {{"type", {"integer", "string", "null"}},
                     {"minimum", std::numeric_limits<std::int64_t>::min()},
                     {"maximum", std::numeric_limits<std::uint64_t>::max()},
                     {"maxLength", longest_id},
                     {"description", "repeated in the answer"}}}};
  for (const Field& field : reader.fields()) {
    definitions[std::string(field.name)] = schema_of(field);
  }
  Json requests = Json::array();
  for (const Verb& verb : verbs()) requests.push_back(schema_of(verb));
  const Json schema{
      {"$schema", "https://json-schema.org/draft/2020-12/schema"},
      {"$id", "urn:keepout:serve:request"},
      {"title", "A request of keepout serve"},
      {"description",
       "One line of input. The server also checks that sizes agree, such as the number of rows and "
       "of bounds, and that files and texts are valid."},
      {"oneOf", requests},
      {"$defs", definitions}};
  return schema.dump(2);
}

}  // namespace keepout::app
