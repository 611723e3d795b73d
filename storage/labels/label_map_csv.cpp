// Label maps as tables with a header row (RFC 4180, and what spreadsheets make of it).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <deque>

#include "storage/labels/label_map_rows.h"
#include "storage/support/text_fields.h"

namespace voxweld {
namespace {

constexpr std::size_t none = static_cast<std::size_t>(-1);

enum Column : std::size_t { label, material, name, color, red, green, blue, columns };

// The names of each column, without spaces, underscores and capitals; the first is for messages.
const std::array<std::vector<std::string_view>, columns>& column_names() {
  static const std::array<std::vector<std::string_view>, columns> names = {{
      {"label", "id", "index", "old", "value", "labelid", "oldid", "labelvalue"},
      {"material", "new", "newid", "materialid", "target", "group"},
      {"name", "labelname", "structure", "title"},
      {"color", "colour", "rgb", "hex"},
      {"r", "red", "colorr", "colourr"},
      {"g", "green", "colorg", "colourg"},
      {"b", "blue", "colorb", "colourb"},
  }};
  return names;
}

// Rows of cells, which live until the next row.
class CsvReader {
 public:
  CsvReader(std::string_view text, const LabelMapRows& rows) : text_(text), rows_(rows) {}

  bool next() {
    cells_.clear();
    unquoted_.clear();
    while (at_ < text_.size()) {
      line_ = next_line_;
      std::size_t stop = std::min(text_.find('\n', at_), text_.size());
      const std::string_view line = trim(text_.substr(at_, stop - at_));
      if (line.empty() || line.front() == '#') {
        at_ = stop + 1;
        ++next_line_;
        continue;
      }
      if (separator_ == 0) separator_ = separator_of(line);
      read_row();
      return true;
    }
    return false;
  }
  const std::vector<std::string_view>& cells() const { return cells_; }
  std::uint64_t line() const { return line_; }  // the row begins in

 private:
  // The one that the header has most of, outside of quotes.
  static char separator_of(std::string_view header) {
    constexpr std::string_view all = ",;\t";
    std::array<std::size_t, 3> count{};
    bool quoted = false;
    for (const char c : header) {
      if (c == '"') quoted = !quoted;
      const std::size_t which = all.find(c);
      if (!quoted && which != std::string_view::npos) ++count[which];
    }
    return all[static_cast<std::size_t>(std::max_element(count.begin(), count.end()) -
                                        count.begin())];
  }

  void read_row() {
    for (bool more = true; more;) {
      while (at_ < text_.size() && text_[at_] == ' ') ++at_;
      more = at_ < text_.size() && text_[at_] == '"' ? read_quoted() : read_plain();
    }
  }

  // Both return whether another cell follows in the row.
  bool read_plain() {
    const std::size_t stop = std::min(text_.find_first_of(separator_ == ','   ? ",\n"
                                                          : separator_ == ';' ? ";\n"
                                                                              : "\t\n",
                                                          at_),
                                      text_.size());
    cells_.push_back(trim(text_.substr(at_, stop - at_)));
    return end_cell(stop);
  }

  bool read_quoted() {
    std::string& cell = unquoted_.emplace_back();
    for (++at_;; ++at_) {
      const std::size_t stop = text_.find('"', at_);
      if (stop == std::string_view::npos) rows_.fail(line_, "a quote is opened and never closed");
      cell.append(text_.substr(at_, stop - at_));
      at_ = stop + 1;
      if (at_ >= text_.size() || text_[at_] != '"') break;
      cell += '"';  // twice: one that belongs to the cell
    }
    next_line_ += static_cast<std::uint64_t>(std::count(cell.begin(), cell.end(), '\n'));
    cells_.push_back(cell);
    std::size_t stop = at_;
    while (stop < text_.size() && (text_[stop] == ' ' || text_[stop] == '\r')) ++stop;
    if (stop < text_.size() && text_[stop] != separator_ && text_[stop] != '\n')
      rows_.fail(line_,
                 fmt::format("text behind the closing quote of '{}'; write a quote inside of "
                             "quotes twice",
                             shown_cell(cell)));
    return end_cell(stop);
  }

  bool end_cell(std::size_t stop) {
    at_ = stop + 1;
    const bool more = stop < text_.size() && text_[stop] != '\n';
    if (!more) ++next_line_;
    return more;
  }

