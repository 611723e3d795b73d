#include "pipeline/encode/listing.h"

#include <algorithm>
#include <cstring>
#include <set>

#include "pipeline/encode/output_files.h"
#include "pipeline/encode/piece_list.h"
#include "pipeline/executor/probe.h"
#include "stages/encode/mesh_measure.h"
#include "storage/artifact/asset_record.h"
#include "storage/support/error.h"
#include "storage/support/record_sorter.h"

namespace voxweld {
namespace {

constexpr std::size_t records_ahead = 256;
constexpr std::uintmax_t records_bytes = std::uintmax_t{64} << 20;  // of those held at once

void count_file(const FileRecord& file, ManifestCounts& counts, FileNames& leftovers) {
  ++counts.files;
  counts.bytes += file.bytes;
  leftovers.leave_out(file.path);
}

// A list under way.
class ListFile {
 public:
  ListFile(const std::filesystem::path& output, const char* name) : file_(output, name) {}
  void line(const std::string& text) { file_.append(as_bytes(text)); }
  // What the manifest says of it.
  FileRecord finish(const char* role) {
    FileRecord entry = file_.finish("jsonl");
    entry.role = role;
    return entry;
  }

 private:
  AssetFile file_;
};

// Lines of labels.jsonl from the meshes of labels: each is written when another one comes, so those
// of one have to come together.
class LabelLines {
 public:
  LabelLines(ListFile& out, const Manifest& manifest, const MaterialTable* materials)
      : out_(out),
        lattice_(manifest.lattice),
        open_border_(manifest.open_border),
        materials_(materials) {}

  void add(const LabelAsset& mesh, std::uint64_t tiles, std::span<const FileRecord> files) {
    if (any_ && open_.label != mesh.label) close();
    if (!any_) open(mesh.label);
    open_.vertices += mesh.octree_vertices;
    open_.triangles += mesh.triangles;
    open_.tiles += tiles;
    for (const FileRecord& file : files) open_.files.push_back(file.path);
    measure_ += mesh.measure;
  }
  // After the last. Returns how many there were.
  std::uint64_t finish() {
    close();
    return count_;
  }

 private:
  void open(Material label) {
    any_ = true;
    open_.label = label;
    const MaterialEntry* entry = materials_ == nullptr ? nullptr : materials_->find(label);
    if (entry == nullptr) return;
    open_.name = entry->name;
    if (const auto& color = entry->color) open_.color = {color->red, color->green, color->blue};
  }
  void close() {
    if (!any_) return;
    if (!open_border_) open_.volume = enclosed_volume(measure_, lattice_);
    open_.area = surface_area(measure_, lattice_);
    if (!measure_.empty) open_.bounds = {place(measure_.lo), place(measure_.hi)};
    out_.line(to_json_line(open_));
    ++count_;
    any_ = false;
    open_ = {};
    measure_ = {};
  }
  Vec3 place(const LatticePoint& q) const {
    return {lattice_.coordinate(0, q[0]), lattice_.coordinate(1, q[1]),
            lattice_.coordinate(2, q[2])};
  }

  ListFile& out_;
  OutputLattice lattice_;
  bool open_border_;
  const MaterialTable* materials_;
  bool any_ = false;  // open_ is under way
  LabelRecord open_;
  MeshMeasure measure_;
  std::uint64_t count_ = 0;
};

// Labels that may have a part in any tile, in bounded memory.
class LabelSums {
 public:
  explicit LabelSums(const std::filesystem::path& scratch) : parts_(scratch, sorter_bytes) {}

  // Of tile after tile.
  void add(const AssetRecord& record) {
    for (const LabelAsset& part : record.labels) {
      const Part packed{part.octree_vertices, part.triangles, part.measure,
                        record.files.empty() ? 0U : 1U};
      parts_.push({part.label, tile_}, std::as_bytes(std::span(&packed, 1)));
    }
    ++tile_;
  }
  void write(LabelLines& lines) {
    SortKey key;
    std::vector<std::byte> bytes;
    while (parts_.next(key, bytes)) {
      Part part;
      std::memcpy(&part, bytes.data(), sizeof part);
      LabelAsset asset;
      asset.label = key.major;
      asset.octree_vertices = part.octree_vertices;
      asset.triangles = part.triangles;
      asset.measure = part.measure;
      lines.add(asset, part.tiles, {});
    }
  }

