#include "pipeline/ingest/recorded_input.h"

#include <set>

#include "pipeline/config/settings.h"
#include "storage/spool/spool_record.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "storage/support/text_fields.h"

namespace voxweld {
namespace {

std::filesystem::path record_name(const std::filesystem::path& folder) {
  return folder / "input";
}

// Of the folders the files lie in: when files come or go, their times change.
Hash128 folders_state(const VolumeInfo& info) {
  std::set<std::filesystem::path> folders;
  for (const InputFile& file : info.files)
    folders.insert(std::filesystem::absolute(file.path).parent_path());
  KeyHasher hash;
  for (const auto& folder : folders) {
    const auto state = file_state(folder);
    hash.text(folder.string()).integer(state ? state->mtime_ns : -1);
  }
  return hash.finish();
}

}  // namespace

Hash128 input_record_key(const Config& config) {
  KeyHasher key;
  key.hash(parameter_hash(config, Stage::ingest)).text(config.input.unit);
  if (config.input.spacing)
    for (int a = 0; a < 3; ++a) key.real((*config.input.spacing)[a]);
  return key.finish();
}

void record_input(const std::filesystem::path& folder, Hash128 key, const VolumeInfo& info) {
  SpoolRecord record;
  record.key = key;
  record.data_hash = folders_state(info);
  record.info = info;
  write_spool_record(record_name(folder), record);
}

std::optional<VolumeInfo> recorded_input(const std::filesystem::path& folder, Hash128 key) {
  if (!std::filesystem::exists(spool_record_path(record_name(folder)))) return std::nullopt;
  try {
    const SpoolRecord record = read_spool_record(record_name(folder));
    if (record.key != key || record.data_hash != folders_state(record.info)) return std::nullopt;
    for (const InputFile& file : record.info.files)
      if (is_url(file.path) || file_state(file.path) != file.state) return std::nullopt;
    return record.info;
  } catch (const DamagedArtifact&) {
    return std::nullopt;
  }
}

}  // namespace voxweld