  std::string_view text_;
  const LabelMapRows& rows_;
  std::size_t at_ = 0;
  std::uint64_t line_ = 0, next_line_ = 1;
  char separator_ = 0;
  std::vector<std::string_view> cells_;
  std::deque<std::string> unquoted_;
};

std::string plain(std::string_view cell) {
  std::string text = lower(cell);
  std::erase_if(text, [](char c) { return c == ' ' || c == '_' || c == '-'; });
  return text;
}

// Where each column stands in the header; `none` where it does not.
class Header {
 public:
  Header(const CsvReader& reader, LabelMapRows& rows) : cells_(reader.cells().size()) {
    at_.fill(none);
    for (std::size_t i = 0; i < cells_; ++i) {
      const Column column = column_of(plain(reader.cells()[i]));
      if (column == columns) continue;
      if (at_[column] != none)
        rows.fail(reader.line(), fmt::format("the columns {} and {} are both of the {}",
                                             at_[column] + 1, i + 1, column_names()[column][0]));
      at_[column] = i;
    }
    if (at_[label] == none)
      rows.fail(reader.line(),
                fmt::format("expected a header row such as label,material,name,color, found '{}'",
                            shown_cell(reader.cells()[0])));
    check_slips(reader, rows);
    warn_unknown(reader, rows);
    if (at_[color] == 0)
      rows.fail(reader.line(),
                "the first column is the colour, and lines that begin with # are "
                "comments; put another column first");
    if ((at_[red] == none) != (at_[green] == none) || (at_[red] == none) != (at_[blue] == none))
      rows.fail(reader.line(), "expected the columns r, g and b, found some of them");
  }

  // From 1.
  std::size_t number(Column column) const { return at_[column] + 1; }
  bool has(Column column) const { return at_[column] != none; }
  // Empty where the row ends before.
  std::string_view cell(const CsvReader& reader, Column column) const {
    return at_[column] < reader.cells().size() ? reader.cells()[at_[column]] : std::string_view();
  }
  void check_row(const CsvReader& reader, const LabelMapRows& rows) const {
    const auto& cells = reader.cells();
    const bool longer =
        std::any_of(cells.begin() + static_cast<std::ptrdiff_t>(std::min(cells_, cells.size())),
                    cells.end(), [](std::string_view cell) { return !cell.empty(); });
    const bool shorter = has(material) && cells.size() <= at_[material];
    if (longer || shorter)
      rows.fail(reader.line(), fmt::format("expected {} cells as in the header row, found {}",
                                           cells_, cells.size()));
  }

 private:
  // A column that is not there, and another that is meant to be it.
  void check_slips(const CsvReader& reader, const LabelMapRows& rows) const {
    for (const std::string_view title : reader.cells())
      for (const Column column : {material, name, color})
        if (!has(column) && column_of(plain(title)) == columns &&
            is_slip_of(plain(title), column_names()[column][0]))
          rows.fail(reader.line(), fmt::format("unknown column '{}'; did you mean {}?",
                                               shown_cell(title), column_names()[column][0]));
  }

  static void warn_unknown(const CsvReader& reader, LabelMapRows& rows) {
    std::string unknown;
    std::size_t count = 0;
    for (std::size_t i = 0; i < reader.cells().size(); ++i) {
      const std::string_view title = reader.cells()[i];
      if (trim(title).empty() || column_of(plain(title)) != columns) continue;
      unknown += fmt::format("{}{} ({})", count++ == 0 ? "" : ", ", i + 1, shown_cell(title));
    }
    if (count > 0)
      rows.warn(reader.line(), fmt::format("column {} {} not looked at; known are label, material, "
                                           "name, color, r, g and b",
                                           unknown, count == 1 ? "is" : "are"));
  }

  static Column column_of(const std::string& title) {
    for (std::size_t column = 0; column < columns; ++column) {
      const auto& names = column_names()[column];
      if (std::find(names.begin(), names.end(), title) != names.end())
        return static_cast<Column>(column);
    }
    return columns;
  }

  std::size_t cells_;
  std::array<std::size_t, columns> at_;
};

}  // namespace

void parse_csv_label_map(std::string_view text, LabelMapRows& rows) {
  CsvReader reader(text, rows);
  if (!reader.next())
    rows.fail(1, "expected a header row such as label,material,name,color, found no text");
  const Header header(reader, rows);
  while (reader.next()) {
    header.check_row(reader, rows);
    const auto cell = [&](Column column) { return header.cell(reader, column); };
    LabelMapRow row;
    row.line = reader.line();
    row.labels = rows.labels(cell(label), row.line);
    if (header.has(material)) {
      rows.set_material(cell(material), row);
      if (trim(cell(material)).empty())
        rows.warn_left_out(row.line, header.number(material), row.labels);
    }
    row.name = cell(name);
    if (header.has(red) && !(cell(red).empty() && cell(green).empty() && cell(blue).empty()))
      row.color = {rows.shade(cell(red), row.line), rows.shade(cell(green), row.line),
                   rows.shade(cell(blue), row.line)};
    if (!cell(color).empty()) row.color = rows.color(cell(color), row.line);
    rows.add(std::move(row));
  }
}

}  // namespace voxweld
