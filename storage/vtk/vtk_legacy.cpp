#include "storage/vtk/vtk_legacy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <limits>
#include <optional>
#include <utility>

#include "storage/support/error.h"
#include "storage/support/text_fields.h"
#include "storage/volumes/data_layout.h"

namespace voxweld {
namespace {

constexpr std::uint64_t most_values = std::uint64_t{1} << 58;
constexpr std::size_t most_arrays = 10'000;

// 64 bits are what VTK writes for a long on the systems that it mostly runs on. The first and the
// last are integers of 32 and 64 bits in every file.
constexpr std::pair<const char*, SampleType> legacy_types[] = {
    {"vtkidtype", SampleType::i32},
    {"unsigned_char", SampleType::u8},
    {"char", SampleType::i8},
    {"signed_char", SampleType::i8},
    {"unsigned_short", SampleType::u16},
    {"short", SampleType::i16},
    {"unsigned_int", SampleType::u32},
    {"int", SampleType::i32},
    {"unsigned_long", SampleType::u64},
    {"long", SampleType::i64},
    {"unsigned_long_long", SampleType::u64},
    {"long_long", SampleType::i64},
    {"float", SampleType::f32},
    {"double", SampleType::f64},
    {"vtktypeuint64", SampleType::u64},
    {"vtktypeint64", SampleType::i64}};

// "%20" stands for a blank in names.
std::string decoded_name(const std::string& text) {
  std::string name;
  const auto digit = [](char c) {
    return c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : c - 'A' + 10;
  };
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool coded = text[i] == '%' && i + 2 < text.size() &&
                       std::isxdigit(static_cast<unsigned char>(text[i + 1])) != 0 &&
                       std::isxdigit(static_cast<unsigned char>(text[i + 2])) != 0;
    if (!coded) {
      name += text[i];
      continue;
    }
    name += static_cast<char>(digit(text[i + 1]) * 16 + digit(text[i + 2]));
    i += 2;
  }
  return name;
}

// The offset behind `count` words from `begin` on.
std::uint64_t behind_words(const ReadFile& file, std::uint64_t begin, std::uint64_t count) {
  std::vector<std::byte> block;
  bool inside = false;
  for (std::uint64_t at = begin; at < file.size(); at += block.size()) {
    block.resize(static_cast<std::size_t>(std::min<std::uint64_t>(1U << 18, file.size() - at)));
    file.read(at, block);
    for (std::size_t i = 0; i < block.size(); ++i) {
      const auto c = std::to_integer<char>(block[i]);
      const bool blank = c == ' ' || (c >= '\t' && c <= '\r');
      if (blank && inside && --count == 0) return at + i;
      inside = !blank;
    }
  }
  if (inside) --count;
  if (count == 0) return file.size();
  throw FormatError(
      fmt::format("{}: truncated: {} numbers are missing at the end of the file: get a complete "
                  "copy or correct the sizes",
                  file.path(), count));
}

class LegacyParser {
 public:
  explicit LegacyParser(const ReadFile& file) : file_(file) {}

  LegacyHeader run() {
    read_first_lines();
    while (next_line() && !stopped_) read_section();
    if (!dataset_) fail("no line DATASET: truncated or damaged");
    if (!sized_) fail("no line DIMENSIONS: truncated or damaged");
    return std::move(header_);
  }

 private:
  using Words = std::vector<std::string>;
  enum class Section { dataset, points, cells };

  [[noreturn]] void fail(const std::string& what) const {
    throw FormatError(fmt::format("{}: byte {}: {}", file_.path(), line_begin_, what));
  }
  [[noreturn]] void reject(const std::string& expected) const {
    std::string found;
    for (const std::string& word : words_) found += (found.empty() ? "" : " ") + word;
    for (char& c : found)
      if (c < ' ' || c > '~') c = '?';
    fail(fmt::format("expected {}, found '{}'", expected, found.substr(0, 80)));
  }

  // The words of the next line, which may be blank; false at the end of the file.
  bool raw_line() {
    if (!lines_) lines_.emplace(file_, at_);
    line_begin_ = at_;
    const auto line = lines_->next();
    if (!line) return false;
    at_ = lines_->offset();
    words_ = split_words(*line);
    return true;
  }
  bool next_line() {
    do {
      if (!raw_line()) return false;
    } while (words_.empty());
    return true;
  }
  std::string keyword() const { return lower(words_[0]); }

  void jump(std::uint64_t to) {
    at_ = to;
    lines_.reset();
  }

  void read_first_lines() {
    if (!raw_line() || words_.size() < 5 || lower(words_[0] + words_[1]) != "#vtk")
      fail("not a VTK file: expected '# vtk DataFile Version' first");
    raw_line();  // a title, of any text
    if (!next_line()) fail("truncated: expected ASCII or BINARY after the title");
    header_.text = keyword() == "ascii";
    if (!header_.text && keyword() != "binary") reject("ASCII or BINARY after the title");
  }

