// The report of an output directory: a page for people, beside the manifest and in no list of it.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace voxweld {

inline constexpr const char* report_name = "report.html";

// What a report has in its first few hundred bytes and no other page; the key of what it is made
// from comes behind it.
inline constexpr std::string_view report_mark = "<meta name=\"voxweld-report\" content=\"";

// The first bytes of a file, in which a report has its mark and key; fewer or none where it is shorter or
// cannot be read.
std::string beginning_of_page(const std::filesystem::path& path);

// Whether a report that voxweld wrote lies there: a page of the same name may be somebody's own.
bool is_report(const std::filesystem::path& path);

}  // namespace voxweld
