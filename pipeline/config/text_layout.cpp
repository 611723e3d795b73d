#include "pipeline/config/text_layout.h"

namespace voxweld {

std::string wrapped(std::string_view text, std::string_view prefix, std::size_t width) {
  std::string out;
  std::string line(prefix);
  while (true) {
    const auto begin = text.find_first_not_of(' ');
    if (begin == std::string_view::npos) break;
    text.remove_prefix(begin);
    const std::string_view word = text.substr(0, text.find(' '));
    text.remove_prefix(word.size());
    const bool first = line.size() == prefix.size();
    if (!first && line.size() + 1 + word.size() > width) {
      out += line + "\n";
      line = prefix;
    } else if (!first) {
      line += ' ';
    }
    line += word;
  }
  return out + line + "\n";
}

}  // namespace voxweld
