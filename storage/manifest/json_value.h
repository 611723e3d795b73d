// Reading JSON so that whatever is wrong with it is named, and the pieces that the manifest and its
// lists have in common.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "storage/manifest/manifest.h"
#include "storage/support/error.h"
#include "storage/support/json_text.h"

namespace voxweld {

// A JSON value and where it stands, so that whatever is wrong with it is named.
class JsonValue {
 public:
  JsonValue(const nlohmann::json& value, std::string where, std::string key)
      : value_(value), where_(std::move(where)), key_(std::move(key)) {}

  [[noreturn]] void wrong(const std::string& expected) const {
    throw FormatError(fmt::format("{}: {} is {}, expected {}", where_,
                                  key_.empty() ? "the document" : "\"" + key_ + "\"",
                                  shortened(json_text(value_)), expected));
  }
  bool has(const char* key) const { return value_.is_object() && value_.contains(key); }
  bool is_null() const { return value_.is_null(); }
  JsonValue at(const char* key) const {
    if (!value_.is_object()) wrong("an object");
    const auto found = value_.find(key);
    if (found == value_.end())
      throw FormatError(fmt::format("{}: \"{}\" is missing", where_, joined(key)));
    return {*found, where_, joined(key)};
  }
  std::vector<std::string> keys() const {
    if (!value_.is_object()) wrong("an object");
    std::vector<std::string> out;
    for (const auto& [key, value] : value_.items()) out.push_back(key);
    return out;
  }
  std::vector<JsonValue> items() const {
    if (!value_.is_array()) wrong("an array");
    std::vector<JsonValue> out;
    for (std::size_t i = 0; i < value_.size(); ++i)
      out.emplace_back(value_[i], where_, fmt::format("{}[{}]", key_, i));
    return out;
  }
  std::vector<JsonValue> items(std::size_t count) const {
    if (!value_.is_array() || value_.size() != count) wrong(fmt::format("{} values", count));
    return items();
  }
  std::string text() const {
    if (!value_.is_string()) wrong("a text");
    return value_.get<std::string>();
  }
  bool choice(const std::string& no, const std::string& yes) const {
    const std::string found = text();
    if (found != no && found != yes) wrong(fmt::format("\"{}\" or \"{}\"", no, yes));
    return found == yes;
  }
  std::uint64_t count() const {
    if (!value_.is_number_unsigned()) wrong("a count");
    return value_.get<std::uint64_t>();
  }
  std::int64_t integer(std::int64_t lo, std::int64_t hi) const {
    if (!value_.is_number_integer() || value_ < lo || value_ > hi)
      wrong(fmt::format("an integer from {} to {}", lo, hi));
    return value_.get<std::int64_t>();
  }
  double real() const {
    if (!value_.is_number() || !std::isfinite(value_.get<double>())) wrong("a number");
    return value_.get<double>();
  }
  double positive() const {
    if (!(real() > 0)) wrong("a number above 0");
    return real();
  }
  Vec3 vector() const {
    const auto v = items(3);
    return {v[0].real(), v[1].real(), v[2].real()};
  }
  const nlohmann::json& raw() const { return value_; }

 private:
  static std::string shortened(const std::string& text) {
    return text.size() <= 60 ? text : text.substr(0, 57) + "...";
  }
  std::string joined(const std::string& key) const { return key_.empty() ? key : key_ + "." + key; }
  const nlohmann::json& value_;
  std::string where_, key_;
};

nlohmann::ordered_json to_json(Vec3 v);
nlohmann::ordered_json to_json(Index3 v);
nlohmann::ordered_json to_json(const FileRecord& file);

// Relative and inside the directory: a manifest must not send its reader elsewhere.
std::string relative_path(const JsonValue& value);
FileRecord file_record(const JsonValue& value, bool with_role);
// FormatError naming `where`.
nlohmann::json parse_text(const std::string& text, const std::string& where);

}  // namespace voxweld
