#include "pipeline/mesh/verify.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_pipeline.h>

#include <memory>
#include <optional>
#include <unordered_map>

#include "pipeline/mesh/manifest.h"
#include "pipeline/mesh/openmesh_check.h"
#include "pipeline/mesh/seam_check.h"
#include "pipeline/mesh/tile_check.h"
#include "stages/encode/glb.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "storage/support/hash.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;
using Problems = std::vector<Problem>;

// One file, checked against its record. Empty when it cannot be read.
std::vector<std::byte> checked_file(const fs::path& directory, const FileRecord& record,
                                    Problems& problems) {
  std::vector<std::byte> bytes;
  try {
    bytes = read_whole_file(directory / record.path);
  } catch (const Error& e) {
    problems.push_back({record.path, e.what()});
    return bytes;
  }
  if (bytes.size() != record.bytes) {
    problems.push_back({record.path, fmt::format("has {} bytes, {} are listed: write it again",
                                                 bytes.size(), record.bytes)});
  } else if (const std::string hash = to_hex(hash_bytes(bytes)); hash != record.xxh3_128) {
    problems.push_back({record.path, fmt::format("damaged: its hash is {}, {} is listed: write it "
                                                 "again",
                                                 hash, record.xxh3_128)});
  }
  return bytes;
}

std::optional<LatticeMesh> decoded(std::span<const std::byte> bytes, bool glb,
                                   const std::string& path, const OutputLattice& lattice,
                                   Problems& problems) {
  if (bytes.empty()) return std::nullopt;
  try {
    return weld(glb ? decode_glb(bytes, path) : decode_draco(bytes, path), lattice, path);
  } catch (const Error& e) {
    problems.push_back({path, e.what()});
    return std::nullopt;
  }
}

// The .drc and the .glb of one mesh hold the same Draco buffer; where they do not, they must at
// least hold the same triangles.
struct MeshFiles {
  std::vector<std::byte> drc, glb;
  std::string drc_path, glb_path;

  std::optional<LatticeMesh> decode(const OutputLattice& lattice, Problems& problems) const {
    auto mesh = decoded(drc, false, drc_path, lattice, problems);
    if (glb.empty()) return mesh;
    auto other = decoded(glb, true, glb_path, lattice, problems);
    if (!mesh) return other;
    if (other && digest(*other) != digest(*mesh))
      problems.push_back({glb_path, "its triangles differ from those of " + drc_path});
    return mesh;
  }
};

struct TileResult {
  TileRecord record;
  Problems problems;
  TileSeams seams;
  TriangleDigest triangles;
  std::uint64_t files = 0, bytes = 0;
};

class TileReader {
 public:
  TileReader(const fs::path& directory, const Manifest& manifest)
      : directory_(directory), manifest_(manifest), frame_(manifest) {}

  TileResult check(TileRecord record) const {
    TileResult result;
    result.record = std::move(record);
    std::optional<LatticeMesh> mesh = read(result);
    check_listing(result);
    if (mesh) check_mesh(*mesh, result);
    return result;
  }

  // Those of `points` that the tile has.
  Problems use_of(const TileRecord& record, const std::vector<LatticePoint>& points) const {
    TileResult result;
    result.record = record;
    const std::optional<LatticeMesh> mesh = read(result);
    Problems problems;
    if (!mesh) return problems;  // said before
    PointIndex index;
    for (const LatticePoint& q : mesh->positions) index.add(q);
    for (const LatticePoint& q : points) {
      if (index.find(q) == PointIndex::none) continue;
      const Vec3 p = frame_.position(q);
      problems.push_back(
          {fmt::format("{} at ({}, {}, {})", tile_name(record.tile), p.x, p.y, p.z),
           "not 2-manifold: this vertex is surrounded in its tile and used by another one too"});
    }
    return problems;
  }

