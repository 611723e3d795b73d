#include "pipeline/cli/output_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <system_error>

#include "pipeline/cli/commands.h"
#include "storage/support/error.h"
#include "storage/support/text_fields.h"

namespace voxweld {

namespace fs = std::filesystem;

void add_output_file(CLI::App& command, OutputFile& output, const std::string& help) {
  add_file(command, "-o,--output", output.path, help);
  command.add_flag("--force", output.force, "Writes over a file that is there");
}

void check_free(const fs::path& file, bool force) {
  std::error_code error;
  if (!fs::exists(fs::symlink_status(file, error))) return;
  const fs::file_status status = fs::status(file, error);
  if (fs::is_directory(status))
    throw InputError(file.string() + ": is a directory; name the file to write");
  // A rename would put a file in the place of a device.
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw InputError(file.string() + ": is a device or a pipe; name the file to write");
  if (!force)
    throw InputError(file.string() +
                     ": exists already; use --force to write over it, or -o for another name");
}

void refuse_input(const fs::path& file, const fs::path& input) {
  std::error_code error;
  if (!fs::equivalent(file, input, error) || error) return;
  throw InputError(fmt::format(
      "{}: is the input itself{}, and that is never written over; use -o for another name",
      file.string(), file == input ? "" : fmt::format(" ({})", input.string())));
}

void check_ending(const fs::path& file, std::span<const std::string> endings,
                  const std::string& what) {
  const std::string ending = lower(file.extension().string());
  if (std::ranges::find(endings, ending) != endings.end()) return;
  throw InputError(fmt::format("{}: {} is written as {}; give it such a name", file.string(), what,
                               fmt::join(endings, ", ")));
}

}  // namespace voxweld