 private:
  static constexpr std::uint64_t sorter_bytes = std::uint64_t{16} << 20;
  struct Part {
    std::uint64_t octree_vertices = 0, triangles = 0;
    MeshMeasure measure;
    std::uint64_t tiles = 0;
  };
  RecordSorter parts_;
  std::uint64_t tile_ = 0;
};

// Records of labels read at once, as many as are small. A label takes 128 bytes in the file, and
// about 200 in memory.
std::size_t label_records_ahead(const Listing& listing) {
  std::vector<std::uintmax_t> sizes(listing.tiles.size());
  probe_all(sizes.size(), [&](std::size_t i) {
    std::error_code missing;  // the reader says it
    const auto size = std::filesystem::file_size(listing.tiles[i].record, missing);
    sizes[i] = missing ? 0 : size;
  });
  const auto largest = std::ranges::max_element(sizes);
  const std::uintmax_t one = 3 * (largest == sizes.end() ? 0 : *largest) + 1;
  return static_cast<std::size_t>(
      std::clamp<std::uintmax_t>(records_bytes / one, 1, records_ahead));
}

// The meshes of a record as lines of tiles.jsonl; f(line, its files) of each.
template <class F>
void each_mesh(const Listing& listing, std::size_t number, AssetRecord& record, F&& f) {
  const CellKey& tile = listing.tiles[number].tile;
  if (listing.labels != LabelMode::each) {
    f(TileRecord{{},
                 tile,
                 record.vertices,
                 record.triangles,
                 record.quads,
                 record.polygon_triangles,
                 std::move(record.files)},
      nullptr);
    return;
  }
  auto file = record.files.begin();
  std::size_t in_record = 0;
  for (const LabelAsset& mesh : record.labels) {
    const auto end = file + static_cast<std::ptrdiff_t>(mesh.files);
    f(TileRecord{mesh.label,
                 mesh.tile,
                 mesh.vertices,
                 mesh.triangles,
                 mesh.quads,
                 mesh.polygon_triangles,
                 {file, end},
                 0,
                 listing.place ? listing.place(number, in_record++) : std::nullopt},
      &mesh);
    file = end;
  }
}

// Writes tiles.jsonl and labels.jsonl.
void list_tiles(const Listing& listing, Manifest& manifest, FileNames& leftovers) {
  ManifestCounts& counts = manifest.counts;
  ListFile tiles(listing.output, tiles_name);
  std::optional<ListFile> labels;
  std::optional<LabelLines> lines;
  std::optional<LabelSums> sums;
  std::size_t ahead = records_ahead;
  if (listing.labels != LabelMode::off) {
    labels.emplace(listing.output, labels_name);
    lines.emplace(*labels, manifest, listing.materials);
    ahead = label_records_ahead(listing);
  }
  if (listing.labels == LabelMode::shared) sums.emplace(listing.scratch);
  PieceList pieces(listing.output, {listing.normals, listing.labels == LabelMode::shared});
  probe_in_order<AssetRecord>(
      listing.tiles.size(), ahead,
      [&](std::size_t i) { return whole_record(listing.tiles[i].record); },
      [&](std::size_t i, AssetRecord&& record) {
        listing.check_interrupt();
        counts.quads += record.quads;
        counts.polygon_triangles += record.polygon_triangles;
        counts.triangles += record.triangles;
        counts.collinear += record.collinear;
        if (sums) sums->add(record);
        pieces.add(record);
        each_mesh(listing, i, record, [&](const TileRecord& tile, const LabelAsset* mesh) {
          if (mesh != nullptr) lines->add(*mesh, tile.files.empty() ? 0 : 1, tile.files);
          if (tile.files.empty()) return;
          ++counts.tiles;
          for (const FileRecord& one : tile.files) count_file(one, counts, leftovers);
          tiles.line(to_json_line(tile));
        });
      });
  manifest.files.push_back(tiles.finish("list"));
  if (auto list = pieces.finish()) manifest.files.push_back(std::move(*list));
  if (!labels) return;
  if (sums) sums->write(*lines);
  counts.labels = lines->finish();
  manifest.files.push_back(labels->finish("labels"));
}

// Files of an earlier run, and the folders that have none then.
void remove_earlier(const Listing& listing, FileNames& earlier) {
  std::set<std::filesystem::path> folders;
  earlier.each([&](const std::string& name) {
    listing.check_interrupt();
    std::filesystem::remove(listing.output / name);
    for (std::filesystem::path at = name; at.has_parent_path(); folders.insert(at))
      at = at.parent_path();
  });
  listing.check_interrupt();
  std::error_code not_empty;
  for (auto folder = folders.rbegin(); folder != folders.rend(); ++folder) {  // inner ones first
    const std::filesystem::path path = listing.output / *folder;
    if (is_directory(symlink_status(path, not_empty))) std::filesystem::remove(path, not_empty);
  }
}

}  // namespace

AssetRecord whole_record(const std::filesystem::path& path) {
  auto record = read_asset_record(path);
  if (!record) throw DamagedArtifact(path.string(), "is not a whole record");
  return std::move(*record);
}

void write_listing(const Listing& listing, FileNames& earlier, Manifest manifest) {
  list_tiles(listing, manifest, earlier);
  if (listing.merged) {
    manifest.merged.emplace();
    for (FileRecord file : whole_record(*listing.merged).files) {
      file.role = "merged";
      manifest.merged->emplace(file.format, file.path);
      count_file(file, manifest.counts, earlier);
      manifest.files.push_back(file);
    }
  }
  if (listing.levels) listing.levels(manifest, earlier);
  for (const FileRecord& file : manifest.files) earlier.leave_out(file.path);
  remove_earlier(listing, earlier);
  write_manifest(manifest, listing.output / manifest_name);
  finish_output(listing.output);
}

}  // namespace voxweld
