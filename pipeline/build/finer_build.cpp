#include "pipeline/build/finer_build.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "pipeline/stage/file_layout.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "storage/support/text_fields.h"

namespace voxweld {

std::optional<double> read_tolerance_note(const std::filesystem::path& note) {
  std::error_code missing;
  if (!std::filesystem::exists(note, missing)) return std::nullopt;
  try {
    const auto tolerance = parse_real(trim(read_text_file(note)));
    return tolerance >= 0 ? tolerance : std::nullopt;  // no NaN
  } catch (const Error&) {
    return std::nullopt;
  }
}

void note_tolerance(const std::filesystem::path& build, double tolerance) {
  if (read_tolerance_note(build / tolerance_note_name) == tolerance) return;
  make_directories(build);
  // The shortest digits that are read back as the same number.
  write_whole_file(build / tolerance_note_name, as_bytes(fmt::format("{}\n", tolerance)),
                   Durability::rename_only);
}

std::vector<double> noted_tolerances(const std::filesystem::path& work) {
  std::vector<double> tolerances;
  std::error_code missing;
  for (const auto& entry : std::filesystem::directory_iterator(work, missing))
    if (stage_of_folder(entry.path()) == Stage::build)
      if (const auto noted = read_tolerance_note(entry.path() / tolerance_note_name))
        tolerances.push_back(*noted);
  std::sort(tolerances.begin(), tolerances.end(), std::greater<>());
  tolerances.erase(std::unique(tolerances.begin(), tolerances.end()), tolerances.end());
  return tolerances;
}

}  // namespace voxweld
