#include "pipeline/encode/level_listing.h"

#include <algorithm>
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
        format_(tileset_format(listing.job)),
        manifest_(manifest) {}

  void list(FileNames& leftovers) {
    for (const ListedTile& tile : listing_.tiles.tiles) {
      listing_.tiles.check_interrupt();
      add_leaves(whole_record(tile.record));
    }
    AssetFile list(listing_.job.output, levels_name);
    for (std::uint64_t n = 0; n < tree_.nodes().size(); ++n) {
      listing_.tiles.check_interrupt();
      const AssetRecord record =
          whole_record(level_record_path(listing_.job.folder, tree_.nodes()[n]));
      nodes_.push_back(sums_of(record.triangles, record.files));
      node_meshes_.push_back({record.box, tileset_file(record.files)});
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
  static Sums sums_of(std::uint64_t triangles, std::span<const FileRecord> files) {
    Sums sums{!files.empty(), triangles, 0};
    for (const FileRecord& file : files) sums.bytes += file.bytes;
    return sums;
  }
  std::string tileset_file(std::span<const FileRecord> files) const {
    const auto file = std::ranges::find(files, format_, &FileRecord::format);
    return file == files.end() ? std::string() : file->path;
  }

  // The leaves of one unit: its tile, or its labels.
  void add_leaves(const AssetRecord& record) {
    const std::span<const FileRecord> files = record.files;
    if (!tree_.of_labels()) {
      leaves_.push_back(sums_of(record.triangles, files));
      leaf_meshes_.push_back({record.box, tileset_file(files)});
      return;
    }
    std::size_t begin = 0;
    for (const LabelAsset& label : record.labels) {
      const auto own = files.subspan(begin, label.files);
      begin += label.files;
      leaves_.push_back(sums_of(label.triangles, own));
      TilesetMesh& mesh = leaf_meshes_.emplace_back();
      if (!label.measure.empty) mesh.box = {label.measure.lo, label.measure.hi};
      mesh.file = tileset_file(own);
    }
  }

  void add_tileset() {
    if (format_.empty()) return;
    const TilesetInputs inputs{
        listing_.levels,     errors_,       manifest_.lattice, manifest_.frame,
        listing_.job.output, source_name(), leaf_meshes_,      node_meshes_};
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
    for (const Sums& leaf : leaves_) bytes += leaf.bytes;
    return bytes;
  }

  nlohmann::json of_level(int height) const {
    std::uint64_t tiles = 0, triangles = 0, bytes = 0;
    RefineCounts counts;
    double worst = 0, tolerance = 0;
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
          tolerance = std::max(tolerance, listing_.levels.tolerance(n));
          if (tree_.nodes()[n].height == height) bytes += nodes_[n].bytes;
        },
        [&](std::uint64_t t) { add(leaves_[t]); });
    const double step = manifest_.lattice.step;
    return {{"level", height},
            {"tolerance", tolerance * step},
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
  const std::string format_;              // whose files a tileset has; empty: there is none
  Manifest& manifest_;
  // Records are read once for all levels.
  std::vector<Sums> leaves_, nodes_;
  std::vector<TilesetMesh> leaf_meshes_, node_meshes_;
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