 private:
  std::optional<LatticeMesh> read(TileResult& result) const {
    MeshFiles files;
    bool any = false;
    for (const FileRecord& file : result.record.files) {
      auto bytes = checked_file(directory_, file, result.problems);
      ++result.files;
      result.bytes += bytes.size();
      if (file.format != "drc" && file.format != "glb") continue;
      any = true;
      (file.format == "drc" ? files.drc : files.glb) = std::move(bytes);
      (file.format == "drc" ? files.drc_path : files.glb_path) = file.path;
    }
    if (!any)
      result.problems.push_back({tile_name(result.record.tile),
                                 "lists no .drc or .glb file: its mesh cannot be checked"});
    return files.decode(manifest_.lattice, result.problems);
  }

  static void expect(TileResult& result, const char* what, std::uint64_t found,
                     std::uint64_t listed) {
    if (found != listed)
      result.problems.push_back({tile_name(result.record.tile),
                                 fmt::format("has {} {}, {} are listed", found, what, listed)});
  }

  static void check_listing(TileResult& result) {
    const TileRecord& r = result.record;
    expect(result, "triangles by its quads and polygon triangles",
           2 * r.quads + r.polygon_triangles, r.triangles);
  }

  void check_mesh(LatticeMesh& mesh, TileResult& result) const {
    expect(result, "vertices", mesh.positions.size(), result.record.vertices);
    expect(result, "triangles", mesh.triangles.size(), result.record.triangles);
    result.triangles = digest(mesh);
    const std::uint64_t degenerate = drop_degenerate(mesh);
    if (degenerate > 0)
      result.problems.push_back(
          {tile_name(result.record.tile),
           fmt::format("has {} triangles with two equal corners", degenerate)});
    const bool shared = manifest_.labels == LabelMode::shared;
    if (shared && mesh.pairs.empty() && !mesh.triangles.empty())
      result.problems.push_back(
          {tile_name(result.record.tile), "does not say which labels its triangles separate"});
    result.seams = shared && !mesh.pairs.empty()
                       ? find_label_seams(mesh, result.record.tile, frame_)
                       : find_seams(mesh, result.record.tile, frame_);
  }

  const fs::path& directory_;
  const Manifest& manifest_;
  const PointFrame frame_;
};

// Calls work for each listed tile on many threads, and then fold for each, in the list's order.
template <class Result, class Work, class Fold>
void for_each_tile(const fs::path& list, int threads, Work work, Fold fold) {
  TileListReader reader(list);
  const auto next = [&](tbb::flow_control& control) {
    std::optional<TileRecord> record = reader.next();
    if (!record) control.stop();
    return record ? std::make_shared<TileRecord>(std::move(*record)) : nullptr;
  };
  using In = std::shared_ptr<TileRecord>;
  using Out = std::shared_ptr<Result>;
  const auto serial = tbb::filter_mode::serial_in_order;
  tbb::parallel_pipeline(
      static_cast<std::size_t>(threads),
      tbb::make_filter<void, In>(serial, next) &
          tbb::make_filter<In, Out>(tbb::filter_mode::parallel,
                                    [&](const In& record) {
                                      return std::make_shared<Result>(work(std::move(*record)));
                                    }) &
          tbb::make_filter<Out, void>(serial, [&](const Out& result) { fold(*result); }));
}

class Verifier {
 public:
  Verifier(const fs::path& directory, const VerifyOptions& options)
      : directory_(directory),
        options_(options),
        manifest_(read_manifest(directory / manifest_name)),
        frame_(manifest_),
        tiles_(directory_, manifest_),
        seams_(frame_, {manifest_.open_border, manifest_.free_topology,
                        manifest_.labels == LabelMode::shared}),
        threads_(options.threads > 0 ? options.threads : tbb::info::default_concurrency()) {}

