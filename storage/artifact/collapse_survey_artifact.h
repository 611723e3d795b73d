// What survey and recount leave of a range of cubes, or of some small labels. Kind "srvy", a container
// with these sections:
//   1 u64 x 4: triangles inside cubes, others, of these what the other pass cannot change either,
//     vertices at the borders
//   2 how many are left of the first for each tolerance, u64
#pragma once

#include <array>
#include <filesystem>

#include "storage/support/hash.h"
#include "storage/types/collapse_survey.h"

namespace voxweld {

inline constexpr std::array<char, 4> collapse_survey_kind = {'s', 'r', 'v', 'y'};
inline constexpr std::uint32_t collapse_survey_version = 1;

struct CollapseSurveyArtifact {
  Hash128 key, content;
  CollapseSurvey survey;
};

void write_collapse_survey(const std::filesystem::path& path, Hash128 key,
                           const CollapseSurvey& survey);
// DamagedArtifact when it fails its checks, StorageError when it cannot be read.
CollapseSurveyArtifact read_collapse_survey(const std::filesystem::path& path);

}  // namespace voxweld
