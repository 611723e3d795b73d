#include "storage/volumes/amira_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "storage/support/error.h"
#include "storage/support/text_fields.h"

namespace voxweld {
namespace {

constexpr std::size_t most_header_bytes = std::size_t{16} << 20;
constexpr std::uint64_t most_stream_bytes = std::uint64_t{1} << 62;

// "@1" alone in a line begins a stream; its number, or nothing.
std::optional<std::int64_t> stream_mark(std::string_view line) {
  line = trim(line);
  if (line.size() < 2 || line[0] != '@') return {};
  const auto number = parse_integer(line.substr(1));
  if (!number || *number < 0) return {};
  return number;
}

constexpr std::pair<const char*, SampleType> amira_types[] = {
    {"byte", SampleType::u8},    {"short", SampleType::i16}, {"ushort", SampleType::u16},
    {"int", SampleType::i32},    {"int32", SampleType::i32}, {"uint", SampleType::u32},
    {"uint32", SampleType::u32}, {"float", SampleType::f32}, {"double", SampleType::f64}};

// The header's words: names, numbers, braces, texts in quotes (without them), "@1(HxZip,99)".
struct AmiraToken {
  std::string text;
  int line = 0;
  bool quoted = false;
};

class AmiraParser {
 public:
  explicit AmiraParser(const ReadFile& file) : file_(file) {}

  AmiraHeader run() {
    read_tokens();
    while (at_ < tokens_.size()) read_statement();
    return std::move(header_);
  }

 private:
  [[noreturn]] void fail(int line, const std::string& what) const {
    throw FormatError(fmt::format("{}:{}: {}", file_.path(), line, what));
  }
  static std::string shown(std::string_view text) {
    std::string result(text.substr(0, 80));
    for (char& c : result)
      if (c < ' ' || c > '~') c = '?';
    return result;
  }

  void read_first_line(const std::string& line) {
    const std::string text = lower(line);
    const bool known = text.starts_with("#") && (text.find("amiramesh") != std::string::npos ||
                                                 text.find("avizo") != std::string::npos);
    if (!known) fail(1, "not an Amira file: expected '# AmiraMesh' or '# Avizo' first");
    header_.text = text.find("ascii") != std::string::npos;
    if (!header_.text && text.find("binary") == std::string::npos)
      fail(1,
           fmt::format("expected ASCII, BINARY or BINARY-LITTLE-ENDIAN, found '{}'", shown(line)));
    if (text.find("little-endian") != std::string::npos) header_.byte_order = std::endian::little;
  }

  void read_tokens() {
    LineReader lines(file_);
    const auto first = lines.next();
    read_first_line(first.value_or(""));
    for (;;) {
      const std::uint64_t begin = lines.offset();
      const auto line = lines.next();
      if (!line) fail(lines.line_number(), "truncated: no line '@1', where the data begins");
      header_.data = begin;
      if (stream_mark(*line)) return;
      if (begin > most_header_bytes)
        fail(lines.line_number(),
             fmt::format("no line '@1' within {} bytes: damaged", most_header_bytes));
      split_line(*line, lines.line_number());
    }
  }

  void split_line(std::string_view line, int number) {
    const auto blank = [](char c) { return c == ' ' || c == ',' || (c >= '\t' && c <= '\r'); };
    for (std::size_t i = 0; i < line.size();) {
      const char c = line[i];
      if (c == '#') return;
      if (blank(c)) {
        ++i;
      } else if (c == '{' || c == '}' || c == '=') {
        tokens_.push_back({std::string(1, c), number});
        ++i;
      } else if (c == '"') {
        const std::size_t end = std::min(line.find('"', i + 1), line.size());
        tokens_.push_back({std::string(line.substr(i + 1, end - i - 1)), number, true});
        i = end + 1;
      } else {
        std::size_t end = i;
        bool inside = false;  // parentheses
        for (; end < line.size(); ++end) {
          inside = (inside || line[end] == '(') && line[end] != ')';
          if (!inside && (blank(line[end]) ||
                          std::string_view("{}=\"").find(line[end]) != std::string_view::npos))
            break;
        }
        tokens_.push_back({std::string(line.substr(i, end - i)), number});
        i = end;
      }
    }
  }

