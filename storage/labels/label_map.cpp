#include "storage/labels/label_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <iterator>
#include <system_error>

#include "storage/labels/label_map_rows.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "storage/support/text_fields.h"

namespace voxweld {
namespace {

constexpr std::uint64_t most_told = 3;  // rows whose labels are left out by an empty cell

constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";

std::optional<std::uint64_t> whole(std::string_view text) {
  std::uint64_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stop != end) return std::nullopt;
  return value;
}

// How many bytes follow the first of a character; nothing where it begins none.
std::optional<std::size_t> bytes_that_follow(unsigned char first) {
  if (first < 0x80) return 0;
  if (first >= 0xc2 && first < 0xe0) return 1;
  if (first >= 0xe0 && first < 0xf0) return 2;
  if (first >= 0xf0 && first < 0xf5) return 3;
  return std::nullopt;
}

bool is_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto first = static_cast<unsigned char>(text[i]);
    const auto more = bytes_that_follow(first);
    if (!more || i + *more >= text.size()) return false;
    // Too long a form, a surrogate, or beyond the last code point.
    const auto second = static_cast<unsigned char>(*more > 0 ? text[i + 1] : 0x80);
    if ((first == 0xe0 && second < 0xa0) || (first == 0xed && second > 0x9f) ||
        (first == 0xf0 && second < 0x90) || (first == 0xf4 && second > 0x8f))
      return false;
    for (std::size_t k = 0; k < *more; ++k)
      if ((static_cast<unsigned char>(text[++i]) & 0xc0) != 0x80) return false;
  }
  return true;
}

bool has_control(std::string_view text) {
  return std::any_of(text.begin(), text.end(),
                     [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; });
}

Material material_of(const LabelMapRow& row) {
  return row.own ? row.labels.first : row.material;
}

// By the name where it says so, else by the first character that is neither blank nor a comment's.
bool is_json(const std::string& extension, std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  const bool opens = first != std::string_view::npos && (text[first] == '{' || text[first] == '[');
  return extension == ".json" || opens;
}

bool is_color_table(const std::string& extension, std::string_view text) {
  if (extension == ".csv" || extension == ".tsv") return false;
  std::size_t at = 0;
  for (std::string_view line; next_line(text, at, line);) {
    line = trim(line);
    if (line.empty() || line.front() == '#') continue;
    return line.front() >= '0' && line.front() <= '9';
  }
  return false;
}

}  // namespace

std::string shown_cell(std::string_view cell) {
  std::string text;
  for (const char c : cell.substr(0, 40))
    text += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
  return cell.size() > 40 ? text + "..." : text;
}

bool is_slip_of(std::string_view slip, std::string_view word) {
  if (slip.size() > word.size()) std::swap(slip, word);
  if (word.size() - slip.size() > 1) return false;
  const auto [a, b] = std::mismatch(slip.begin(), slip.end(), word.begin(), word.end());
  const std::string_view left(a, slip.end()), right(b, word.end());
  if (left.size() < right.size()) return left == right.substr(1);
  if (left.empty()) return false;
  if (left.substr(1) == right.substr(1)) return true;
  return left.size() > 1 && left[0] == right[1] && left[1] == right[0] &&
         left.substr(2) == right.substr(2);
}

bool next_line(std::string_view text, std::size_t& at, std::string_view& line) {
  if (at >= text.size()) return false;
  const std::size_t stop = std::min(text.find('\n', at), text.size());
  line = text.substr(at, stop - at);
  if (line.ends_with('\r')) line.remove_suffix(1);
  at = stop + 1;
  return true;
}

void LabelMapRows::fail(std::uint64_t line, const std::string& problem) const {
  throw FormatError(fmt::format("{}:{}: {}", path_, line, problem));
}

void LabelMapRows::warn(std::uint64_t line, const std::string& problem) {
  warnings_.push_back(fmt::format("{}:{}: {}", path_, line, problem));
}

