// What OpenImageIO lets pass although samples are missing or changed.
#pragma once

#include <string>

namespace voxweld {

// Why an image of this format ("jpeg", "pnm" ...) must not be read; empty when nothing is wrong.
std::string format_objection(const std::string& format, const std::string& path);

struct PngFacts {
  int bits = 8;  // of one stored sample
  bool palette = false;
};
// OpenImageIO expands small depths and palettes of PNG files without saying so.
PngFacts png_facts(const std::string& path);

}  // namespace voxweld
