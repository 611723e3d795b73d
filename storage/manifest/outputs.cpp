// Which folders are outputs of a run.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "storage/manifest/manifest.h"
#include "storage/support/error.h"

namespace voxweld {

namespace fs = std::filesystem;

std::vector<std::string> outputs_within(const fs::path& directory) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(directory, error), end; !error && entry != end;
       entry.increment(error))
    if (fs::exists(entry->path() / manifest_name, error))
      names.push_back(entry->path().filename().string());
  std::ranges::sort(names);
  return names;
}

void require_output(const fs::path& directory) {
  constexpr std::size_t most_named = 10;
  if (fs::exists(directory / manifest_name)) return;
  if (!fs::exists(directory))
    throw InputError(directory.string() +
                     ": no such folder; name the output.directory of a finished run");
  std::vector<std::string> names = outputs_within(directory);
  const std::string problem =
      fmt::format("{}: not an output directory: it has no {}", directory.string(), manifest_name);
  if (names.empty()) throw InputError(problem + "; name the output.directory of a finished run");
  const bool more = names.size() > most_named;
  if (more) names.resize(most_named);
  throw InputError(fmt::format("{}; outputs in it: {}{}; name one of them", problem,
                               fmt::join(names, ", "), more ? ", ..." : ""));
}

}  // namespace voxweld
