// What the parsers of label maps share; for label_map.cpp.
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "storage/labels/label_map.h"
#include "storage/types/label_range.h"

namespace voxweld {

struct LabelMapRow {
  std::uint64_t line = 0;  // from 1
  LabelRange labels;
  bool own = true;  // each stays what it is
  Material material = exterior;
  std::string name;
  std::optional<MaterialColor> color;
};

class LabelMapRows {
 public:
  explicit LabelMapRows(std::string path) : path_(std::move(path)) {}

  // The cells of a row. FormatError where they are not what their column holds.
  LabelRange labels(std::string_view cell, std::uint64_t line) const;
  void set_material(std::string_view cell, LabelMapRow& row) const;
  void set_material(std::uint64_t material, LabelMapRow& row) const;
  MaterialColor color(std::string_view cell, std::uint64_t line) const;
  std::uint8_t shade(std::string_view cell, std::uint64_t line) const;  // 0 .. 255

  // Warnings are kept for the map; of those that one slip repeats, the first few are told.
  void warn(std::uint64_t line, const std::string& problem);
  void warn_left_out(std::uint64_t line, std::size_t column, const LabelRange& labels);

  void reserve(std::size_t rows) { rows_.reserve(rows); }
  void add(LabelMapRow row);
  LabelMap finish();

  [[noreturn]] void fail(std::uint64_t line, const std::string& problem) const;

 private:
  struct Key {
    std::uint64_t number = 0;  // a label or a material
    std::size_t row = 0;
    friend auto operator<=>(const Key&, const Key&) = default;
  };
  std::vector<Key> in_order() const;
  void check_named_once(const std::vector<Key>& order) const;
  MaterialTable table();

  std::string path_;
  std::vector<LabelMapRow> rows_;
  std::vector<std::string> warnings_;
  std::uint64_t left_out_ = 0;  // rows
};

// A cell in messages: short, in one line.
std::string shown_cell(std::string_view cell);

void parse_csv_label_map(std::string_view text, LabelMapRows& rows);
void parse_json_label_map(std::string_view text, LabelMapRows& rows);
void parse_color_table(std::string_view text, LabelMapRows& rows);

// Whether the one is the other but for a letter that is missing, too many or another, or two that
// changed places.
bool is_slip_of(std::string_view slip, std::string_view word);

// The next line of `text` from `at` on, without its end; moves `at` behind it. False at the end.
bool next_line(std::string_view text, std::size_t& at, std::string_view& line);

}  // namespace voxweld