  const AmiraToken& next(const char* expected) {
    if (at_ == tokens_.size())
      fail(tokens_.empty() ? 1 : tokens_.back().line,
           fmt::format("the header ends where {} was expected", expected));
    return tokens_[at_++];
  }
  bool next_is(const char* text) const {
    return at_ < tokens_.size() && !tokens_[at_].quoted && tokens_[at_].text == text;
  }

  void read_statement() {
    const AmiraToken& word = next("a statement");
    if (word.text == "define") return read_sizes(next("a name").text);
    if (word.text == "nLattice") return read_sizes("Lattice");
    if (!next_is("{")) return;  // of other words nothing is needed
    if (word.text == "Parameters") return read_parameters();
    read_array(word);
  }

  void read_sizes(const std::string& name) {
    std::vector<std::int64_t> sizes;
    while (at_ < tokens_.size() && sizes.size() < 8) {
      const auto number = parse_integer(tokens_[at_].text);
      if (!number || tokens_[at_].quoted) break;
      if (*number < 0) fail(tokens_[at_].line, fmt::format("'{}' has a size below 0", shown(name)));
      sizes.push_back(*number);
      ++at_;
    }
    header_.sizes[name] = std::move(sizes);
  }

  // Names and their values, and groups of these.
  void read_parameters() {
    std::vector<std::string> groups;
    std::string last = "Parameters";
    do {
      const AmiraToken& token = next("}");
      if (token.text == "{" && !token.quoted) {
        groups.push_back(last);
        if (groups.size() == 3 && groups[1] == "Materials") header_.materials.push_back(last);
        if (groups.size() > 100) fail(token.line, "groups a hundred deep: damaged");
      } else if (token.text == "}" && !token.quoted) {
        groups.pop_back();
      } else {
        last = token.text;
        if (!token.quoted) read_parameter(token, groups);
      }
    } while (!groups.empty());
  }

  void read_parameter(const AmiraToken& name, const std::vector<std::string>& groups) {
    const bool outer = groups.size() == 1;
    if (outer && name.text == "CoordType") header_.coordinates = next("a type").text;
    if (groups.size() == 2 && groups[1] == "Units" && name.text == "Coordinates")
      header_.unit = next("a unit").text;
    if (!outer || name.text != "BoundingBox") return;
    std::array<double, 6> bounds{};
    for (double& value : bounds) {
      const AmiraToken& token = next("a number");
      const auto number = parse_real(token.text);
      if (!number)
        fail(token.line,
             fmt::format("BoundingBox: expected six numbers, found '{}'", shown(token.text)));
      value = *number;
    }
    header_.bounds = bounds;
  }

  // Lattice { float[2] Data } @1(HxZip,999)
  void read_array(const AmiraToken& of) {
    ++at_;
    AmiraArray array;
    array.of = of.text;
    const AmiraToken& type = next("a type");
    read_type(type, array.array);
    array.array.selector = next("a name").text;
    if (!next_is("}")) fail(type.line, "expected a type and a name in braces");
    ++at_;
    if (next_is("=")) ++at_;
    const AmiraToken& place = next("@ and a number");
    read_place(place, array);
    header_.arrays.push_back(std::move(array));
  }

  void read_type(const AmiraToken& token, FileArray& array) const {
    const std::size_t bracket = std::min(token.text.find('['), token.text.size());
    const std::string name = token.text.substr(0, bracket);
    array.type_name = shown(token.text);
    for (const auto& [known, type] : amira_types)
      if (name == known) array.type = type;
    if (bracket == token.text.size()) return;
    const auto count = parse_integer(
        std::string_view(token.text).substr(bracket + 1, token.text.size() - bracket - 2));
    if (!count || *count < 1 || *count > 1000 || token.text.back() != ']')
      fail(token.line,
           fmt::format("expected a type such as float[3], found '{}'", shown(token.text)));
    array.components = *count;
    array.type_name = name;
  }

