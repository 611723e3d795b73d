// Label maps in JSON, read event by event: no document is built, and each entry knows its line.
#include <fmt/format.h>

#include <iterator>
#include <nlohmann/json.hpp>

#include "storage/labels/label_map_rows.h"
#include "storage/support/text_fields.h"

namespace voxweld {
namespace {

using Json = nlohmann::json;

// Counts the lines behind it.
class Characters {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  Characters(const char* at, std::uint64_t* line) : at_(at), line_(line) {}
  reference operator*() const { return *at_; }
  Characters& operator++() {
    if (*at_ == '\n') ++*line_;
    ++at_;
    return *this;
  }
  Characters operator++(int) {
    const Characters before = *this;
    ++*this;
    return before;
  }
  friend bool operator==(const Characters& a, const Characters& b) { return a.at_ == b.at_; }

 private:
  const char* at_;
  std::uint64_t* line_;
};

class LabelMapEvents final : public nlohmann::json_sax<Json> {
 public:
  LabelMapEvents(LabelMapRows& rows, const std::uint64_t& line) : rows_(rows), line_(line) {}

  bool null() override {
    if (skipped_ > 0) return true;
    value_may_stand_here();
    if (in_entry() && field_ != "material") return done();  // as if it were not there
    return material("");
  }
  bool boolean(bool value) override { return text(value ? "true" : "false", false); }
  bool number_integer(number_integer_t value) override {
    return text(std::to_string(value), false);
  }
  bool number_unsigned(number_unsigned_t value) override {
    return text(std::to_string(value), false);
  }
  bool number_float(number_float_t, const string_t& digits) override { return text(digits, false); }
  bool string(string_t& value) override { return text(value, true); }
  bool binary(binary_t&) override { wrong("bytes"); }

  bool start_object(std::size_t) override {
    if (skips()) return true;
    if (place_ == Place::top) {
      place_ = Place::labels;
    } else if (place_ == Place::list) {
      begin_row();
      place_ = Place::entry;
      labels_known_ = false;
    } else if (place_ == Place::labels) {
      place_ = Place::entry_of_label;
    } else {
      wrong("an object");
    }
    return true;
  }
  bool key(string_t& name) override {
    if (skipped_ > 0) return true;
    if (place_ == Place::labels) {
      begin_row();
      row_.labels = rows_.labels(name, row_.line);
      labels_known_ = true;
    } else {
      field_ = lower(name);
      if (field_ == "colour") field_ = "color";
      for (const char* known : {"label", "material", "name", "color"})
        if (field_ != known && is_slip_of(field_, known))
          rows_.fail(line_,
                     fmt::format("unknown key '{}'; did you mean {}?", shown_cell(name), known));
    }
    return true;
  }
  bool end_object() override {
    if (skipped_ > 0) return unskip();
    if (place_ == Place::labels) {
      place_ = Place::behind;
      return true;
    }
    if (!labels_known_) rows_.fail(row_.line, "an entry without the key \"label\"");
    rows_.add(std::move(row_));
    place_ = place_ == Place::entry ? Place::list : Place::labels;
    return true;
  }
  bool start_array(std::size_t) override {
    if (skips()) return true;
    if (place_ == Place::top) {
      place_ = Place::list;
    } else if (in_entry() && field_ == "color") {
      outer_ = place_;
      place_ = Place::color;
      shades_.clear();
    } else {
      wrong("a list");
    }
    return true;
  }
  bool end_array() override {
    if (skipped_ > 0) return unskip();
    if (place_ == Place::list) {
      place_ = Place::behind;
    } else {
      row_.color = rows_.color(shades_, row_.line);
      place_ = outer_;
    }
    return true;
  }
  bool parse_error(std::size_t, const std::string& token, const Json::exception&) override {
    rows_.fail(line_, fmt::format("not valid JSON here: '{}'", shown_cell(token)));
  }

 private:
  enum class Place {
    top,             // nothing was read
    list,            // of entries
    labels,          // the object whose keys are labels
    entry,           // of a list
    entry_of_label,  // of the object
    color,           // the list of its shades
    behind,          // all was read
  };

  bool in_entry() const { return place_ == Place::entry || place_ == Place::entry_of_label; }

  // Whether what begins here is of no interest, with all that is in it.
  bool skips() {
    const bool known =
        field_ == "label" || field_ == "material" || field_ == "name" || field_ == "color";
    if (skipped_ > 0 || (in_entry() && !known)) return ++skipped_ > 0;
    return false;
  }
  bool unskip() {
    --skipped_;
    return true;
  }

  void begin_row() {
    row_ = LabelMapRow{};
    row_.line = line_;
  }

  void value_may_stand_here() const {
    if (place_ == Place::top || place_ == Place::list) wrong("a single value");
  }

  [[noreturn]] void wrong(const std::string& found) const {
    const char* expected = "an object of labels or a list of entries";
    if (place_ == Place::list) expected = "an entry such as {\"label\": 5, \"material\": 2}";
    if (place_ == Place::labels) expected = "an entry, a material, a name or null";
    if (place_ == Place::color) expected = "a shade from 0 to 255";
    if (in_entry()) expected = "a number or text";
    rows_.fail(line_, fmt::format("expected {}, found {}", expected, found));
  }

  // A value that is the whole entry of a label is done with it.
  bool done() {
    if (place_ == Place::labels) rows_.add(std::move(row_));
    return true;
  }
  bool material(std::string_view value) {
    rows_.set_material(value, row_);
    return done();
  }
  static bool is_number(std::string_view value) {
    const std::size_t sign = value.starts_with('-') ? 1 : 0;
    return value.size() > sign &&
           value.find_first_not_of("0123456789", sign) == std::string_view::npos;
  }

  bool text(const std::string& value, bool quoted) {
    if (skipped_ > 0) return true;
    value_may_stand_here();
    if (place_ == Place::color) {
      shades_ += value + " ";
      return true;
    }
    if (place_ == Place::labels) {
      if (!quoted || value.empty() || is_number(value)) return material(value);
      row_.name = value;
      return done();
    }
    if (field_ == "label" && place_ == Place::entry) {
      row_.labels = rows_.labels(value, row_.line);
      labels_known_ = true;
    } else if (field_ == "material") {
      rows_.set_material(value, row_);
    } else if (field_ == "name") {
      row_.name = value;
    } else if (field_ == "color" && !value.empty()) {
      row_.color = rows_.color(value, row_.line);
    }
    return true;
  }

  LabelMapRows& rows_;
  const std::uint64_t& line_;
  Place place_ = Place::top, outer_ = Place::top;
  LabelMapRow row_;
  bool labels_known_ = false;
  std::string field_;
  std::string shades_;
  int skipped_ = 0;  // how deep in something that is not looked at
};

}  // namespace

void parse_json_label_map(std::string_view text, LabelMapRows& rows) {
  std::uint64_t line = 1;
  LabelMapEvents events(rows, line);
  Json::sax_parse(Characters(text.data(), &line), Characters(text.data() + text.size(), &line),
                  &events);
}

}  // namespace voxweld
