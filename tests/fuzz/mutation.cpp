#include "tests/fuzz/mutation.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>

#include "tests/support/deflated.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;

// A place in a file: every second one near its beginning, where headers are.
std::size_t place(Random& random, std::size_t size) {
  if (size == 0) return 0;
  return pick(random, pick(random, 2) == 0 ? std::min<std::size_t>(size, 512) : size);
}

std::string turn_bits(std::string& bytes, Random& random) {
  const std::size_t count = 1 + pick(random, 8);
  for (std::size_t i = 0; i < count && !bytes.empty(); ++i) {
    char& byte = bytes[place(random, bytes.size())];
    byte = static_cast<char>(byte ^ (1 << pick(random, 8)));
  }
  return fmt::format("{} bits turned", count);
}

std::string overwrite_run(std::string& bytes, Random& random) {
  const std::size_t at = place(random, bytes.size());
  const std::size_t count = std::min(bytes.size() - at, 1 + pick(random, 64));
  const std::size_t with = pick(random, 4);
  for (std::size_t i = 0; i < count; ++i)
    bytes[at + i] = static_cast<char>(with == 0   ? 0
                                      : with == 1 ? 255
                                      : with == 2 ? ' '
                                                  : static_cast<int>(pick(random, 256)));
  return fmt::format("{} bytes written over at {}", count, at);
}

std::string cut_short(std::string& bytes, Random& random) {
  bytes.resize(place(random, bytes.size()));
  return fmt::format("cut short to {}", bytes.size());
}

std::string lengthen(std::string& bytes, Random& random) {
  const std::size_t count = 1 + pick(random, 5000);
  const bool own = pick(random, 2) == 0 && !bytes.empty();
  for (std::size_t i = 0; i < count; ++i)
    bytes.push_back(own ? bytes[i] : static_cast<char>(pick(random, 256)));
  return fmt::format("{} bytes longer", count);
}

std::string splice(std::string& bytes, const std::string& other, Random& random) {
  const std::size_t at = place(random, bytes.size()), from = place(random, other.size());
  bytes = bytes.substr(0, at) + other.substr(from);
  return fmt::format("from {} on another file's bytes", at);
}

std::string take_out(std::string& bytes, Random& random) {
  const std::size_t at = place(random, bytes.size()), count = 1 + pick(random, 64);
  bytes.erase(at, count);
  return fmt::format("{} bytes taken out at {}", count, at);
}

std::string put_twice(std::string& bytes, Random& random) {
  const std::size_t at = place(random, bytes.size()), count = 1 + pick(random, 64);
  bytes.insert(at, bytes.substr(at, count));
  return fmt::format("{} bytes twice at {}", count, at);
}

// Numbers that programs trip over.
const std::vector<std::string> extreme_texts = {"0",
                                                "-1",
                                                "1",
                                                "2",
                                                "255",
                                                "65536",
                                                "524287",
                                                "2147483647",
                                                "2147483648",
                                                "4294967296",
                                                "9223372036854775807",
                                                "9223372036854775808",
                                                "18446744073709551615",
                                                "99999999999999999999999",
                                                "-9223372036854775808",
                                                "1e308",
                                                "-1e308",
                                                "1e999",
                                                "1e-320",
                                                "nan",
                                                "inf",
                                                "0.5",
                                                "1e38",
                                                "",
                                                "x",
                                                "true",
                                                "null",
                                                "[]",
                                                "\"\"",
                                                "0x10",
                                                "+7"};

bool is_number_part(char c) {
  return (c >= '0' && c <= '9') || c == '.' || c == '-';
}

std::string replace_number(std::string& bytes, Random& random) {
  // Runs of digits in what may be a header, as (begin, end).
  std::vector<std::pair<std::size_t, std::size_t>> numbers;
  const std::size_t size = std::min<std::size_t>(bytes.size(), 16384);
  for (std::size_t at = 0; at < size;) {
    std::size_t end = at;
    while (end < size && is_number_part(bytes[end])) ++end;
    if (end > at) numbers.emplace_back(at, end);
    at = end + 1;
  }
  if (numbers.empty()) return turn_bits(bytes, random);
  const auto [begin, end] = pick_from(random, numbers);
  const std::string& text = pick_from(random, extreme_texts);
  std::string what = fmt::format("{} at {} becomes {}", bytes.substr(begin, end - begin), begin,
                                 text.empty() ? "nothing" : text);
  bytes.replace(begin, end - begin, text);
  return what;
}