  void read_place(const AmiraToken& token, AmiraArray& array) const {
    const std::string_view text = token.text;
    const std::size_t bracket = std::min(text.find('('), text.size());
    const auto stream = stream_mark(text.substr(0, bracket));
    if (!stream) fail(token.line, fmt::format("expected @ and a number, found '{}'", shown(text)));
    array.stream = *stream;
    if (header_.text) array.encoding = DataEncoding::text;
    if (bracket == text.size()) return;
    const std::size_t comma = std::min(text.find(','), text.size());
    const std::string_view codec = trim(text.substr(bracket + 1, comma - bracket - 1));
    std::optional<std::int64_t> bytes;
    if (comma + 1 < text.size() && text.back() == ')')
      bytes = parse_integer(trim(text.substr(comma + 1, text.size() - comma - 2)));
    if (codec != "HxByteRLE" && codec != "HxZip")
      fail(token.line, fmt::format("compression '{}' is not supported: expected HxByteRLE or HxZip",
                                   shown(codec)));
    if (bytes.value_or(-1) < 0)
      fail(token.line, fmt::format("expected the compressed size in '{}'", shown(text)));
    array.encoding = codec == "HxZip" ? DataEncoding::deflated : DataEncoding::byte_rle;
    array.stored_bytes = static_cast<std::uint64_t>(bytes.value_or(0));
  }

  const ReadFile& file_;
  AmiraHeader header_;
  std::vector<AmiraToken> tokens_;
  std::size_t at_ = 0;
};

// Bytes that an array takes in the file, where that can be told.
std::optional<std::uint64_t> bytes_of(const AmiraHeader& header, const AmiraArray& array) {
  if (array.stored_bytes) return array.stored_bytes;
  const auto sizes = header.sizes.find(array.of);
  if (sizes == header.sizes.end() || !array.array.type) return {};
  std::uint64_t bytes =
      sample_bytes(*array.array.type) * static_cast<std::uint64_t>(array.array.components);
  for (const std::int64_t side : sizes->second) {
    if (side != 0 && bytes > most_stream_bytes / static_cast<std::uint64_t>(side)) return {};
    bytes *= static_cast<std::uint64_t>(side);
  }
  return bytes;
}

}  // namespace

AmiraHeader read_amira_header(const ReadFile& file) {
  return AmiraParser(file).run();
}

std::uint64_t find_amira_stream(const ReadFile& file, const AmiraHeader& header,
                                std::int64_t stream) {
  std::uint64_t from = header.data;
  for (;;) {
    LineReader lines(file, from);
    std::optional<std::int64_t> mark;
    // Of text, lines of numbers stand between; else at most blank ones.
    while (!mark) {
      const auto line = lines.next();
      if (!line)
        throw FormatError(fmt::format("{}: truncated: no line '@{}', where the values begin",
                                      file.path(), stream));
      mark = stream_mark(*line);
      if (!mark && !header.text && !trim(*line).empty())
        throw FormatError(
            fmt::format("{}: byte {}: expected the line of a stream, such as '@1': "
                        "damaged, or wrong sizes before it",
                        file.path(), from));
    }
    if (*mark == stream) return lines.offset();
    from = lines.offset();
    if (header.text) continue;
    const auto array = std::ranges::find(header.arrays, *mark, &AmiraArray::stream);
    const auto bytes = array == header.arrays.end() ? std::nullopt : bytes_of(header, *array);
    if (!bytes || *bytes > file.size() - from)
      throw FormatError(
          fmt::format("{}: byte {}: the length of stream @{}, which comes before @{}, "
                      "is not known or more than the file has",
                      file.path(), from, *mark, stream));
    from += *bytes;
  }
}

}  // namespace voxweld
