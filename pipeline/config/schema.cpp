#include "pipeline/config/schema.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "pipeline/config/edit_settings.h"
#include "pipeline/config/filter_settings.h"
#include "pipeline/config/settings.h"
#include "storage/support/json_text.h"

namespace voxweld {
namespace {

using Json = nlohmann::ordered_json;

Json positive_number() {
  return {{"type", "number"}, {"exclusiveMinimum", 0}};
}

Json whole(std::int64_t lo, std::int64_t hi) {
  Json json = {{"type", "integer"}, {"minimum", lo}};
  if (hi != std::numeric_limits<std::int64_t>::max()) json["maximum"] = hi;
  return json;
}

Json fixed_list(Json item, std::size_t count) {
  return {{"type", "array"}, {"items", std::move(item)}, {"minItems", count}, {"maxItems", count}};
}

Json either(Json a, Json b) {
  Json json;
  json["anyOf"] = Json::array({std::move(a), std::move(b)});
  return json;
}

// In quotes, since it is beyond TOML's own.
Json large_integer() {
  return {{"type", "string"}, {"pattern", "^[0-9]{19,20}$"}};
}

struct RuleSchema {
  Json operator()(const PathRule&) const { return {{"type", "string"}, {"minLength", 1}}; }
  Json operator()(const ChoiceRule& rule) const { return {{"enum", rule.names}}; }
  Json operator()(const ChoiceListRule& rule) const {
    return {{"type", "array"},
            {"items", {{"enum", rule.names}}},
            {"minItems", 1},
            {"uniqueItems", true}};
  }
  Json operator()(const FlagRule&) const { return {{"type", "boolean"}}; }
  Json operator()(const SwitchRule&) const {
    return {{"enum", Json::array({"auto", true, false})}};
  }
  Json operator()(const IntegerRule& rule) const {
    if (rule.automatic) return either({{"const", "auto"}}, whole(rule.lo, rule.hi));
    return whole(rule.lo, rule.hi);
  }
  Json operator()(const PowerOfTwoRule& rule) const {
    Json values = Json::array();
    for (std::int64_t value = rule.lo; value <= rule.hi; value *= 2) values.push_back(value);
    return {{"enum", std::move(values)}};
  }
  Json operator()(const PositiveNumberRule&) const { return positive_number(); }
  Json operator()(const PartRule&) const {
    Json json = positive_number();
    json["maximum"] = 1;
    return json;
  }
  Json operator()(const NumberOrWordRule& rule) const {
    Json json = either({{"type", "number"}}, {{"enum", rule.words}});
    json["anyOf"].push_back(large_integer());
    const Json list = {{"type", "array"}, {"items", json}, {"minItems", 1}, {"uniqueItems", true}};
    json["anyOf"].push_back(list);
    return json;
  }
  Json operator()(const SpacingRule&) const {
    return either(positive_number(), fixed_list(positive_number(), 3));
  }
  Json operator()(const IntegerListRule& rule) const {
    return fixed_list(whole(rule.lo, rule.hi), rule.count);
  }
  Json operator()(const TripleRule& rule) const {
    using Of = TripleRule::Of;
    Json list =
        fixed_list(rule.of == Of::positive ? positive_number() : Json{{"type", "number"}}, 3);
    if (rule.of == Of::not_all_zero) list["contains"] = {{"not", {{"const", 0}}}};
    return list;
  }
  Json operator()(const NumberRule&) const { return {{"type", "number"}}; }
  Json operator()(const NumberPairRule&) const {
    Json list = fixed_list({{"type", "number"}}, 2);
    list["uniqueItems"] = true;
    return list;
  }
  Json operator()(const PerAxisRule& rule) const {
    Json one = whole(rule.least, rule.most);
    if (!rule.whole) one["type"] = "number";
    Json three = fixed_list(one, 3);
    three["contains"] = {{"not", {{"const", rule.least}}}};
    one.erase("minimum");
    one["exclusiveMinimum"] = rule.least;
    return either(std::move(one), std::move(three));
  }
  Json operator()(const AxesRule&) const {
    return {{"type", "string"}, {"pattern", "^(?!.*(.).*\\1)[xyz]+$"}};
  }
  Json operator()(const MemoryRule& rule) const {
    const std::string size = "[0-9]+([.][0-9]+)? *([kKmMgGtT][iI]?)?[bB]";
    return either(
        {{"type", "string"},
         {"pattern", rule.automatic ? "^(auto|" + size + ")$" : "^" + size + "$"}},
        whole(static_cast<std::int64_t>(rule.least), std::numeric_limits<std::int64_t>::max()));
  }
  Json operator()(const NameRule&) const {
    return {{"type", "string"}, {"pattern", "^[^\\s\"'\\\\#]*$"}};
  }
  Json operator()(const TextRule&) const { return {{"type", "string"}, {"minLength", 1}}; }
  Json operator()(const TimeLimitRule&) const {
    return {{"type", "string"}, {"pattern", "^([0-9]+-)?[0-9]+(:[0-9]+){0,2}$"}};
  }
  Json operator()(const OptionListRule&) const {
    return {{"type", "array"}, {"items", {{"type", "string"}, {"pattern", "^-."}}}};
  }
  Json operator()(const LineListRule&) const {
    return {{"type", "array"}, {"items", {{"type", "string"}}}};
  }
  Json operator()(const LabelRule&) const {
    return either(whole(0, std::numeric_limits<std::int64_t>::max()),
                  {{"type", "string"}, {"pattern", "^[0-9]+$"}});
  }
  Json operator()(const LabelListRule& rule) const {
    Json list = {{"type", "array"},
                 {"items", either(whole(0, std::numeric_limits<std::int64_t>::max()),
                                  {{"type", "string"}, {"pattern", "^[0-9]+(-[0-9]+)?$"}})}};
    if (!rule.may_be_empty) list["minItems"] = 1;
    if (rule.words.empty()) return list;
    return either({{"enum", rule.words}}, std::move(list));
  }
};

Json key_schema(const KeyFacts& setting) {
  Json json = std::visit(RuleSchema{}, setting.rule);
  std::string text = setting.description;
  text += fmt::format(" Takes {}.", accepted_text(setting.rule));
  if (!setting.default_note.empty() && !setting.required)
    text += fmt::format(" Default: {}.", setting.default_note);
  json["description"] = std::move(text);
  // Every default that is a value is TOML that is JSON too.
  if (setting.default_note.empty()) json["default"] = Json::parse(setting.default_text());
  return json;
}

Json table_schema(const std::string& table) {
  Json properties = Json::object();
  Json required = Json::array();
  for (const Setting& setting : settings()) {
    if (setting.table != table) continue;
    properties[setting.key] = key_schema(setting);
    if (setting.required) required.push_back(setting.key);
  }
  Json json = {{"type", "object"},
               {"description", std::string(table_description(table))},
               {"additionalProperties", false},
               {"properties", std::move(properties)}};
  if (!required.empty()) json["required"] = std::move(required);
  return json;
}

// Each kind asks for keys of its own and takes no others.
template <class Item, class Kind>
Json kind_schema(const ItemTable<Item, Kind>& table, Kind kind) {
  Json names = Json::array();
  Json required = Json::array();
  for (const auto& setting : table.settings) {
    if (!setting.taken_by(kind)) continue;
    names.push_back(setting.key);
    if (setting.required_by(kind)) required.push_back(setting.key);
  }
  Json json;
  json["if"] = {{"properties", {{table.kind_key, {{"const", table.kind_name(kind)}}}}},
                {"required", Json::array({table.kind_key})}};
  json["then"] = {{"required", std::move(required)},
                  {"propertyNames", {{"enum", std::move(names)}}}};
  return json;
}

template <class Item, class Kind>
Json items_schema(const ItemTable<Item, Kind>& table) {
  Json properties = Json::object();
  Json required = Json::array();
  for (const auto& setting : table.settings) {
    properties[setting.key] = key_schema(setting);
    if (setting.required && setting.kinds.empty() && setting.optional_for.empty())
      required.push_back(setting.key);
  }
  Json kinds = Json::array();
  for (const Kind kind : table.kinds()) kinds.push_back(kind_schema(table, kind));
  return {{"type", "array"},
          {"description", table.description},
          {"items",
           {{"type", "object"},
            {"additionalProperties", false},
            {"required", std::move(required)},
            {"properties", std::move(properties)},
            {"allOf", std::move(kinds)}}}};
}

Json requires_key(const char* name) {
  Json json;
  json["required"] = Json::array({name});
  return json;
}

Json has_format(const char* name) {
  Json json = requires_key("format");
  json["properties"] = {{"format", {{"const", name}}}};
  return json;
}

// By its format, or by its name where none is given.
Json mesh_input() {
  const Json by_name = {
      {"properties",
       {{"path", {{"pattern", "\\.([sS][tT][lL]|[oO][fF][fF]|[oO][bB][jJ]|[pP][lL][yY])$"}}},
        {"format", {{"const", "auto"}}}}},
      {"required", Json::array({"path"})}};
  return {{"anyOf", Json::array({has_format("mesh"), by_name})}};
}

Json one_fineness() {
  return {{"oneOf", Json::array({requires_key("resolution"), requires_key("cell")})}};
}

// What the loader checks across keys and a schema can say.
void add_cross_checks(Json& tables) {
  Json& input = tables["input"];
  input["if"] = has_format("raw");
  input["required"] = Json::array();
  input["else"] = {
      {"if", has_format("empty")},
      {"then", {{"required", Json::array({"size"})}}},
      {"else",
       {{"required", Json::array({"path"})},
        {"dependencies", {{"size", Json::array({"type"})}, {"type", Json::array({"size"})}}}}}};
  input["then"] = {{"required", Json::array({"path", "size", "type"})}};
  tables["surface"].erase("required");  // said at the top, since not all configs need it
  tables["output"]["not"] = {
      {"properties", {{"tiles", {{"const", false}}}, {"merged", {{"const", false}}}}},
      {"required", Json::array({"tiles", "merged"})}};
}

// That the table's key has one of the values.
Json has_value(const char* table, const char* key, Json values) {
  const Json keys = {{"properties", {{key, {{"enum", std::move(values)}}}}},
                     {"required", Json::array({key})}};
  return {{"properties", {{table, keys}}}, {"required", Json::array({table})}};
}

// Neither empty space nor labels have an isovalue.
Json surface_needed() {
  Json surface;
  surface["properties"]["surface"] =
      either({{"required", Json::array({"isovalue"})}}, {{"required", Json::array({"label"})}});
  surface["required"] = Json::array({"surface"});
  Json json;
  json["if"] = has_value("labels", "mode", Json::array({"each", "shared"}));
  json["then"] = Json::object();
  json["else"] = std::move(surface);
  return json;
}

}  // namespace

std::string config_schema_json() {
  Json tables = Json::object();
  for (const std::string& table : table_names()) tables[table] = table_schema(table);
  add_cross_checks(tables);
  tables[filter_items().name] = items_schema(filter_items());
  tables[edit_items().name] = items_schema(edit_items());
  const Json otherwise = {{"if", {{"properties", {{"input", mesh_input()}}}}},
                          {"then", {{"properties", {{"input", one_fineness()}}}}},
                          {"else", surface_needed()}};
  const Json schema = {{"$schema", "http://json-schema.org/draft-07/schema#"},
                       {"title", "voxweld config"},
                       {"type", "object"},
                       {"additionalProperties", false},
                       {"required", Json::array({"input"})},
                       {"if", has_value("input", "format", Json::array({"empty"}))},
                       {"then", {{"required", Json::array({"edit"})}}},
                       {"else", otherwise},
                       {"properties", std::move(tables)}};
  return json_text(schema, 2) + "\n";
}

}  // namespace voxweld
