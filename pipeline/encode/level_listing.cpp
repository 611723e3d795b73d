#include "pipeline/encode/level_listing.h"

#include <nlohmann/json.hpp>

#include "pipeline/encode/tileset.h"
#include "storage/artifact/asset_record.h"

namespace voxweld {
namespace {

class LevelLister {
 public:
  LevelLister(const LevelListing& listing, Manifest& manifest)
      : listing_(listing),
        tree_(listing.levels.tree()),
        errors_(listing.levels.errors()),
        manifest_(manifest) {}

  void list(FileNames& leftovers) {
    for (std::uint64_t t = 0; t < listing_.tiles.tiles.size(); ++t) {
      listing_.tiles.check_interrupt();
      tiles_.push_back(sums_of(tile(t)));
    }
    AssetFile list(listing_.job.output, levels_name);
    for (std::uint64_t n = 0; n < tree_.nodes().size(); ++n) {
      listing_.tiles.check_interrupt();
      const AssetRecord record = node(n);
      nodes_.push_back(sums_of(record));
      if (record.files.empty()) continue;
      for (const FileRecord& file : record.files) leftovers.leave_out(file.path);
      const LevelNode& at = tree_.nodes()[n];
      const std::string line = to_json_line(TileRecord{{},
                                                       at.cell,
                                                       record.vertices,
                                                       record.triangles,
                                                       record.quads,
                                                       record.polygon_triangles,
                                                       record.files,
                                                       at.height});
      list.append(as_bytes(line));
    }
    manifest_.files.push_back(list.finish("jsonl"));
    manifest_.files.back().role = "levels";
    add_tileset();
    manifest_.levels = std::make_unique<nlohmann::json>(section());
  }

 private:
  // What levels sum up of a record.
  struct Sums {
    bool any = false;  // it has files
    std::uint64_t triangles = 0, bytes = 0;
  };
  static Sums sums_of(const AssetRecord& record) {
    Sums sums{!record.files.empty(), record.triangles, 0};
    for (const FileRecord& file : record.files) sums.bytes += file.bytes;
    return sums;
  }

  AssetRecord node(std::uint64_t number) const {
    return whole_record(level_record_path(listing_.job.folder, tree_.nodes()[number]));
  }
  AssetRecord tile(std::uint64_t number) const {
    return whole_record(listing_.tiles.tiles[number].record);
  }

  void add_tileset() {
    const std::string format = tileset_format(listing_.job);
    if (format.empty()) return;
    const TilesetInputs inputs{listing_.levels,
                               errors_,
                               manifest_.lattice,
                               manifest_.frame,
                               listing_.job.output,
                               source_name(),
                               format,
                               [&](std::uint64_t n) { return tile(n); },
                               [&](std::uint64_t n) { return node(n); }};
    for (FileRecord& file : write_tileset(inputs)) manifest_.files.push_back(std::move(file));
  }

  std::string source_name() const {
    if (manifest_.input == nullptr) return {};
    return std::filesystem::path(manifest_.input->value("path", "")).filename().string();
  }

  nlohmann::json section() const {
    nlohmann::json levels = nlohmann::json::array();
    nlohmann::json finest = {{"level", 0},
                             {"tiles", manifest_.counts.tiles},
                             {"triangles", manifest_.counts.triangles},
                             {"bytes", bytes_of_tiles()}};
    if (manifest_.refine != nullptr)
      for (const char* key : {"tolerance", "worst", "p99", "intersecting_left"})
        if (manifest_.refine->contains(key)) finest[key] = (*manifest_.refine)[key];
    levels.push_back(finest);
    for (int height = 1; height <= tree_.top(); ++height) levels.push_back(of_level(height));
    return levels;
  }
  std::uint64_t bytes_of_tiles() const {
    std::uint64_t bytes = 0;
    for (const Sums& tile : tiles_) bytes += tile.bytes;
    return bytes;
  }

  nlohmann::json of_level(int height) const {
    std::uint64_t tiles = 0, triangles = 0, bytes = 0;
    RefineCounts counts;
    double worst = 0;
    const auto add = [&](const Sums& sums) {
      if (!sums.any) return;
      ++tiles;
      triangles += sums.triangles;
    };
    tree_.cut(
        height,
        [&](std::uint64_t n) {
          add(nodes_[n]);
          counts.add(listing_.levels.counts(n));
          worst = std::max(worst, errors_[n].worst);
          if (tree_.nodes()[n].height == height) bytes += nodes_[n].bytes;
        },
        [&](std::uint64_t t) { add(tiles_[t]); });
    const double step = manifest_.lattice.step;
    return {{"level", height},
            {"tolerance", listing_.levels.tolerance(height) * step},
            {"tiles", tiles},
            {"triangles", triangles},
            {"bytes", bytes},
            {"worst", worst * step},
            {"p99", counts.quantile(0.99) * step},
            {"intersecting_left", counts.pairs_left}};
  }

  const LevelListing& listing_;
  const LevelTree& tree_;
  const std::vector<LevelError> errors_;  // of nodes
  Manifest& manifest_;
  std::vector<Sums> tiles_, nodes_;  // records are read once for all levels
};

}  // namespace

std::string tileset_format(const EncodeJob& job) {
  for (const std::string_view name : tileset_formats)
    for (const MeshWriter& writer : job.formats)
      if (writer.name == name) return std::string(name);
  return {};
}

void list_levels(const LevelListing& listing, Manifest& manifest, FileNames& leftovers) {
  LevelLister(listing, manifest).list(leftovers);
}

}  // namespace voxweld
