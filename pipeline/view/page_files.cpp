#include "pipeline/view/page_files.h"

#include "storage/support/error.h"

namespace voxweld {

void require_page() {
  if (!page_files().empty()) return;
  throw InputError(
      "this build of voxweld has no viewer: Node.js's npm, or what it installs, was missing when "
      "it "
      "was built. Install npm and build again with -DVOXWELD_VIEWER=ON; `voxweld render` draws "
      "pictures without it");
}

std::string_view content_type(std::string_view name) {
  struct Type {
    std::string_view ending, type;
  };
  static constexpr Type types[] = {
      {".html", "text/html; charset=utf-8"},
      {".css", "text/css; charset=utf-8"},
      {".js", "text/javascript; charset=utf-8"},
      {".wasm", "application/wasm"},
      {".svg", "image/svg+xml"},
      {".png", "image/png"},
      {".json", "application/json"},
      {".jsonl", "application/x-ndjson"},
      {".txt", "text/plain; charset=utf-8"},
      {".glb", "model/gltf-binary"},
      {".gltf", "model/gltf+json"},
      {".stl", "model/stl"},
      {".obj", "model/obj"},
  };
  for (const auto& [ending, type] : types)
    if (name.ends_with(ending)) return type;
  return "application/octet-stream";
}

}  // namespace voxweld
