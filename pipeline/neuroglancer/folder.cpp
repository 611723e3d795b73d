#include "pipeline/neuroglancer/folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "storage/support/error.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

bool is_number(std::string_view text, std::string_view digits = "0123456789") {
  return !text.empty() && text.find_first_not_of(digits) == text.npos;
}

// "12", "12.index", "0f.shard", "12:0", "12:0:3"
bool is_written_name(std::string_view name) {
  if (name == info_name) return true;
  if (name.ends_with(".shard"))
    return is_number(name.substr(0, name.size() - 6), "0123456789abcdef");
  if (name.ends_with(".index")) return is_number(name.substr(0, name.size() - 6));
  const std::size_t end = name.find(':');
  if (end == name.npos) return is_number(name);
  std::string_view rest = name.substr(end + 1);
  if (!rest.starts_with('0')) return false;
  rest.remove_prefix(1);
  return is_number(name.substr(0, end)) &&
         (rest.empty() || (rest.starts_with(':') && is_number(rest.substr(1))));
}

bool is_ours(const fs::directory_entry& entry) {
  const std::string name = entry.path().filename().string();
  if (entry.is_regular_file() && !entry.is_symlink()) return is_written_name(name);
  if (name != segment_properties_name || entry.is_symlink() || !entry.is_directory()) return false;
  return std::ranges::all_of(fs::directory_iterator(entry.path()), [](const auto& inner) {
    return inner.path().filename() == info_name && inner.is_regular_file();
  });
}

bool is_by_voxweld(const fs::path& info) {
  const auto json = nlohmann::json::parse(read_text_file(info), nullptr, false);
  if (!json.is_object() || !json.contains("generator")) return false;
  const auto& generator = json.at("generator");
  return generator.is_string() && generator.get<std::string>().starts_with("voxweld");
}

[[noreturn]] void refuse(const fs::path& folder, const std::string& why) {
  throw InputError(
      fmt::format("{}: {}; name a new or an empty folder with -o", folder.string(), why));
}

void empty_folder(const fs::path& folder) {
  std::vector<fs::path> old;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (!is_ours(entry))
      refuse(folder,
             fmt::format("has {}, which no export has written", entry.path().filename().string()));
    old.push_back(entry.path());
  }
  // What is left of the folder is no export from here on.
  if (fs::exists(folder / info_name)) {
    if (!is_by_voxweld(folder / info_name))
      refuse(folder, "has an `info` that voxweld has not written");
    remove_file(folder / info_name);
  }
  for (const fs::path& path : old) fs::remove_all(path);
}

bool lies_in(const fs::path& inner, const fs::path& outer) {
  const fs::path a = fs::weakly_canonical(inner), b = fs::weakly_canonical(outer);
  const auto [in_a, in_b] = std::ranges::mismatch(a, b);
  return in_b == b.end() || *in_b == "";
}

}  // namespace

void claim_folder(const fs::path& folder, const fs::path& output, bool force) {
  if (lies_in(folder, output))
    refuse(folder,
           fmt::format("lies in the output directory {}, which runs write", output.string()));
  const fs::file_status status = fs::status(folder);
  if (fs::exists(status) && !fs::is_directory(status)) refuse(folder, "is a file");
  if (fs::exists(status)) remove_stale_temporaries(folder, true);
  if (fs::exists(status) && !fs::is_empty(folder)) {
    if (!force)
      throw InputError(fmt::format(
          "{}: is not empty; use --force to write over an earlier export, or -o for another folder",
          folder.string()));
    empty_folder(folder);
  }
  make_directories(folder);
}

}  // namespace voxweld
