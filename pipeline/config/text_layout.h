// Paragraphs of plain text for help and comments.
#pragma once

#include <string>
#include <string_view>

namespace voxweld {

// The words of `text` in lines of at most `width` columns (longer words stand alone), each begun
// with `prefix` and ended with a newline.
std::string wrapped(std::string_view text, std::string_view prefix, std::size_t width = 100);

}  // namespace voxweld
