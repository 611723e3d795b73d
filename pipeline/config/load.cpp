#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <utility>

#include "pipeline/config/config.h"
#include "pipeline/config/cross_checks.h"
#include "pipeline/config/document.h"
#include "pipeline/config/load_edits.h"
#include "pipeline/config/load_filters.h"
#include "pipeline/config/number_list.h"
#include "pipeline/config/refuse.h"
#include "pipeline/config/settings.h"
#include "pipeline/config/suggest.h"
#include "storage/meshes/mesh_file.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "storage/support/text_fields.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

// A config is a page of text; a volume given in its place is refused before it is read.
constexpr std::uint64_t largest_config = std::uint64_t{1} << 20;

struct Assignment {
  const Setting* setting;
  ConfigValue value;
  std::string where;
  fs::path base;  // of relative paths
};

void assign(Config& config, Places& places, Assignment a) {
  require_accepted(a.where, a.setting->name(), *a.setting, a.value);
  const bool path = std::holds_alternative<PathRule>(a.setting->rule);
  // Only the input may lie on a server.
  if (path && !(a.setting->name() == "input.path" && is_url(*a.value.text())))
    a.value = {(a.base / *a.value.text()).lexically_normal().string()};
  a.setting->set(config, a.value);
  places[a.setting->name()] = a.where;
}

std::string bracketed(const std::string& table, bool several) {
  return several ? fmt::format("[[{}]]", table) : fmt::format("[{}]", table);
}

std::string the_tables() {
  return "The tables are " + joined(table_names()) + " and any number of [[filter]] and [[edit]]";
}

[[noreturn]] void throw_unknown_table(const std::string& where, const DocumentEntry& entry) {
  auto names = table_names();
  for (const auto list : {filter_table, edit_table}) names.emplace_back(list);
  const std::string nearest = nearest_name(entry.table, names);
  const bool several = nearest == filter_table || nearest == edit_table;
  throw InputError(
      fmt::format("{}: unknown table {}{} {}", where, bracketed(shown(entry.table), entry.item > 0),
                  nearest.empty() ? "." : did_you_mean(bracketed(nearest, several)), the_tables()));
}

// Overrides name settings only, so filters and edits are left out.
[[noreturn]] void throw_unknown_override(const std::string& where, const std::string& table) {
  const auto tables = table_names();
  const std::string nearest = nearest_name(table, tables);
  throw InputError(fmt::format("{}: unknown table [{}]{} The tables are {}", where, shown(table),
                               nearest.empty() ? "." : did_you_mean(bracketed(nearest, false)),
                               joined(tables)));
}

[[noreturn]] void throw_unknown_key(const std::string& where, const std::string& table,
                                    const std::string& key) {
  // A key of another table is a better guess than one that is merely spelled alike.
  const std::string name = fmt::format("{}.{}", table, key);
  for (const Setting& setting : settings())
    if (setting.key == key)
      throw InputError(fmt::format("{}: unknown key {}; did you mean {}? [{}] takes {}", where,
                                   shown(name), setting.name(), table, joined(key_names(table))));
  const auto keys = key_names(table);
  const std::string nearest = nearest_name(key, keys);
  throw InputError(fmt::format("{}: unknown key {}{} [{}] takes {}", where, shown(name),
                               nearest.empty() ? "." : did_you_mean(table + "." + nearest), table,
                               joined(keys)));
}

[[noreturn]] void throw_outside_tables(const std::string& where, const DocumentEntry& entry) {
  const auto tables = table_names();
  if (std::find(tables.begin(), tables.end(), entry.key) != tables.end())
    throw InputError(fmt::format("{}: expected a table [{}] with keys {}, found {}", where,
                                 entry.key, joined(key_names(entry.key)), describe(entry.value)));
  std::string meant;
  for (const Setting& setting : settings())
    if (setting.key == entry.key && meant.empty()) meant = setting.name();
  throw InputError(fmt::format("{}: key {} stands outside any table{} {}", where, shown(entry.key),
                               meant.empty() ? "." : did_you_mean(meant), the_tables()));
}

void apply_setting(const DocumentEntry& entry, const fs::path& path, Config& config,
                   Places& places) {
  const std::string key_at = place_text(path.string(), entry.key_at);
  const auto tables = table_names();
  if (entry.table.empty()) throw_outside_tables(key_at, entry);
  if (std::find(tables.begin(), tables.end(), entry.table) == tables.end())
    throw_unknown_table(key_at, entry);
  if (entry.item > 0)
    throw InputError(fmt::format("{}: expected a table [{}] with keys {}, found [[{}]]", key_at,
                                 entry.table, joined(key_names(entry.table)), entry.table));
  if (entry.key.empty()) return;
  const Setting* setting = find_setting(entry.table, entry.key);
  if (setting == nullptr) throw_unknown_key(key_at, entry.table, entry.key);
  assign(config, places,
         {setting, entry.value, place_text(path.string(), entry.value_at),
          fs::absolute(path).parent_path()});
}

