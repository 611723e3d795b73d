// JSON as text. Names of files and words of headers may be any bytes: what is not UTF-8 in them is
// replaced (U+FFFD) rather than refused.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace voxweld {

// indent: spaces a level; -1: all in one line. Ends without a newline.
std::string json_text(const nlohmann::json& value, int indent = -1);
std::string json_text(const nlohmann::ordered_json& value, int indent = -1);
// The same in ASCII alone.
std::string json_ascii_text(const nlohmann::json& value, int indent = -1);
std::string json_ascii_text(const nlohmann::ordered_json& value, int indent = -1);

}  // namespace voxweld