  void read_section() {
    const std::string key = keyword();
    if (key == "dataset") {
      dataset_ = true;
      if (words_.size() != 2 || lower(words_[1]) != "structured_points")
        reject(
            "STRUCTURED_POINTS, samples on a regular lattice: other data sets are not "
            "supported");
    } else if (key == "dimensions") {
      read_dimensions();
    } else if (key == "extent") {
      read_extent();
    } else if (key == "spacing" || key == "aspect_ratio") {
      header_.lattice.spacing = reals();
    } else if (key == "origin") {
      header_.lattice.origin = reals();
    } else if (key == "point_data" || key == "cell_data") {
      if (!dataset_ || !sized_) fail("values come before DATASET and DIMENSIONS");
      section_ = key == "point_data" ? Section::points : Section::cells;
      check_count(whole(1));
    } else if (key == "metadata") {
      while (raw_line() && !words_.empty()) {
      }
    } else if (key == "field") {
      read_field();
    } else {
      read_attribute(key);
    }
  }

  std::int64_t whole(std::size_t index) const {
    const auto value = index < words_.size() ? parse_integer(words_[index]) : std::nullopt;
    if (!value || *value < 0) reject("a whole number as word " + std::to_string(index + 1));
    return *value;
  }

  Vec3 reals() const {
    Vec3 values;
    if (words_.size() != 4) reject("three numbers");
    for (int a = 0; a < 3; ++a) {
      const auto value = parse_real(words_[static_cast<std::size_t>(a) + 1]);
      if (!value) reject("three numbers");
      values[a] = *value;
    }
    return values;
  }

  void set_size(int axis, std::int64_t side) {
    if (side < 1 || side > std::int64_t{1} << 40) reject("positive sizes");
    header_.lattice.size[axis] = side;
  }
  void read_dimensions() {
    if (words_.size() != 4) reject("three sizes");
    for (int a = 0; a < 3; ++a) set_size(a, whole(static_cast<std::size_t>(a) + 1));
    check_size();
  }
  void read_extent() {
    if (words_.size() != 7) reject("first and last index along x, y and z");
    for (int a = 0; a < 3; ++a) {
      const auto i = static_cast<std::size_t>(2 * a) + 1;
      const auto lo = parse_integer(words_[i]), hi = parse_integer(words_[i + 1]);
      constexpr std::int64_t most = std::int64_t{1} << 40;
      if (!lo || !hi || *lo < -most || *hi > most || *lo > *hi)
        reject("first and last index along x, y and z");
      set_size(a, *hi - *lo + 1);
      header_.lattice.first[a] = static_cast<double>(*lo);
    }
    check_size();
  }
  void check_size() {
    sized_ = true;
    checked_volume_bytes(header_.lattice.size, SampleType::f64, file_.path());
  }

  std::int64_t values_of_section() const {
    const Index3 n = header_.lattice.size;
    if (section_ == Section::points) return n.x * n.y * n.z;
    const auto cells = [](std::int64_t side) { return std::max<std::int64_t>(1, side - 1); };
    return cells(n.x) * cells(n.y) * cells(n.z);
  }
  void check_count(std::int64_t count) const {
    if (count == values_of_section()) return;
    const Index3 n = header_.lattice.size;
    fail(fmt::format("{} values are announced for {} points a side {} x {} x {}: expected {}",
                     count, section_ == Section::points ? "the" : "the cells between", n.x, n.y,
                     n.z, values_of_section()));
  }

  // SCALARS, VECTORS and the like: one array for the points or cells.
  void read_attribute(const std::string& key) {
    struct Form {
      const char* key;
      std::int64_t components;
    };
    constexpr Form forms[] = {{"vectors", 3},   {"normals", 3},    {"tensors", 9},
                              {"tensors6", 6},  {"global_ids", 1}, {"pedigree_ids", 1},
                              {"edge_flags", 1}};
    if (key == "lookup_table") return skip_lookup_table();
    if (key == "color_scalars") return read_color_scalars();
    if (section_ == Section::dataset) reject("a line of the header, POINT_DATA or CELL_DATA");
    if (key == "scalars") return read_scalars();
    if (key == "texture_coordinates") {
      if (words_.size() != 4) reject("name, dimension and type");
      return add_array(words_[1], words_[3], whole(2));
    }
    for (const Form& form : forms) {
      if (key != form.key) continue;
      if (words_.size() != 3) reject("name and type");
      return add_array(words_[1], words_[2], form.components);
    }
    reject("a keyword of the format");
  }