void apply_document(const std::string& text, const fs::path& path, Config& config, Places& places) {
  const auto entries = parse_document(text, path.string());
  const auto filters = filter_reader(entries, path.string());
  const auto edits = edit_reader(entries, path.string());
  for (const DocumentEntry& entry : entries) {
    if (filters.owns(entry))
      filters.read(entry, config.filters, places);
    else if (edits.owns(entry))
      edits.read(entry, config.edits, places);
    else
      apply_setting(entry, path, config, places);
  }
}

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

void apply_override(const std::string& text, Config& config, Places& places) {
  const std::string where = "--set " + shown(text);
  const auto equals = text.find('=');
  const std::string name = trimmed(text.substr(0, equals));
  for (const auto list : {filter_table, edit_table})
    if (name.starts_with(list))
      throw InputError(fmt::format(
          "{0}: {1}s are written in the config file only, as [[{1}]] tables", where, list));
  const auto dot = name.find('.');
  if (equals == std::string::npos || dot == std::string::npos)
    throw InputError(where +
                     ": expected table.key=value, for example --set simplify.tolerance=0.2");
  const std::string table = name.substr(0, dot);
  const std::string key = name.substr(dot + 1);
  const auto tables = table_names();
  if (std::find(tables.begin(), tables.end(), table) == tables.end())
    throw_unknown_override(where, table);
  const Setting* setting = find_setting(table, key);
  if (setting == nullptr) throw_unknown_key(where, table, key);
  const std::string written = trimmed(text.substr(equals + 1));
  const std::optional<ConfigValue> value = typed_value(setting->rule, written);
  if (!value)
    throw InputError(fmt::format("{}: {}: expected {}, found {}, which is not valid TOML", where,
                                 setting->name(), accepted_text(setting->rule), written));
  assign(config, places, {setting, *value, where, fs::current_path()});
}

void check_size(const fs::path& path, std::uint64_t size) {
  if (size > largest_config)
    throw InputError(
        fmt::format("{}: expected a config file (TOML) of at most {}, found {} bytes; "
                    "a volume is named inside the config, as input.path",
                    path.string(), bytes_text(largest_config), size));
}

void set_default_directories(const fs::path& path, Config& config) {
  fs::path base = fs::absolute(path).lexically_normal();
  if (base.extension() == ".toml") base.replace_extension();
  if (config.work.directory.empty()) config.work.directory = base.string() + ".work";
  if (config.output.directory.empty()) config.output.directory = base.string() + ".mesh";
}

// A brick's octree takes memory with its cells: up to 810 MiB of 64 cells a side where each sheet
// collapses by itself, an eighth of that for each halving. Chunks divide shards, so those given say
// how small bricks may be. And of shards of 16 bricks of 16 cells the records alone, which are
// bounded less tightly there, take more than those of 32.
std::int64_t fitting_brick(const WorkConfig& work, std::uint64_t memory, bool chunk_given) {
  constexpr std::uint64_t mebibyte = std::uint64_t{1} << 20;
  const std::int64_t least = work.shard < 16 ? 16 : 32;
  std::int64_t brick = memory >= 1024 * mebibyte ? 64 : memory >= 256 * mebibyte ? 32 : least;
  while (chunk_given && brick < 64 && brick * work.shard < work.chunk) brick *= 2;
  return brick;
}

// Outside a mask is no label.
void set_default_outside(Config& config) {
  if (config.labels.mode == LabelMode::off && !config.surface.label) return;
  for (FilterConfig& filter : config.filters)
    if (filter.type == FilterType::mask && !filter.outside) filter.outside = 0;
}

}  // namespace

Config parse_config(const std::string& text, const fs::path& path,
                    std::span<const std::string> overrides) {
  check_size(path, text.size());
  Config config;
  Places places;
  apply_document(text, path, config, places);
  for (const std::string& override_text : overrides) apply_override(override_text, config, places);

  if (config.input.format == "auto" && is_mesh_name(config.input.path))
    config.input.format = "mesh";
  set_default_directories(path, config);
  const bool chunk_given = places.contains("work.chunk");
  if (!places.contains("work.brick"))
    config.work.brick = fitting_brick(config.work, config.run.memory, chunk_given);
  if (!chunk_given)  // chunks divide shards
    config.work.chunk = std::min(config.work.chunk, config.work.brick * config.work.shard);
  check_across(config, places, path.string());
  set_default_outside(config);
  if (!config.input.has_samples()) {
    config.surface.isovalue = 1;  // above every sample of empty space
    config.surface.inside = SurfaceConfig::Inside::above;
  }
  if (config.surface.label) config.surface.isovalue = Isovalue::of(*config.surface.label);
  // Not looked at; one that is given stays, so that a mode can be set beside it.
  if (config.labels.mode != LabelMode::off && !config.surface.isovalue) config.surface.isovalue = 0;
  return config;
}

std::string read_config_text(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status))
    throw InputError(path.string() +
                     ": no such config file; check the path, or write one with `voxweld init`");
  if (!fs::is_regular_file(status))
    throw InputError(path.string() +
                     ": expected a config file (TOML), found a directory or device");
  check_size(path, ReadFile(path).size());
  const auto bytes = read_whole_file(path);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

Config load_config(const fs::path& path, std::span<const std::string> overrides) {
  return parse_config(read_config_text(path), path, overrides);
}

}  // namespace voxweld
