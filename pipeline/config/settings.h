// The one table of all settings. Parsing and validation, the stage parameters that key every
// artifact, help, schema and the commented files are all made from it, so they cannot disagree.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/config/config.h"
#include "pipeline/config/config_value.h"
#include "pipeline/config/rule.h"

namespace voxweld {

enum class Stage : std::uint8_t {
  ingest,
  build,
  merge,
  stitch,
  survey,
  refine,
  recount,
  seams,
  mend,
  remend,
  retile,
  levels,
  encode
};
inline constexpr std::array<Stage, 13> all_stages = {
    Stage::ingest, Stage::build,   Stage::merge, Stage::stitch, Stage::survey,
    Stage::refine, Stage::recount, Stage::seams, Stage::mend,   Stage::remend,
    Stage::retile, Stage::levels,  Stage::encode};
std::string_view stage_name(Stage stage);
// Those a run of the config has, in their order: refine, seams, mend, remend and retile where simplify.refine
// asks for them (mend and remend where triangles that intersect are mended), survey and recount where a number of triangles is asked for,
// levels where there is to be more than one.
std::vector<Stage> stages_of(const Config& config);
bool has_stage(const Config& config, Stage stage);
// As in the config file.
std::string_view refine_name(SimplifyConfig::Refine mode);
bool refines(const Config& config);
bool mends(const Config& config);
// Of a mesh that is refined only what intersects is changed.
bool only_repairs(const Config& config);
std::int64_t planned_tile_vertices(const Config& config);  // of the tiles that merge plans
bool has_levels(const Config& config);                     // of detail, beside the mesh itself

// What is told of a key, whatever it is bound to.
struct KeyFacts {
  std::string key;
  Rule rule;
  std::string description;
  bool required = false;
  // Shown where there is no fixed default value: "the whole volume".
  std::string default_note;
  std::optional<ConfigValue> default_value;

  // The default as TOML, or the note, or "required".
  std::string default_text() const;
};

struct Setting : KeyFacts {
  std::string table;
  // The stages whose artifact bytes the value may change, beyond what reaches them through their
  // inputs. Empty: no result depends on it.
  std::vector<Stage> stages;
  // Their artifacts are keyed by what the value comes to (which label stands for what, whether a mesh
  // is refined), not by the value itself: it is in no parameter_hash().
  bool by_effect = false;
  // It came after the others: where it is open it is in no parameter_hash(), so that work that was
  // done before there was such a key goes on being used.
  bool when_given = false;

  // Precondition: check(rule, value) accepts; a path is absolute.
  std::function<void(Config&, const ConfigValue&)> set;
  // The value in its one canonical form; empty where the config leaves it open.
  std::function<std::optional<ConfigValue>(const Config&)> get;

  std::string name() const { return table + "." + key; }
  bool read_by(Stage stage) const;
  std::string stages_text() const;  // "build, merge", or "none"
};

// In the order of tables and keys in a config file.
std::span<const Setting> settings();
// Null when there is none of that name.
const Setting* find_setting(std::string_view table, std::string_view key);
std::vector<std::string> table_names();
std::vector<std::string> key_names(std::string_view table);
// One line on what the table is for.
std::string_view table_description(std::string_view table);

struct StageParameter {
  std::string name;  // "table.key"
  std::optional<ConfigValue> value;
  friend bool operator==(const StageParameter&, const StageParameter&) = default;
};

// The settings a stage is keyed by, in table order, in canonical form: equal for configs that ask
// the same of the stage, however they are written. A volume's isovalue may be left to "otsu"; keys
// of artifacts need the number, so callers put it into config.surface.isovalue first.
std::vector<StageParameter> stage_parameters(const Config& config, Stage stage);
// What of the config goes into the keys and paths of the stage's artifacts. Edits do not: each
// shard of the build is keyed by those that touch it, so that a changed edit rebuilds no other.
// Filters go into ingest's; where one of them looks for pieces, with what is inside the surface.
Hash128 parameter_hash(const Config& config, Stage stage);

struct ChangedSetting {
  const Setting* setting = nullptr;  // null: of the filters or the edits
  std::string name;                  // "simplify.tolerance", "edit 2: radius", "edits 2, 5, 7"
  std::string before, after;  // as TOML, or the default's note where unset; empty for several edits
  std::vector<Stage> stages;  // whose artifacts may change with it

  bool read_by(Stage stage) const;
  std::string text() const;  // "simplify.tolerance was 0.1, is 0.2"
};
// In table order, then filters, then edits. For messages that say why a stage runs again.
std::vector<ChangedSetting> changed_settings(const Config& before, const Config& after);

}  // namespace voxweld
