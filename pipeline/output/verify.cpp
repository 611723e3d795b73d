#include "pipeline/output/verify.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <unordered_map>

#include "pipeline/output/openmesh_check.h"
#include "pipeline/output/origin.h"
#include "pipeline/output/seam_check.h"
#include "pipeline/output/streamed_file.h"
#include "pipeline/output/tile_stream.h"
#include "pipeline/output/verify_levels.h"
#include "pipeline/output/verify_tiles.h"
#include "storage/manifest/manifest.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

// The tiles of one surface: all of them, or with labels.mode = "each" those of one label.
struct Surface {
  Surface(const PointFrame& frame, const SeamRules& rules) : seams(frame, rules) {}

  SeamCheck seams;
  std::uint64_t tiles = 0, triangles = 0;
  std::uint64_t counted_twice = 0;  // vertices inside their tile, and kept by another
  IntersectionCheck intersections;  // where asked for
  // Of a label.
  std::vector<TileRecord> records;
  MeshMeasure measure;
};

class Verifier {
 public:
  Verifier(const fs::path& directory, const VerifyOptions& options)
      : directory_(directory),
        options_(options),
        manifest_(read_manifest(directory / manifest_name)),
        each_(manifest_.labels == LabelMode::each),
        shared_(manifest_.labels == LabelMode::shared),
        frame_(manifest_),
        tiles_(directory_, manifest_, options_.formats),
        threads_(options.threads > 0 ? options.threads : tbb::info::default_concurrency()) {
    if (each_) labels_.emplace(directory / labels_name);
    if (!each_) open_surface({});
  }

