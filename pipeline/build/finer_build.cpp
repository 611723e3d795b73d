#include "pipeline/build/finer_build.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <functional>
#include <string>

#include "pipeline/stage/file_layout.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

}  // namespace

std::optional<double> read_tolerance_note(const fs::path& note) {
  std::error_code missing;
  if (!fs::exists(note, missing)) return std::nullopt;
  try {
    const std::string text = read_text_file(note);
    double tolerance = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), tolerance);
    if (error != std::errc{} || end == text.data()) return std::nullopt;
    return tolerance;
  } catch (const Error&) {
    return std::nullopt;
  }
}

void note_tolerance(const fs::path& build, double tolerance) {
  if (read_tolerance_note(build / tolerance_note_name) == tolerance) return;
  make_directories(build);
  // The shortest digits that are read back as the same number.
  write_whole_file(build / tolerance_note_name, as_bytes(fmt::format("{}\n", tolerance)),
                   Durability::rename_only);
}

std::vector<double> noted_tolerances(const fs::path& work) {
  std::vector<double> tolerances;
  std::error_code missing;
  for (const auto& entry : fs::directory_iterator(work, missing))
    if (stage_of_folder(entry.path()) == Stage::build)
      if (const auto noted = read_tolerance_note(entry.path() / tolerance_note_name))
        tolerances.push_back(*noted);
  std::sort(tolerances.begin(), tolerances.end(), std::greater<>());
  tolerances.erase(std::unique(tolerances.begin(), tolerances.end()), tolerances.end());
  return tolerances;
}

}  // namespace voxweld
