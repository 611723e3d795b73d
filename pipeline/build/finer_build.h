// Earlier builds in a work folder that a build of a larger tolerance can cut.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

namespace voxweld {

inline constexpr const char* tolerance_note_name = "tolerance";

// What the note says; nothing where it is not there or cannot be read.
std::optional<double> read_tolerance_note(const std::filesystem::path& note);

// Leaves a note in a folder of build of what tolerance its octrees are, where there is none.
void note_tolerance(const std::filesystem::path& build, double tolerance);

// simplify.tolerance of the builds in this work folder that have such a note, descending. Notes that
// cannot be read are passed over: without them samples are read.
std::vector<double> noted_tolerances(const std::filesystem::path& work);

}  // namespace voxweld
