#include "pipeline/output/origin.h"

#include <nlohmann/json.hpp>

#include "pipeline/config/config.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

using nlohmann::json;

void check_file(const json& file, std::vector<Problem>& problems) {
  const std::string path = file.at("path");
  const auto state = file_state(path);
  if (!state) return;
  if (state->size == file.at("bytes").get<std::uint64_t>() &&
      state->mtime_ns == file.at("modified_ns").get<std::int64_t>())
    return;
  problems.push_back(
      {path, "has changed since the meshes were made of it; make them again with `voxweld run`"});
}

// Whether the file asks for the same as it did.
bool same_result(const std::string& path, const std::string& result) {
  try {
    return to_hex(result_hash(load_config(path))) == result;
  } catch (const Error&) {
    return false;
  }
}

void check_config(const json& config, std::vector<Problem>& problems) {
  const std::string path = config.value("path", ""), result = config.value("result", "");
  if (path.empty() || result.empty() || !file_state(path) || same_result(path, result)) return;
  problems.push_back(
      {path,
       "asks for another result than when the meshes were made; make them again with "
       "`voxweld run`"});
}

}  // namespace

std::vector<Problem> check_origin(const Manifest& manifest) {
  std::vector<Problem> problems;
  try {
    if (manifest.input != nullptr)
      for (const json& file : manifest.input->value("files", json::array()))
        check_file(file, problems);
    if (manifest.config != nullptr) check_config(*manifest.config, problems);
  } catch (const json::exception&) {
    problems.push_back({manifest_name, "its input or config is not as a run writes it"});
  }
  return problems;
}

}  // namespace voxweld
