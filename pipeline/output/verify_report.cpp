#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "pipeline/executor/progress.h"
#include "pipeline/output/verify.h"
#include "storage/support/json_text.h"

namespace voxweld {

std::string to_text(const VerifyReport& r) {
  std::string out =
      fmt::format("{} ({} bytes), {}{}, {} ({} on seams), {}, {}{}{}\n", counted(r.files, "files"),
                  r.bytes, r.labels > 0 ? counted(r.labels, "labels") + ", " : "",
                  counted(r.tiles, "tiles"), counted(r.vertices, "vertices"), r.seam_vertices,
                  counted(r.triangles, "triangles"), counted(r.boundary_edges, "boundary edges"),
                  r.levels > 0 ? ", " + counted(r.levels, "coarser levels") : "",
                  r.merged_checked ? ", merged mesh checked" : "");
  if (r.intersections) {
    out += fmt::format("{} intersect, {} without an area\n",
                       counted(r.intersections->pairs, "pairs of triangles"),
                       counted(r.intersections->degenerate, "triangles"));
    for (const Vec3& p : r.intersections->first)
      out += fmt::format("  at ({}, {}, {})\n", p.x, p.y, p.z);
  }
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
  if (r.levels > 0) out["levels"] = r.levels;
  if (r.intersections) {
    out["intersecting_pairs"] = r.intersections->pairs;
    out["degenerate_triangles"] = r.intersections->degenerate;
    out["intersections_at"] = nlohmann::ordered_json::array();
    for (const Vec3& p : r.intersections->first) out["intersections_at"].push_back({p.x, p.y, p.z});
  }
  return json_text(out) + "\n";
}

}  // namespace voxweld
