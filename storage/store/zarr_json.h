// Checked access to the fields of a JSON document, with messages that name the file and the field.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "storage/support/error.h"
#include "storage/support/json_text.h"

namespace voxweld {

// One JSON value and where it is: "<file>: codecs[0].configuration".
class JsonField {
 public:
  JsonField(const nlohmann::ordered_json& value, std::string file, std::string where)
      : value_(value), file_(std::move(file)), where_(std::move(where)) {}

  const nlohmann::ordered_json& value() const { return value_; }

  [[noreturn]] void refuse(const std::string& what) const {
    throw FormatError(where_.empty() ? file_ + ": " + what
                                     : fmt::format("{}: {}: {}", file_, where_, what));
  }
  std::string shown() const {  // the value, cut to what fits a message
    std::string text = json_ascii_text(value_);
    if (text.size() > 60) text = text.substr(0, 57) + "...";
    return text;
  }

  bool has(const char* name) const { return value_.is_object() && value_.contains(name); }
  JsonField at(const char* name) const {
    if (!value_.is_object()) refuse("an object expected, " + shown() + " found");
    const auto found = value_.find(name);
    if (found == value_.end()) refuse(fmt::format("no \"{}\" in it", name));
    return {*found, file_, where_.empty() ? name : fmt::format("{}.{}", where_, name)};
  }
  std::vector<JsonField> elements() const {
    if (!value_.is_array()) refuse("a list expected, " + shown() + " found");
    std::vector<JsonField> all;
    for (std::size_t i = 0; i < value_.size(); ++i)
      all.emplace_back(value_[i], file_, fmt::format("{}[{}]", where_, i));
    return all;
  }

  std::string text() const {
    if (!value_.is_string()) refuse("a text expected, " + shown() + " found");
    return value_.get<std::string>();
  }
  double real() const {
    if (!value_.is_number()) refuse("a number expected, " + shown() + " found");
    return value_.get<double>();
  }
  std::int64_t integer(std::int64_t lo, std::int64_t hi) const {
    const bool fits = value_.is_number_unsigned()
                          ? value_.get<std::uint64_t>() <= static_cast<std::uint64_t>(INT64_MAX)
                          : value_.is_number_integer();
    const std::int64_t v = fits ? value_.get<std::int64_t>() : 0;
    if (!fits || v < lo || v > hi)
      refuse(fmt::format("an integer from {} to {} expected, {} found", lo, hi, shown()));
    return v;
  }

 private:
  const nlohmann::ordered_json& value_;
  std::string file_, where_;
};

}  // namespace voxweld
