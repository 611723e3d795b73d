// Label maps as lines of a label, a name and its colour: what 3D Slicer, FreeSurfer and ITK-SNAP
// keep theirs in.
#include <fmt/format.h>

#include <algorithm>

#include "storage/labels/label_map_rows.h"
#include "storage/support/text_fields.h"

namespace voxweld {
namespace {

struct Word {
  std::string_view text;
  bool quoted = false;
};

void split(std::string_view line, std::vector<Word>& words) {
  words.clear();
  for (std::size_t at = 0; at < line.size();) {
    if (line[at] == ' ' || line[at] == '\t') {
      ++at;
      continue;
    }
    const bool quoted = line[at] == '"';
    const std::size_t begin = at + (quoted ? 1 : 0);
    const std::size_t end =
        std::min(quoted ? line.find('"', begin) : line.find_first_of(" \t", begin), line.size());
    words.push_back({line.substr(begin, end - begin), quoted});
    at = end + (quoted ? 1 : 0);
  }
}

bool is_number(const Word& word) {
  return !word.quoted && !word.text.empty() &&
         word.text.find_first_not_of("0123456789.") == std::string_view::npos;
}

// "5  255 128 0  1 1 1  "Name"": ITK-SNAP. Else "5 Name 255 128 0 255", where the name may be of
// several words and the last number may be missing.
bool is_description(const std::vector<Word>& words) {
  return words.size() == 8 && words.back().quoted &&
         std::all_of(words.begin(), words.end() - 1, is_number);
}

std::size_t numbers_at_end(const std::vector<Word>& words) {
  std::size_t count = 0;
  while (count < 4 && count + 1 < words.size() && is_number(words[words.size() - 1 - count]))
    ++count;
  return count;
}

}  // namespace

void parse_color_table(std::string_view text, LabelMapRows& rows) {
  std::vector<Word> words;
  std::size_t at = 0;
  std::uint64_t number = 0;
  for (std::string_view line; next_line(text, at, line);) {
    ++number;
    line = trim(line);
    if (line.empty() || line.front() == '#') continue;
    split(line, words);
    LabelMapRow row;
    row.line = number;
    row.labels = rows.labels(words.front().text, number);
    std::size_t red = 1;
    if (is_description(words)) {
      row.name = words.back().text;
    } else {
      const std::size_t numbers = numbers_at_end(words);
      if (numbers < 3)
        rows.fail(number, fmt::format("expected label, name, red, green and blue (as 3D Slicer "
                                      "writes them) or the eight columns of ITK-SNAP, found '{}'",
                                      shown_cell(line)));
      red = words.size() - numbers;
      for (std::size_t i = 1; i < red; ++i)
        row.name.append(i == 1 ? "" : " ").append(words[i].text);
    }
    row.color = {rows.shade(words[red].text, number), rows.shade(words[red + 1].text, number),
                 rows.shade(words[red + 2].text, number)};
    rows.add(std::move(row));
  }
}

}  // namespace voxweld
