#include "pipeline/run/listing.h"

#include "pipeline/executor/probe.h"
#include "pipeline/run/asset_record.h"
#include "pipeline/run/output_files.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr std::size_t records_ahead = 256;

AssetRecord whole_record(const std::filesystem::path& path) {
  auto record = read_asset_record(path);
  if (!record) throw DamagedArtifact(path.string(), "is not a whole record");
  return std::move(*record);
}

void count_file(const FileRecord& file, ManifestCounts& counts, std::set<std::string>& leftovers) {
  ++counts.files;
  counts.bytes += file.bytes;
  leftovers.erase(file.path);
}

// Writes tiles.jsonl and returns what the manifest says of it.
FileRecord list_tiles(const Listing& listing, ManifestCounts& counts,
                      std::set<std::string>& leftovers) {
  AtomicFile file(listing.output / tiles_name);
  StreamHasher hash;
  probe_in_order<AssetRecord>(
      listing.tiles.size(), records_ahead,
      [&](std::size_t i) { return whole_record(listing.tiles[i].record); },
      [&](std::size_t i, AssetRecord&& record) {
        counts.quads += record.quads;
        counts.triangles += record.polygon_triangles;
        counts.output_triangles += record.triangles;
        counts.collinear += record.collinear;
        if (record.files.empty()) return;
        ++counts.tiles;
        for (const FileRecord& one : record.files) count_file(one, counts, leftovers);
        const std::string line =
            to_json_line({listing.tiles[i].tile, record.vertices, record.triangles, record.quads,
                          record.polygon_triangles, std::move(record.files)});
        hash.update(as_bytes(line));
        file.append(as_bytes(line));
      });
  FileRecord entry{tiles_name, "jsonl", "list", file.size(), to_hex(hash.finish())};
  file.commit(Durability::fsync);
  return entry;
}

}  // namespace

void write_listing(const Listing& listing, std::set<std::string> earlier, Manifest manifest) {
  manifest.files.push_back(list_tiles(listing, manifest.counts, earlier));
  if (listing.merged) {
    manifest.merged.emplace();
    for (FileRecord file : whole_record(*listing.merged).files) {
      file.role = "merged";
      (file.format == "drc" ? manifest.merged->drc : manifest.merged->glb) = file.path;
      count_file(file, manifest.counts, earlier);
      manifest.files.push_back(file);
    }
  }
  earlier.erase(tiles_name);
  for (const std::string& name : earlier) std::filesystem::remove(listing.output / name);
  write_manifest(manifest, listing.output / manifest_name);
  finish_output(listing.output);
}

}  // namespace voxweld
