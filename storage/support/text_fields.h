// Reading the text headers of NRRD and MetaImage: lines with their numbers, words, checked numbers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/support/file_io.h"
#include "storage/types/box.h"

namespace voxweld {

std::string_view trim(std::string_view text);
std::string lower(std::string_view text);
bool is_url(std::string_view path);                           // "http://..." and "https://..."
std::vector<std::string> split_words(std::string_view text);  // at spaces and tabs
// In lower case with its dot; of "a.nii.gz" it is ".nii.gz".
std::string name_extension(const std::filesystem::path& path);

// The whole text as a number; empty when it is not one (or does not fit).
std::optional<std::int64_t> parse_integer(std::string_view text);
std::optional<double> parse_real(std::string_view text);  // takes nan and inf

// Lines of a file from an offset on, without their line ends ("\n" or "\r\n"). The file must
// outlive the reader.
class LineReader {
 public:
  explicit LineReader(const ReadFile& file, std::uint64_t offset = 0);

  // The next line; empty at the end of the file. FormatError for a line over 1 MiB: not text.
  std::optional<std::string> next();
  int line_number() const { return line_number_; }  // of the line next() gave last, from 1
  std::uint64_t offset() const { return offset_; }  // of the byte after that line

 private:
  bool refill();

  const ReadFile& file_;
  std::vector<std::byte> buffer_;
  std::size_t at_ = 0;
  std::uint64_t buffer_end_;  // file offset of the end of buffer_
  std::uint64_t offset_;
  int line_number_ = 0;
};

// One "key: value" of a header and where it stands.
struct HeaderField {
  std::string key;
  std::string value;
  int line = 0;
};

// The fields of one header and the messages about them: "<path>:<line>: field '<key>': ...".
class HeaderFields {
 public:
  explicit HeaderFields(std::string path) : path_(std::move(path)) {}

  const std::string& path() const { return path_; }
  // FormatError when the key was there already, or for more fields than any header has.
  void add(HeaderField field);
  const HeaderField* find(std::string_view key) const;
  // The first of `keys` that is present.
  const HeaderField* find_any(std::initializer_list<std::string_view> keys) const;
  // FormatError when missing.
  const HeaderField& require(std::string_view key) const;

  std::string where(const HeaderField& field) const;
  // FormatError "<where>: expected <expected>, found '<value>'".
  [[noreturn]] void reject(const HeaderField& field, std::string_view expected) const;
  // FormatError "<where>: <what>".
  [[noreturn]] void fail(const HeaderField& field, std::string_view what) const;

  std::int64_t integer(const HeaderField& field) const;
  bool boolean(const HeaderField& field) const;  // true/false, t/f, 1/0, any case
  // Exactly `count` numbers separated by blanks; `what` names them in the message.
  std::vector<std::int64_t> integers(const HeaderField& field, std::size_t count) const;
  std::vector<double> reals(const HeaderField& field, std::size_t count) const;

 private:
  std::string path_;
  std::vector<HeaderField> fields_;
};

constexpr std::int64_t max_files = std::int64_t{1} << 24;  // that hold one volume

// How many files share samples of these sizes when each holds the `within` fastest axes: one for
// each entry of the others. FormatError (through `fields`) for more than max_files.
std::int64_t expected_files(const std::vector<std::int64_t>& sizes, std::int64_t within,
                            const HeaderFields& fields, const HeaderField& field);

// The names of numbered files: a printf-like pattern with one %d (flags: 0 and a width only).
struct FilePattern {
  std::string pattern;
  std::int64_t first = 0, last = 0, step = 1;
};
// FormatError (through `fields`) for a bad pattern, a zero step, or another count than `expected`.
std::vector<std::string> expand_pattern(const FilePattern& pattern, std::int64_t expected,
                                        const HeaderFields& fields, const HeaderField& field);

}  // namespace voxweld