template <class T>
std::string value_bytes(T value, bool swapped) {
  std::string out(sizeof value, '\0');
  std::memcpy(out.data(), &value, sizeof value);
  if (swapped) std::reverse(out.begin(), out.end());
  return out;
}

std::string write_number(std::string& bytes, Random& random) {
  static const std::vector<std::int64_t> integers = {0,
                                                     -1,
                                                     1,
                                                     2,
                                                     127,
                                                     128,
                                                     255,
                                                     32767,
                                                     32768,
                                                     65535,
                                                     65536,
                                                     524287,
                                                     INT32_MAX,
                                                     std::int64_t{1} << 31,
                                                     std::int64_t{1} << 32,
                                                     INT64_MAX,
                                                     INT64_MIN,
                                                     std::int64_t{1} << 40,
                                                     1000000};
  static const std::vector<double> reals = {0.0,
                                            -1.0,
                                            1e308,
                                            -1e308,
                                            1e38,
                                            1e-320,
                                            std::numeric_limits<double>::infinity(),
                                            std::numeric_limits<double>::quiet_NaN()};
  const std::size_t width = std::size_t{1} << pick(random, 4);
  if (bytes.size() < 2 * width) return turn_bits(bytes, random);
  const std::size_t at = place(random, bytes.size() - width) / width * width;
  const bool swapped = pick(random, 4) == 0;
  std::string with;
  if (width >= 4 && pick(random, 3) == 0) {
    const double value = pick_from(random, reals);
    with =
        width == 8 ? value_bytes(value, swapped) : value_bytes(static_cast<float>(value), swapped);
  } else {
    const std::string whole = value_bytes(pick_from(random, integers), false);
    with = whole.substr(0, width);
    if (swapped) std::reverse(with.begin(), with.end());
  }
  bytes.replace(at, width, with);
  return fmt::format("an extreme number of {} bytes at {}", width, at);
}

std::vector<std::string> lines_of(const std::string& bytes) {
  std::vector<std::string> lines;
  std::size_t at = 0;
  while (at < bytes.size()) {
    const std::size_t end = std::min(bytes.find('\n', at), bytes.size() - 1);
    lines.push_back(bytes.substr(at, end + 1 - at));
    at = end + 1;
  }
  return lines;
}

// Lines lost, doubled or exchanged.
std::string move_lines(std::string& bytes, Random& random) {
  std::vector<std::string> lines = lines_of(bytes);
  if (lines.empty()) return "nothing";
  const std::size_t first = pick(random, std::min<std::size_t>(lines.size(), 40));
  const std::size_t second = pick(random, std::min<std::size_t>(lines.size(), 40));
  const std::size_t how = pick(random, 3);
  const auto at = [&](std::size_t i) { return lines.begin() + static_cast<std::ptrdiff_t>(i); };
  if (how == 0) lines.erase(at(first));
  if (how == 1) lines.insert(at(second), std::string(lines[first]));
  if (how == 2) std::swap(lines[first], lines[second]);
  bytes.clear();
  for (const std::string& line : lines) bytes += line;
  return fmt::format("line {} {}", first + 1,
                     how == 0   ? "is gone"
                     : how == 1 ? "is there twice"
                                : "is exchanged");
}

// One word of a text in the place of another.
std::string swap_words(std::string& bytes, Random& random) {
  std::vector<std::pair<std::size_t, std::size_t>> words;
  const std::size_t size = std::min<std::size_t>(bytes.size(), 16384);
  for (std::size_t at = 0; at < size;) {
    std::size_t end = at;
    while (end < size && std::isalpha(static_cast<unsigned char>(bytes[end])) != 0) ++end;
    if (end > at + 1) words.emplace_back(at, end);
    at = end + 1;
  }
  if (words.size() < 2) return overwrite_run(bytes, random);
  const auto [from, from_end] = pick_from(random, words);
  const auto [to, to_end] = pick_from(random, words);
  const std::string word = bytes.substr(from, from_end - from);
  bytes.replace(to, to_end - to, word);
  return fmt::format("the word at {} becomes {}", to, word);
}

