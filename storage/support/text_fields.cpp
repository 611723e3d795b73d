#include "storage/support/text_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr std::size_t block_bytes = std::size_t{1} << 14;
constexpr std::size_t max_line_bytes = std::size_t{1} << 20;
constexpr std::size_t max_fields = 10'000;

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f';
}

template <class T>
std::optional<T> parse_whole(std::string_view text) {
  if (text.size() > 1 && text.front() == '+' && text[1] != '-') text.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || text.empty()) return {};
  return value;
}

// Quoted values in messages stay one short line whatever the file holds.
std::string shown(std::string_view value) {
  std::string text;
  for (const char c : value.substr(0, 80))
    text += std::isprint(static_cast<unsigned char>(c)) != 0 ? c : '?';
  return value.size() > 80 ? text + "..." : text;
}

}  // namespace

std::string_view trim(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

bool is_url(std::string_view path) {
  constexpr std::size_t longest = 8;
  const std::string begin = lower(path.substr(0, std::min(path.size(), longest)));
  return begin.starts_with("http://") || begin.starts_with("https://");
}

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

std::vector<std::string> split_words(std::string_view text) {
  std::vector<std::string> words;
  for (std::size_t at = 0; at < text.size();) {
    if (is_blank(text[at])) {
      ++at;
      continue;
    }
    std::size_t end = at;
    while (end < text.size() && !is_blank(text[end])) ++end;
    words.emplace_back(text.substr(at, end - at));
    at = end;
  }
  return words;
}

std::string name_extension(const std::filesystem::path& path) {
  const std::string last = lower(path.extension().string());
  return last == ".gz" ? lower(path.stem().extension().string()) + last : last;
}

std::optional<std::int64_t> parse_integer(std::string_view text) {
  return parse_whole<std::int64_t>(text);
}

std::optional<double> parse_real(std::string_view text) {
  return parse_whole<double>(text);
}

LineReader::LineReader(const ReadFile& file, std::uint64_t offset)
    : file_(file), buffer_end_(offset), offset_(offset) {}

bool LineReader::refill() {
  if (buffer_end_ >= file_.size()) return false;
  buffer_.resize(
      static_cast<std::size_t>(std::min<std::uint64_t>(block_bytes, file_.size() - buffer_end_)));
  file_.read(buffer_end_, buffer_);
  buffer_end_ += buffer_.size();
  at_ = 0;
  return true;
}

std::optional<std::string> LineReader::next() {
  std::string line;
  bool any = false;
  while (at_ < buffer_.size() || refill()) {
    any = true;
    const auto begin = buffer_.begin() + static_cast<std::ptrdiff_t>(at_);
    const auto end = std::find(begin, buffer_.end(), std::byte{'\n'});
    const auto* text = reinterpret_cast<const char*>(buffer_.data() + at_);
    const auto length = static_cast<std::size_t>(end - begin);
    line.append(text, length);
    at_ += length;
    offset_ += length;
    if (line.size() > max_line_bytes)
      throw FormatError(
          fmt::format("{}:{}: a line of more than {} bytes where a text header was expected: the "
                      "file is damaged or not what its name says",
                      file_.path(), line_number_ + 1, max_line_bytes));
    if (end != buffer_.end()) {
      ++at_;
      ++offset_;
      break;
    }
  }
  if (!any) return {};
  ++line_number_;
  if (!line.empty() && line.back() == '\r') line.pop_back();
  return line;
}

void HeaderFields::add(HeaderField field) {
  if (const HeaderField* earlier = find(field.key))
    fail(field, fmt::format("given twice, first in line {}: keep one", earlier->line));
  if (fields_.size() == max_fields)
    fail(field, fmt::format("more than {} fields: not a header of a volume", max_fields));
  fields_.push_back(std::move(field));
}

const HeaderField* HeaderFields::find(std::string_view key) const {
  const auto found = std::ranges::find(fields_, key, &HeaderField::key);
  return found == fields_.end() ? nullptr : &*found;
}

const HeaderField* HeaderFields::find_any(std::initializer_list<std::string_view> keys) const {
  for (const std::string_view key : keys)
    if (const HeaderField* field = find(key)) return field;
  return nullptr;
}

const HeaderField& HeaderFields::require(std::string_view key) const {
  if (const HeaderField* field = find(key)) return *field;
  throw FormatError(
      fmt::format("{}: the header has no field '{}', which a volume needs: add it", path_, key));
}

std::string HeaderFields::where(const HeaderField& field) const {
  return fmt::format("{}:{}: field '{}'", path_, field.line, field.key);
}

void HeaderFields::reject(const HeaderField& field, std::string_view expected) const {
  throw FormatError(
      fmt::format("{}: expected {}, found '{}'", where(field), expected, shown(field.value)));
}

void HeaderFields::fail(const HeaderField& field, std::string_view what) const {
  throw FormatError(fmt::format("{}: {}", where(field), what));
}

std::int64_t HeaderFields::integer(const HeaderField& field) const {
  const auto value = parse_integer(trim(field.value));
  if (!value) reject(field, "a whole number");
  return *value;
}

bool HeaderFields::boolean(const HeaderField& field) const {
  const std::string value = lower(trim(field.value));
  if (value == "true" || value == "t" || value == "1" || value == "yes") return true;
  if (value == "false" || value == "f" || value == "0" || value == "no") return false;
  reject(field, "True or False");
}

std::vector<std::int64_t> HeaderFields::integers(const HeaderField& field,
                                                 std::size_t count) const {
  std::vector<std::int64_t> values;
  for (const std::string& word : split_words(field.value)) {
    const auto value = parse_integer(word);
    if (!value) reject(field, fmt::format("{} whole numbers", count));
    values.push_back(*value);
  }
  if (values.size() != count) reject(field, fmt::format("{} whole numbers", count));
  return values;
}

std::vector<double> HeaderFields::reals(const HeaderField& field, std::size_t count) const {
  std::vector<double> values;
  for (const std::string& word : split_words(field.value)) {
    const auto value = parse_real(word);
    if (!value) reject(field, fmt::format("{} numbers", count));
    values.push_back(*value);
  }
  if (values.size() != count) reject(field, fmt::format("{} numbers", count));
  return values;
}

std::int64_t expected_files(const std::vector<std::int64_t>& sizes, std::int64_t within,
                            const HeaderFields& fields, const HeaderField& field) {
  if (within < 1 || within >= std::ssize(sizes))
    fields.fail(field,
                fmt::format("{} dimensions a file: expected 1 to {}", within, sizes.size() - 1));
  std::int64_t files = 1;
  for (auto a = static_cast<std::size_t>(within); a < sizes.size(); ++a) {
    if (files > max_files / sizes[a])
      fields.fail(field, fmt::format("the sizes need more than {} files", max_files));
    files *= sizes[a];
  }
  return files;
}

std::vector<std::string> expand_pattern(const FilePattern& pattern, std::int64_t expected,
                                        const HeaderFields& fields, const HeaderField& field) {
  const std::string& text = pattern.pattern;
  const std::size_t percent = text.find('%');
  std::size_t at = percent == std::string::npos ? text.size() : percent + 1;
  const bool zeros = at < text.size() && text[at] == '0';
  std::size_t width = 0;
  while (at < text.size() && text[at] >= '0' && text[at] <= '9' && width < 100)
    width = width * 10 + static_cast<std::size_t>(text[at++] - '0');
  const bool number = at < text.size() && (text[at] == 'd' || text[at] == 'i' || text[at] == 'u');
  if (!number || width >= 100 || text.find('%', at) != std::string::npos)
    fields.reject(field,
                  "a file name with one %d (or %03d and the like) and the numbers first, "
                  "last and step");
  if (pattern.step == 0) fields.fail(field, "the step from file to file must not be 0");
  // In double: the distance of two int64 may overflow, and only small counts are accepted.
  const double span = static_cast<double>(pattern.last) - static_cast<double>(pattern.first);
  const double count = std::floor(span / static_cast<double>(pattern.step)) + 1;
  if (count != static_cast<double>(expected))
    fields.fail(field, fmt::format("names {} files where the sizes need {}",
                                   count < 1 ? 0.0 : count, expected));
  std::vector<std::string> names;
  for (std::int64_t i = 0; i < expected; ++i) {
    const std::int64_t number_here = pattern.first + i * pattern.step;
    names.push_back(text.substr(0, percent) +
                    (zeros ? fmt::format("{:0{}}", number_here, width)
                           : fmt::format("{:{}}", number_here, width)) +
                    text.substr(at + 1));
  }
  return names;
}

}  // namespace voxweld
