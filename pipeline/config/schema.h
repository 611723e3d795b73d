// The JSON schema of the config, for editors. configs/voxweld.schema.json is this text.
#pragma once

#include <string>

namespace voxweld {

// JSON Schema draft 7 (what TOML editors read), indented, with a final newline.
std::string config_schema_json();

}  // namespace voxweld
