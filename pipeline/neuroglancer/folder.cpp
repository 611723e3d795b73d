#include "pipeline/neuroglancer/folder.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>

#include "storage/support/claim_folder.h"
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

}  // namespace

void claim_folder(const fs::path& folder, const fs::path& output, bool force) {
  claim_folder({folder, output, force, "-o", is_ours, info_name, is_by_voxweld});
}

}  // namespace voxweld