bool looks_like_text(const std::string& bytes) {
  const std::size_t size = std::min<std::size_t>(bytes.size(), 64);
  return std::all_of(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size), [](char c) {
    return c == '\n' || c == '\t' || c == '\r' || (c >= ' ' && c <= '~');
  });
}

std::string inflated(const std::string& bytes) {
  z_stream z{};
  if (inflateInit2(&z, 31) != Z_OK) return {};
  std::string out(std::size_t{1} << 20, '\0'), in = bytes;
  z.next_in = reinterpret_cast<Bytef*>(in.data());
  z.avail_in = static_cast<uInt>(in.size());
  z.next_out = reinterpret_cast<Bytef*>(out.data());
  z.avail_out = static_cast<uInt>(out.size());
  const int status = inflate(&z, Z_FINISH);
  out.resize(z.total_out);
  inflateEnd(&z);
  return status == Z_STREAM_END ? out : std::string();
}

std::string mutate_inside(std::string& bytes, const std::string& other, Random& random) {
  std::string inner = inflated(bytes);
  if (inner.empty()) return mutate_bytes(bytes, other, random);
  const std::string what = mutate_bytes(inner, other, random);
  const auto packed = deflated(std::as_bytes(std::span(inner)), Wrapper::gzip);
  bytes.assign(reinterpret_cast<const char*>(packed.data()), packed.size());
  return "unpacked: " + what;
}

}  // namespace

std::size_t pick(Random& random, std::size_t count) {
  return count == 0 ? 0 : static_cast<std::size_t>(random() % count);
}

std::string bytes_of_file(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void write_bytes(const fs::path& path, const std::string& bytes) {
  std::ofstream out(path, std::ios::binary | std::ios::trunc);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

std::string mutate_bytes(std::string& bytes, const std::string& other, Random& random) {
  const bool text = looks_like_text(bytes);
  switch (pick(random, text ? 16 : 12)) {
    case 0:
      return turn_bits(bytes, random);
    case 1:
      return overwrite_run(bytes, random);
    case 2:
      return cut_short(bytes, random);
    case 3:
      return lengthen(bytes, random);
    case 4:
      return splice(bytes, other, random);
    case 5:
      return take_out(bytes, random);
    case 6:
      return put_twice(bytes, random);
    case 7:
      bytes.clear();
      return "empty";
    case 8:
      return text ? replace_number(bytes, random) : turn_bits(bytes, random);
    case 12:
    case 13:
      return replace_number(bytes, random);
    case 14:
      return move_lines(bytes, random);
    case 15:
      return swap_words(bytes, random);
    default:
      return write_number(bytes, random);
  }
}

namespace {

// What is there is no file of bytes any more.
std::string replace_by_no_file(const fs::path& path, Random& random) {
  fs::remove(path);
  switch (pick(random, 6)) {
    case 0:
      fs::create_directory(path);
      return "a folder in its place";
    case 1:
      fs::create_symlink(path.filename(), path);
      return "a link to itself in its place";
    case 2:
      fs::create_symlink("/dev/null", path);
      return "a link to /dev/null in its place";
    case 3:
      fs::create_symlink("/dev/zero", path);
      return "a link to /dev/zero in its place";
    case 4:
      mkfifo(path.c_str(), 0600);
      return "a FIFO in its place";
    default:
      return "removed";
  }
}

}  // namespace

std::string mutate_file(const fs::path& path, const std::string& other, Random& random) {
  if (pick(random, 12) == 0) return replace_by_no_file(path, random);
  std::string bytes = bytes_of_file(path);
  const bool packed = bytes.size() > 2 && bytes[0] == '\x1f' && bytes[1] == '\x8b';
  std::string what = packed && pick(random, 2) == 0 ? mutate_inside(bytes, other, random)
                                                    : mutate_bytes(bytes, other, random);
  write_bytes(path, bytes);
  return what;
}

}  // namespace voxweld::testing