void LabelMapRows::warn_left_out(std::uint64_t line, std::size_t column, const LabelRange& labels) {
  if (++left_out_ > most_told) return;
  const std::string which = labels.first == labels.last
                                ? fmt::format("label {} is", labels.first)
                                : fmt::format("labels {}-{} are", labels.first, labels.last);
  warn(line, fmt::format("column {} (material) is empty, so {} left out; write -1 if that is meant",
                         column, which));
}

LabelRange LabelMapRows::labels(std::string_view cell, std::uint64_t line) const {
  cell = trim(cell);
  const std::size_t dash = cell.find('-');
  const auto first = whole(trim(cell.substr(0, dash)));
  const auto last = dash == std::string_view::npos ? first : whole(trim(cell.substr(dash + 1)));
  if (!first || !last)
    fail(line, fmt::format("expected a label, a whole number of at least 0, or a range such as "
                           "10-20, found '{}'",
                           shown_cell(cell)));
  if (*first > *last)
    fail(line, fmt::format("expected the lower label of a range first, found '{}'", cell));
  if (*last > highest_label)
    fail(line, fmt::format("label {}: labels end at {}", *last, highest_label));
  return {*first, *last};
}

void LabelMapRows::set_material(std::uint64_t material, LabelMapRow& row) const {
  if (material > highest_label)
    fail(row.line, fmt::format("material {}: materials end at {}", material, highest_label));
  row.own = false;
  row.material = material;
}

void LabelMapRows::set_material(std::string_view cell, LabelMapRow& row) const {
  cell = trim(cell);
  if (cell.empty() || cell == "-1") {
    row.own = false;
    row.material = exterior;
    return;
  }
  const auto material = whole(cell);
  if (!material)
    fail(row.line, fmt::format("expected a material, a whole number of at least 0, or nothing or "
                               "-1 for a label that is left out, found '{}'",
                               shown_cell(cell)));
  set_material(*material, row);
}

std::uint8_t LabelMapRows::shade(std::string_view cell, std::uint64_t line) const {
  const auto value = whole(trim(cell));
  if (!value || *value > 255)
    fail(line, fmt::format("expected a shade of a colour, a whole number from 0 to 255, found '{}'",
                           shown_cell(cell)));
  return static_cast<std::uint8_t>(*value);
}

MaterialColor LabelMapRows::color(std::string_view cell, std::uint64_t line) const {
  const std::string_view text = trim(cell);
  std::uint32_t hex = 0;
  if (text.size() == 7 && text.front() == '#') {
    const auto [stop, error] = std::from_chars(text.data() + 1, text.data() + 7, hex, 16);
    if (error == std::errc{} && stop == text.data() + 7)
      return {static_cast<std::uint8_t>(hex >> 16), static_cast<std::uint8_t>(hex >> 8 & 255),
              static_cast<std::uint8_t>(hex & 255)};
  }
  std::string numbers(text);
  std::replace_if(
      numbers.begin(), numbers.end(),
      [](char c) { return std::string_view(",;()[]").find(c) != std::string_view::npos; }, ' ');
  const std::vector<std::string> words = split_words(numbers);
  if (words.size() != 3 || text.front() == '#')
    fail(line, fmt::format("expected a colour such as #ff8000 or 255,128,0, found '{}'",
                           shown_cell(cell)));
  return {shade(words[0], line), shade(words[1], line), shade(words[2], line)};
}

void LabelMapRows::add(LabelMapRow row) {
  row.name = trim(row.name);
  if (!is_utf8(row.name))
    fail(row.line, fmt::format("the name of label {} is not UTF-8; save the file in that encoding",
                               row.labels.first));
  if (has_control(row.name))
    fail(row.line, fmt::format("the name of label {} holds a line break or another control "
                               "character: '{}'",
                               row.labels.first, shown_cell(row.name)));
  const bool several = row.labels.first != row.labels.last;
  if (several && row.own && (!row.name.empty() || row.color))
    fail(row.line, fmt::format("the labels {}-{} have one name or colour but no material that they "
                               "become part of; give one, or name each label",
                               row.labels.first, row.labels.last));
  rows_.push_back(std::move(row));
}

