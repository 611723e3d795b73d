#include "storage/support/claim_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "storage/support/error.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const FolderClaim& claim, const std::string& why) {
  throw InputError(fmt::format("{}: {}; name a new or an empty folder with {}",
                               claim.folder.string(), why, claim.option));
}

// What is in it, if all of it may be an export's.
std::vector<fs::path> earlier_export(const FolderClaim& claim) {
  std::vector<fs::path> old;
  for (const auto& entry : fs::directory_iterator(claim.folder)) {
    if (!claim.is_ours(entry))
      refuse(claim,
             fmt::format("has {}, which no export has written", entry.path().filename().string()));
    old.push_back(entry.path());
  }
  const fs::path mark = claim.folder / claim.mark;
  if (fs::exists(mark) && !claim.is_our_mark(mark))
    refuse(claim, fmt::format("has a file `{}` that voxweld has not written", claim.mark));
  return old;
}

void empty_folder(const FolderClaim& claim) {
  const std::vector<fs::path> old = earlier_export(claim);
  if (old.empty()) return;
  if (!claim.force)
    throw InputError(fmt::format(
        "{}: is not empty; use --force to write over an earlier export, or {} for another folder",
        claim.folder.string(), claim.option));
  // What is left of the folder is no export from here on.
  remove_file(claim.folder / claim.mark);
  for (const fs::path& path : old) fs::remove_all(path);
}

bool lies_in(const fs::path& inner, const fs::path& outer) {
  const fs::path a = fs::weakly_canonical(inner), b = fs::weakly_canonical(outer);
  const auto [in_a, in_b] = std::ranges::mismatch(a, b);
  return in_b == b.end() || *in_b == "";
}

}  // namespace

void claim_folder(const FolderClaim& claim) {
  const fs::path& folder = claim.folder;
  if (folder.empty())
    throw InputError(fmt::format("{}: expected a folder, found an empty name", claim.option));
  if (lies_in(folder, claim.output))
    refuse(claim,
           fmt::format("lies in the output directory {}, which runs write", claim.output.string()));
  const fs::file_status status = fs::status(folder);
  if (fs::exists(status) && !fs::is_directory(status)) refuse(claim, "is a file");
  if (fs::exists(status)) {
    remove_stale_temporaries(folder, true);
    empty_folder(claim);
  }
  make_directories(folder);
}

}  // namespace voxweld