  VerifyReport run() {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads_));
    for_each_tile<TileResult>(
        directory_ / tiles_name, threads_,
        [&](TileRecord record) { return tiles_.check(std::move(record)); },
        [&](const TileResult& result) { fold(result); });
    seams_.finish([&](Problem problem) { note(std::move(problem)); });
    check_doubtful();
    check_totals();
    check_merged();
    return std::move(report_);
  }

 private:
  bool promises_manifold() const {
    return !manifest_.free_topology && manifest_.labels != LabelMode::shared;
  }
  void note(Problem problem) {
    if (report_.problem_count++ < options_.listed_problems)
      report_.problems.push_back(std::move(problem));
  }
  void note_all(const Problems& problems) {
    for (const Problem& problem : problems) note(problem);
  }

  void fold(const TileResult& result) {
    note_all(result.problems);
    seams_.add(result.record.tile, result.seams);
    triangles_ += result.triangles;
    quads_ += result.record.quads;
    polygon_triangles_ += result.record.polygon_triangles;
    ++report_.tiles;
    report_.files += result.files;
    report_.bytes += result.bytes;
  }

  void check_doubtful() {
    const auto doubtful = seams_.doubtful();
    if (doubtful.empty()) return;
    for_each_tile<Problems>(
        directory_ / tiles_name, threads_,
        [&](const TileRecord& record) {
          const auto found = doubtful.find(tile_name(record.tile));
          return found == doubtful.end() ? Problems{} : tiles_.use_of(record, found->second);
        },
        [&](const Problems& problems) {
          counted_twice_ += problems.size();
          if (promises_manifold()) note_all(problems);
        });
  }

  void expect(const char* key, std::uint64_t found, std::uint64_t stated) {
    if (found != stated)
      note({manifest_name, fmt::format("counts.{} is {}, the tiles have {}", key, stated, found)});
  }

  void check_totals() {
    report_.vertices = seams_.vertices() - counted_twice_;
    report_.triangles = triangles_.count;
    report_.seam_vertices = seams_.seam_vertices();
    report_.boundary_edges = seams_.boundary_edges();
    const ManifestCounts& counts = manifest_.counts;
    expect("tiles", report_.tiles, counts.tiles);
    // An open border and a free topology leave out polygons, and vertices with them.
    if (!manifest_.open_border && !manifest_.free_topology)
      expect("vertices", report_.vertices, counts.vertices);
    expect("output_triangles", report_.triangles, counts.output_triangles);
    expect("quads", quads_, counts.quads);
    expect("triangles", polygon_triangles_, counts.triangles);
  }

  // Files that are no tile's: those of the merged mesh, the list of tiles.
  void check_merged() {
    Problems problems;
    MeshFiles merged;
    for (const FileRecord& file : manifest_.files) {
      auto bytes = checked_file(directory_, file, problems);
      if (file.role != "merged") continue;
      ++report_.files;
      report_.bytes += bytes.size();
      if (!manifest_.merged || !options_.merged) continue;
      if (file.path == manifest_.merged->drc) merged.drc = std::move(bytes);
      if (file.path == manifest_.merged->glb) merged.glb = std::move(bytes);
    }
    note_all(problems);
    if (!manifest_.merged || !options_.merged) return;
    merged.drc_path = manifest_.merged->drc;
    merged.glb_path = manifest_.merged->glb;
    check_merged_mesh(merged);
  }

  void check_merged_mesh(const MeshFiles& files) {
    Problems problems;
    const std::string& name = files.drc_path.empty() ? files.glb_path : files.drc_path;
    if (files.drc.empty() && files.glb.empty())
      problems.push_back({manifest_name, "\"merged\" names no file that \"files\" lists"});
    std::optional<LatticeMesh> mesh = files.decode(manifest_.lattice, problems);
    if (mesh) {
      report_.merged_checked = true;
      if (digest(*mesh) != triangles_)
        problems.push_back(
            {name, fmt::format("its {} triangles are not the {} of the tiles put together",
                               mesh->triangles.size(), triangles_.count)});
      if (promises_manifold()) {
        for (std::string& what : openmesh_problems(std::move(*mesh), manifest_.open_border))
          problems.push_back({name, std::move(what)});
      }
    }
    note_all(problems);
  }

  const fs::path directory_;
  const VerifyOptions options_;
  const Manifest manifest_;
  const PointFrame frame_;
  const TileReader tiles_;
  SeamCheck seams_;
  const int threads_;
  TriangleDigest triangles_;
  std::uint64_t quads_ = 0, polygon_triangles_ = 0;
  std::uint64_t counted_twice_ = 0;  // inside their tile, and kept by another
  VerifyReport report_;
};

}  // namespace

VerifyReport verify_output(const fs::path& directory, const VerifyOptions& options) {
  return Verifier(directory, options).run();
}

}  // namespace voxweld