  void read_scalars() {
    if (words_.size() != 3 && words_.size() != 4) reject("SCALARS, a name, a type");
    const Words said = words_;
    const std::int64_t components = said.size() == 4 ? whole(3) : 1;
    if (!next_line() || keyword() != "lookup_table") fail("expected LOOKUP_TABLE after SCALARS");
    mark(said[1]);
    add_array(said[1], said[2], components);
  }

  void mark(const std::string& name) {
    std::string& marked = section_ == Section::cells ? header_.marked_cells : header_.marked_points;
    if (marked.empty()) marked = decoded_name(name);
  }

  // Bytes in binary files; in text the same divided by 255. So VTK writes all scalars that are bytes.
  void read_color_scalars() {
    if (section_ == Section::dataset || words_.size() != 3) reject("name and number of values");
    mark(words_[1]);
    add_array(words_[1], header_.text ? "float" : "unsigned_char", whole(2));
    if (header_.text) header_.arrays.back().slope = 255;
  }

  void skip_lookup_table() {
    if (words_.size() != 3) reject("name and size");
    pass_values(whole(2), 4, 1);
  }

  void read_field() {
    if (words_.size() < 2) reject("a name and a number of arrays");
    const std::int64_t count = whole(words_.size() - 1);
    for (std::int64_t i = 0; i < count && !stopped_; ++i) {
      do {
        if (!next_line()) fail(fmt::format("truncated: array {} of {} is missing", i, count));
        if (keyword() == "metadata")
          while (raw_line() && !words_.empty()) {
          }
      } while (words_.empty());
      if (words_.size() != 4) reject("name, components, tuples and type of an array");
      const std::int64_t components = whole(1), tuples = whole(2);
      if (section_ != Section::dataset && tuples == values_of_section())
        add_array(words_[0], words_[3], components);
      else
        pass_array(words_[0], words_[3], components, tuples);
    }
  }

  static std::optional<SampleType> type_of(const std::string& name) {
    const std::string type = lower(name);
    for (const auto& [known, sample] : legacy_types)
      if (type == known) return sample;
    return {};
  }

  void add_array(const std::string& name, const std::string& type, std::int64_t components) {
    if (components < 1 || components > 1000) reject("1 to 1000 values a sample");
    if (header_.arrays.size() == most_arrays)
      fail(fmt::format("more than {} arrays: damaged", most_arrays));
    LegacyArray array;
    array.array = {.name = decoded_name(name),
                   .of_cells = section_ == Section::cells,
                   .type_name = type,
                   .type = type_of(type),
                   .components = components};
    array.begin = at_;
    pass_array(name, type, components, values_of_section());
    array.end = at_;
    header_.arrays.push_back(std::move(array));
  }

  void pass_array(const std::string& name, const std::string& type, std::int64_t components,
                  std::int64_t tuples) {
    const auto known = type_of(type);
    if (known) return pass_values(tuples, components, sample_bytes(*known));
    if (lower(type) == "bit") {
      // Eight in a byte.
      if (header_.text) return pass_values(tuples, components, 1);
      return pass_values((checked_values(tuples, components) + 7) / 8, 1, 1);
    }
    // How long its values are nobody says.
    header_.warnings.push_back(
        fmt::format("{}: byte {}: what follows array '{}' of type {} is not looked at",
                    file_.path(), line_begin_, name.substr(0, 80), type.substr(0, 80)));
    stopped_ = true;
  }

  std::int64_t checked_values(std::int64_t tuples, std::int64_t components) const {
    if (tuples > 0 && components > static_cast<std::int64_t>(most_values) / tuples)
      reject("no more values than a file holds");
    return tuples * components;
  }

  void pass_values(std::int64_t tuples, std::int64_t components, std::size_t width) {
    const auto values = static_cast<std::uint64_t>(checked_values(tuples, components));
    if (values == 0) return;
    if (header_.text) return jump(behind_words(file_, at_, values));
    const std::uint64_t bytes = values * width;
    if (bytes > file_.size() - at_)
      throw FormatError(fmt::format(
          "{}: truncated: {} bytes of values are announced from byte {} on, the file has {}: get a "
          "complete copy or correct the sizes",
          file_.path(), bytes, at_, file_.size()));
    jump(at_ + bytes);
  }

  const ReadFile& file_;
  LegacyHeader header_;
  std::optional<LineReader> lines_;
  std::uint64_t at_ = 0, line_begin_ = 0;
  Words words_;
  Section section_ = Section::dataset;
  bool dataset_ = false, sized_ = false, stopped_ = false;
};

}  // namespace

LegacyHeader read_vtk_legacy(const ReadFile& file) {
  return LegacyParser(file).run();
}

}  // namespace voxweld