// Sorted are small keys and not the rows: of a million labels in no order that takes a third of the
// time.
std::vector<LabelMapRows::Key> LabelMapRows::in_order() const {
  std::vector<Key> order;
  order.reserve(rows_.size());
  for (std::size_t i = 0; i < rows_.size(); ++i) order.push_back({rows_[i].labels.first, i});
  std::sort(order.begin(), order.end());
  return order;
}

void LabelMapRows::check_named_once(const std::vector<Key>& order) const {
  for (std::size_t i = 1; i < order.size(); ++i) {
    const LabelMapRow& before = rows_[order[i - 1].row];
    const LabelMapRow& row = rows_[order[i].row];
    if (row.labels.first > before.labels.last) continue;
    const auto [earlier, later] = std::minmax(before.line, row.line);
    fail(later, fmt::format("label {} is named in line {} already; keep one of the two",
                            row.labels.first, earlier));
  }
}

// Of what several rows say of a material, the word of its own label first, then of the first line.
MaterialTable LabelMapRows::table() {
  std::vector<Key> own, telling;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const LabelMapRow& row = rows_[i];
    const Material material = material_of(row);
    if (material == exterior || (row.name.empty() && !row.color)) continue;
    const bool of_own = row.labels.first <= material && material <= row.labels.last;
    (of_own ? own : telling).push_back({material, i});
  }
  // Rows come in the order of their lines.
  std::sort(own.begin(), own.end());
  std::sort(telling.begin(), telling.end());
  std::vector<Key> all;
  all.reserve(own.size() + telling.size());
  std::merge(own.begin(), own.end(), telling.begin(), telling.end(), std::back_inserter(all),
             [](const Key& a, const Key& b) { return a.number < b.number; });
  MaterialTable table;
  for (const Key& key : all) {
    if (table.entries.empty() || table.entries.back().material != key.number)
      table.entries.push_back({key.number, {}, {}});
    MaterialEntry& entry = table.entries.back();
    LabelMapRow& row = rows_[key.row];
    if (entry.name.empty()) entry.name = std::move(row.name);
    if (!entry.color) entry.color = row.color;
  }
  return table;
}

LabelMap LabelMapRows::finish() {
  const std::vector<Key> order = in_order();
  check_named_once(order);
  LabelMap map;
  map.entries.reserve(rows_.size());
  for (const Key& key : order) {
    const LabelMapRow& row = rows_[key.row];
    map.entries.push_back({row.labels.first, row.labels.last, row.own, row.material});
  }
  map.materials = table();
  map.warnings = std::move(warnings_);
  if (left_out_ > most_told)
    map.warnings.push_back(
        fmt::format("{}: column material is empty in {} more lines, and their labels are left out",
                    path_, left_out_ - most_told));
  return map;
}

LabelMap parse_label_map(std::string_view text, const std::filesystem::path& path) {
  const std::string extension = lower(path.extension().string());
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
    throw FormatError(path.string() + ": is in UTF-16; save it as UTF-8");
  if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
  LabelMapRows rows(path.string());
  rows.reserve(static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')) + 1);
  if (is_json(extension, text))
    parse_json_label_map(text, rows);
  else if (is_color_table(extension, text))
    parse_color_table(text, rows);
  else
    parse_csv_label_map(text, rows);
  return rows.finish();
}

LabelMap read_label_map(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status))
    throw InputError(path.string() + ": no such file of labels; check the path");
  if (!std::filesystem::is_regular_file(status))
    throw InputError(path.string() + ": expected a file of labels, found a directory or device");
  return parse_label_map(read_text_file(path), path);
}

}  // namespace voxweld
