#include "pipeline/report/settings_section.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "pipeline/config/settings.h"
#include "pipeline/report/html_text.h"
#include "pipeline/report/report_volume.h"
#include "pipeline/run/tile_vertices.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

// A run resolves some settings that are left open: these come out as the default would.
bool is_default(const Setting& setting, const ConfigValue& value, const Config& config) {
  if (setting.default_value) {
    if (value == *setting.default_value) return true;
    if (setting.name() == "output.tile_vertices")
      return config.output.tile_vertices == fitting_tile_vertices(config);
    if (setting.name() == "simplify.refine") {
      Config open = config;
      open.simplify.refine = SimplifyConfig::Refine::automatic;
      return config.simplify.refine == refine_mode(open);
    }
  }
  return is_of_labels(config) ? setting.name() == "surface.isovalue" : setting.table == "labels";
}

std::string changed_table(const Config& config) {
  std::string rows;
  for (const Setting& setting : settings()) {
    const auto value = setting.get(config);
    if (!value || is_default(setting, *value, config)) continue;
    rows += fmt::format("<tr><th scope=\"row\"><code>{}</code></th><td><code>{}</code></td></tr>\n",
                        escaped(setting.name()), escaped(to_toml(*value)));
  }
  return rows.empty() ? "" : "<table class=\"facts\">\n" + rows + "</table>\n";
}

// The text of the config file, where it gives the same meshes as the run's config. Settings of the
// command line are not in it.
std::optional<std::string> file_text(const std::string& path, const std::string& result) {
  try {
    if (path.empty() || result.empty()) return std::nullopt;
    if (to_hex(result_hash(load_config(path))) != result) return std::nullopt;
    return read_config_text(path);
  } catch (const Error&) {
    return std::nullopt;
  }
}

std::string folded(const std::string& title, const std::string& text) {
  return fmt::format("<details><summary>{}</summary>\n<pre>{}</pre>\n</details>\n", escaped(title),
                     escaped(text));
}

}  // namespace

std::string settings_section(const Manifest& manifest, const Config& config) {
  std::string html = changed_table(config);
  const std::string path = manifest.config->value("path", "");
  if (const auto text = file_text(path, manifest.config->value("result", "")))
    html += folded("The config file, " + path, *text);
  return html + folded("All settings of the run", manifest.config->value("toml", ""));
}

}  // namespace voxweld
