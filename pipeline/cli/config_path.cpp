#include "pipeline/cli/config_path.h"

#include "storage/support/error.h"
#include "storage/support/text_fields.h"

namespace voxweld {

namespace fs = std::filesystem;

std::string path_for_config(const std::string& input, const fs::path& config) {
  if (is_url(input)) return input;
  const fs::path full = fs::absolute(input).lexically_normal();
  const fs::path folder = fs::absolute(config).lexically_normal().parent_path();
  const fs::path relative = full.lexically_relative(folder);
  const bool below = !relative.empty() && *relative.begin() != ".." && relative != ".";
  std::string text = (below ? relative : full).string();
  for (const char c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
      throw InputError(input + ": a config cannot hold a path with control characters; rename it");
  return text;
}

}  // namespace voxweld
