// Characters of a scalable font as outlines.
#pragma once

#include <filesystem>

#include "tests/paper/extrusion.h"

namespace voxweld::paper {

// The character's outline, an em `size` units wide, centred on its own bounding box; curves are cut
// into chords of eight a curve. InputError where there is no such font or character, or where this
// program was built without FreeType.
Outline glyph_outline(const std::filesystem::path& font, char32_t character, double size);

}  // namespace voxweld::paper