  VerifyReport run() {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads_));
    if (has_no_tiles())
      fold_whole();
    else
      for_each_tile<TileResult>(
          directory_ / tiles_name, threads_,
          [&](TileRecord record, std::size_t) {
            check_interrupt();
            return tiles_.check(std::move(record), {.intersections = options_.intersections});
          },
          [&](TileResult& result) { fold(result); });
    close_surface();
    if (each_) check_labels_to_end();
    check_totals();
    check_merged();
    if (lists_levels()) check_levels();
    if (options_.origin) note_all(check_origin(manifest_));
    return std::move(report_);
  }

 private:
  void check_interrupt() const {
    if (options_.interrupt != nullptr) options_.interrupt->check();
  }
  bool promises_manifold() const { return !manifest_.free_topology && !shared_; }
  void note(Problem problem) {
    if (report_.problem_count++ < options_.listed_problems)
      report_.problems.push_back(std::move(problem));
  }
  void note_all(const Problems& problems) {
    for (const Problem& problem : problems) note(problem);
  }

  // output.tiles = false: the merged mesh is all there is.
  bool has_no_tiles() const {
    return manifest_.merged && manifest_.counts.tiles == 0 &&
           !TileListReader(directory_ / tiles_name).next();
  }

  // Checks the merged mesh as the one tile there is.
  void fold_whole() {
    TileRecord record;
    record.tile = whole_mesh;
    record.triangles = manifest_.counts.triangles;
    record.quads = manifest_.counts.quads;
    record.polygon_triangles = manifest_.counts.polygon_triangles;
    for (const FileRecord& file : manifest_.files)
      if (file.role == "merged") record.files.push_back(file);
    TileResult result = tiles_.check(
        std::move(record), {.intersections = options_.intersections, .vertices_listed = false});
    // check_merged() counts its files.
    result.files = result.bytes = 0;
    fold(result);
    surface_->tiles = 0;
  }

  void fold(TileResult& result) {
    note_all(result.problems);
    if (each_) turn_to_label(result.record);
    Surface& surface = *surface_;
    surface.seams.add(result.record.tile, result.seams);
    if (options_.intersections) surface.intersections.add(std::move(result.intersections));
    surface.triangles += result.triangles.count;
    ++surface.tiles;
    if (each_) {
      surface.records.push_back(result.record);
      surface.measure += result.measure;
    }
    triangles_ += result.triangles;
    quads_ += result.record.quads;
    polygon_triangles_ += result.record.polygon_triangles;
    report_.files += result.files;
    report_.bytes += result.bytes;
  }

  void open_surface(std::optional<Material> label) {
    surface_.emplace(frame_,
                     SeamRules{manifest_.open_border, manifest_.free_topology, shared_, label});
  }

  // Tiles of different labels have nothing to do with each other.
  void turn_to_label(const TileRecord& record) {
    if (!record.label) {
      note({record_name(record), "is of no label: tiles.jsonl is not of this run"});
      if (!surface_) open_surface({});
      return;
    }
    if (surface_ && surface_->records.front().label == record.label) return;
    if (surface_ && surface_->records.front().label > record.label)
      note({record_name(record), "comes after a label of a higher number: labels must ascend"});
    close_surface();
    open_surface(record.label);
  }

  void close_surface() {
    if (!surface_) return;
    Surface& surface = *surface_;
    surface.seams.finish([&](Problem problem) { note(std::move(problem)); });
    check_doubtful(surface);
    if (options_.intersections) count_intersections(surface);
    const std::uint64_t vertices = surface.seams.vertices() - surface.counted_twice;
    report_.tiles += surface.tiles;
    report_.vertices += vertices;
    report_.seam_vertices += surface.seams.seam_vertices();
    report_.boundary_edges += surface.seams.boundary_edges();
    if (each_ && !surface.records.empty()) check_label(surface, vertices);
    surface_.reset();
  }

  void check_doubtful(Surface& surface) {
    const auto doubtful = surface.seams.doubtful();
    if (doubtful.empty()) return;
    const auto work = [&](const TileRecord& record, std::size_t) {
      check_interrupt();
      const auto found = doubtful.find(tile_name(record.tile));
      return found == doubtful.end() ? Problems{} : tiles_.use_of(record, found->second);
    };
    const auto fold_in = [&](const Problems& problems) {
      surface.counted_twice += problems.size();
      if (promises_manifold()) note_all(problems);
    };
    each_tile_again<Problems>(surface, work, fold_in);
  }

  // f(record, its place) for the surface's tiles, on many threads where they are not those of one
  // label, and then fold for each result in the order of the tiles.
  template <class Result, class Work, class Fold>
  void each_tile_again(const Surface& surface, Work work, Fold fold) {
    if (each_) {
      for (std::size_t i = 0; i < surface.records.size(); ++i) fold(work(surface.records[i], i));
      return;
    }
    for_each_tile<Result>(directory_ / tiles_name, threads_, work, fold);
  }

  void count_intersections(Surface& surface) {
    surface.intersections.close();
    if (!report_.intersections) report_.intersections.emplace();
    *report_.intersections += surface.intersections.within();
    each_tile_again<IntersectionCount>(
        surface,
        [&](const TileRecord& record, std::size_t number) {
          check_interrupt();
          if (!surface.intersections.needs(number)) return IntersectionCount{};
          return surface.intersections.between(number, tiles_.mesh_again(record), record.tile,
                                               frame_);
        },
        [&](const IntersectionCount& found) { *report_.intersections += found; });
  }

  // The next line of labels.jsonl that has tiles.
  std::optional<LabelRecord> next_label() {
    while (auto label = labels_->next()) {
      ++report_.labels;
      if (label->tiles > 0) return label;
      if (label->triangles != 0 || !label->files.empty())
        note({label_name(*label), "has triangles, and no tile is listed"});
    }
    return std::nullopt;
  }
  static std::string label_name(const LabelRecord& label) {
    return fmt::format("{} label {}", labels_name, label.label);
  }

  void check_label(const Surface& surface, std::uint64_t vertices) {
    const Material label = surface.records.front().label.value_or(exterior);
    const std::optional<LabelRecord> listed = next_label();
    if (!listed || listed->label != label)
      return note(
          {labels_name, fmt::format("lists label {} where the tiles have label {}",
                                    listed ? std::to_string(listed->label) : "none", label)});
    LabelRecord found;
    found.label = label;
    found.vertices = manifest_.open_border ? listed->vertices : vertices;
    found.triangles = surface.triangles;
    found.tiles = surface.tiles;
    for (const TileRecord& record : surface.records)
      for (const FileRecord& file : record.files) found.files.push_back(file.path);
    if (!manifest_.open_border) found.volume = enclosed_volume(surface.measure, manifest_.lattice);
    found.area = surface_area(surface.measure, manifest_.lattice);
    if (!surface.measure.empty)
      found.bounds = {frame_.position(surface.measure.lo), frame_.position(surface.measure.hi)};
    compare(*listed, found);
  }

  void compare(const LabelRecord& listed, const LabelRecord& found) {
    const auto count = [&](const char* what, std::uint64_t is, std::uint64_t says) {
      if (is != says)
        note({label_name(listed), fmt::format("has {} {}, {} are listed", is, what, says)});
    };
    count("vertices", found.vertices, listed.vertices);
    count("triangles", found.triangles, listed.triangles);
    count("tiles", found.tiles, listed.tiles);
    if (found.files != listed.files)
      note({label_name(listed), "its files are not those of its tiles"});
    if (found.volume != listed.volume)
      note({label_name(listed),
            fmt::format("encloses a volume of {}, {} is listed", found.volume.value_or(0),
                        listed.volume ? fmt::format("{}", *listed.volume) : "none")});
    // Draco gives the triangles in another order than they were summed in.
    if (std::abs(found.area - listed.area) > 1e-9 * found.area)
      note({label_name(listed),
            fmt::format("has an area of {}, {} is listed", found.area, listed.area)});
    if (found.bounds != listed.bounds)
      note({label_name(listed), "does not lie where its bounds say"});
  }

  void check_labels_to_end() {
    if (const auto label = next_label()) note({label_name(*label), "has no tile in tiles.jsonl"});
    while (next_label()) continue;
    expect("labels", report_.labels, manifest_.counts.labels);
  }

  void expect(const char* key, std::uint64_t found, std::uint64_t stated) {
    if (found != stated)
      note({manifest_name, fmt::format("counts.{} is {}, the tiles have {}", key, stated, found)});
  }

  void check_totals() {
    report_.triangles = triangles_.count;
    const ManifestCounts& counts = manifest_.counts;
    expect("tiles", report_.tiles, counts.tiles);
    // An open border and a free topology leave out polygons, and vertices with them.
    if (!manifest_.open_border && !manifest_.free_topology)
      expect("vertices", report_.vertices, counts.vertices);
    expect("triangles", report_.triangles, counts.triangles);
    expect("quads", quads_, counts.quads);
    expect("polygon_triangles", polygon_triangles_, counts.polygon_triangles);
  }

  // Files that are no tile's: those of the merged mesh, and the lists.
  void check_merged() {
    std::vector<FormatFile> held;
    std::vector<const FileRecord*> streamed;
    Problems problems;
    for (const FileRecord& file : manifest_.files) {
      check_interrupt();
      if (file.role != "merged") {
        check_file(directory_, file, problems);
        continue;
      }
      ++report_.files;
      report_.bytes += file.bytes;
      const MeshWriter* const format = merged_format(file);
      if (format == nullptr) {
        check_file(directory_, file, problems);
      } else if (format->stream != nullptr) {
        check_file(directory_, file, problems);
        streamed.push_back(&file);
      } else {
        held.push_back({format, file.path, checked_file(directory_, file, problems)});
      }
    }
    const bool sound = problems.empty();
    note_all(problems);
    if (!manifest_.merged || !options_.merged) return;
    if (!held.empty() || streamed.empty()) check_merged_mesh(held);
    for (const FileRecord* file : streamed) {
      if (!sound) return;
      note_all(compare_streamed(directory_, file->path, manifest_.lattice, triangles_,
                                [&] { check_interrupt(); }));
      report_.merged_checked = true;
    }
  }

  bool lists_levels() const {
    return std::ranges::find(manifest_.files, levels_name, &FileRecord::path) !=
           manifest_.files.end();
  }
  void check_levels() {
    const SeamRules rules{manifest_.open_border, manifest_.free_topology, shared_ || each_, {}};
    const LevelTotals totals = verify_levels({directory_, tiles_, frame_, rules, each_, threads_,
                                              [&] { check_interrupt(); },
                                              [&](Problem problem) { note(std::move(problem)); }});
    report_.levels = totals.levels;
    report_.files += totals.files;
    report_.bytes += totals.bytes;
  }

  // Null where its mesh is not to be looked at.
  const MeshWriter* merged_format(const FileRecord& file) const {
    if (!manifest_.merged || !options_.merged) return nullptr;
    const auto named = manifest_.merged->find(file.format);
    return named != manifest_.merged->end() && named->second == file.path
               ? writer_named(options_.formats, file.format)
               : nullptr;
  }

  void check_merged_mesh(const std::vector<FormatFile>& files) {
    check_interrupt();
    Problems problems;
    if (std::ranges::all_of(files, [](const FormatFile& file) { return file.bytes.empty(); }))
      problems.push_back({manifest_name, "\"merged\" names no file that \"files\" lists"});
    const std::string name = files.empty() ? manifest_name : files.front().path;
    std::optional<LatticeMesh> mesh = decode(files, manifest_.lattice, problems);
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
  const bool each_;    // labels are surfaces of their own
  const bool shared_;  // or parts of one complex
  const PointFrame frame_;
  const TileReader tiles_;
  std::optional<LabelListReader> labels_;  // of labels
  const int threads_;
  std::optional<Surface> surface_;  // under way
  TriangleDigest triangles_;
  std::uint64_t quads_ = 0, polygon_triangles_ = 0;
  VerifyReport report_;
};

}  // namespace

VerifyReport verify_output(const fs::path& directory, const VerifyOptions& options) {
  return Verifier(directory, options).run();
}

}  // namespace voxweld
