// The folder that an export writes.
#pragma once

#include <filesystem>
#include <string>

namespace voxweld {

inline constexpr const char* info_name = "info";
inline constexpr const char* segment_properties_name = "segment_properties";

// Makes the folder, or empties it where `force` says so and an earlier export has written all that is in
// it. InputError where there is something else, or where it lies in the output directory, which belongs to
// runs.
void claim_folder(const std::filesystem::path& folder, const std::filesystem::path& output,
                  bool force);

}  // namespace voxweld
