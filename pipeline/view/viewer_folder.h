// The viewer's page and an output as plain files, which any web server can hand out.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace voxweld {

struct ViewerFolderOptions {
  bool force = false;                     // over an earlier one
  std::function<void()> between = [] {};  // called before each file; may throw
};

struct ViewerFolderTotals {
  std::uint64_t files = 0, bytes = 0;
};

// shown: an output directory or a mesh file. The folder gets the page, `api/scene` and, under `data/`,
// the files that the page asks for: of a tileset those of its format, else the tiles in the format that
// takes least, or the whole mesh where there are no tiles. The report is left out, since it names paths.
// InputError where this build has no page, where there is nothing to show, where files are not as the
// output's lists have them (a run may be writing it), and as claim_folder has it. `api/scene` comes last.
ViewerFolderTotals write_viewer_folder(const std::filesystem::path& shown,
                                       const std::filesystem::path& folder,
                                       const ViewerFolderOptions& options);

// The name of the run or file that such a folder shows; nothing where it is none, or not whole.
std::optional<std::string> shown_in_viewer_folder(const std::filesystem::path& folder);

}  // namespace voxweld
