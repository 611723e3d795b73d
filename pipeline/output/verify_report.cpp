#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "pipeline/executor/progress.h"
#include "pipeline/output/verify.h"
#include "storage/support/json_text.h"

namespace voxweld {

std::string to_text(const VerifyReport& r) {
  std::string out = fmt::format(
      "{} ({} bytes), {}{}, {} ({} on seams), {}, {}{}\n", counted(r.files, "files"), r.bytes,
      r.labels > 0 ? counted(r.labels, "labels") + ", " : "", counted(r.tiles, "tiles"),
      counted(r.vertices, "vertices"), r.seam_vertices, counted(r.triangles, "triangles"),
      counted(r.boundary_edges, "boundary edges"), r.merged_checked ? ", merged mesh checked" : "");
  for (const Problem& p : r.problems) out += fmt::format("  {}: {}\n", p.where, p.what);
  if (r.problem_count > r.problems.size())
    out += fmt::format("  and {} more\n", r.problem_count - r.problems.size());
  out += r.good() ? "good: no problem found\n"
                  : fmt::format("bad: {}\n", counted(r.problem_count, "problems"));
  return out;
}

std::string to_json_text(const VerifyReport& r) {
  nlohmann::ordered_json problems = nlohmann::ordered_json::array();
  for (const Problem& p : r.problems) problems.push_back({{"where", p.where}, {"what", p.what}});
  nlohmann::ordered_json out = {{"good", r.good()},
                                {"files", r.files},
                                {"bytes", r.bytes},
                                {"tiles", r.tiles},
                                {"vertices", r.vertices},
                                {"seam_vertices", r.seam_vertices},
                                {"triangles", r.triangles},
                                {"boundary_edges", r.boundary_edges},
                                {"merged_checked", r.merged_checked},
                                {"problem_count", r.problem_count},
                                {"problems", std::move(problems)}};
  if (r.labels > 0) out["labels"] = r.labels;
  return json_text(out) + "\n";
}

}  // namespace voxweld
