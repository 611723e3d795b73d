#include "storage/support/json_text.h"

#include <nlohmann/json.hpp>

namespace voxweld {
namespace {

template <class Json>
std::string text_of(const Json& value, int indent, bool ascii) {
  return value.dump(indent, ' ', ascii, Json::error_handler_t::replace);
}

}  // namespace

std::string json_text(const nlohmann::json& value, int indent) {
  return text_of(value, indent, false);
}
std::string json_text(const nlohmann::ordered_json& value, int indent) {
  return text_of(value, indent, false);
}
std::string json_ascii_text(const nlohmann::json& value, int indent) {
  return text_of(value, indent, true);
}
std::string json_ascii_text(const nlohmann::ordered_json& value, int indent) {
  return text_of(value, indent, true);
}

}  // namespace voxweld
