// What voxweld itself has written: chunks of arrays, containers and what is in them.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <set>

#include "stages/build/cut_brick.h"
#include "storage/artifact/asset_record.h"
#include "storage/artifact/brick_ranges_artifact.h"
#include "storage/artifact/collapse_survey_artifact.h"
#include "storage/artifact/cube_mesh_artifact.h"
#include "storage/artifact/histogram_artifact.h"
#include "storage/artifact/label_counts.h"
#include "storage/artifact/material_top.h"
#include "storage/artifact/mesh_bin_artifact.h"
#include "storage/artifact/noise_artifact.h"
#include "storage/artifact/shard_artifact.h"
#include "storage/artifact/tile_artifact.h"
#include "storage/artifact/tile_plan_artifact.h"
#include "storage/artifact/tolerance_artifact.h"
#include "storage/artifact/top_artifact.h"
#include "storage/artifact/unfinished_note.h"
#include "storage/spool/spool_record.h"
#include "storage/store/codec.h"
#include "storage/store/shard_record.h"
#include "storage/support/error.h"
#include "tests/fuzz/coverage/entries.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;

// The first byte chooses the compressor, the next the checksums and the byte order; the rest is the
// encoded chunk.
void parse_chunk(const ParserEntry&, Bytes bytes) {
  if (bytes.size() < 2) return;
  constexpr CompressorKind kinds[] = {
      CompressorKind::blosc, CompressorKind::zstd,       CompressorKind::gzip, CompressorKind::bz2,
      CompressorKind::lz4,   CompressorKind::lz4_blocks, CompressorKind::xz};
  const auto kind = static_cast<std::size_t>(bytes[0]), form = static_cast<std::size_t>(bytes[1]);
  CodecChain chain;
  if (kind % 8 < std::size(kinds)) chain.compressor = Compressor{.kind = kinds[kind % 8]};
  chain.big_endian = (form & 1) != 0;
  chain.checksums_inside = (form & 2) != 0 ? 1 : 0;
  chain.checksums_outside = (form & 4) != 0 ? 1 : 0;
  std::vector<std::byte> samples(4096), scratch;
  const Bytes encoded = bytes.subspan(2);
  const ChunkForm chunk{samples.size(), 2};
  if (encoded.size() > largest_encoded_chunk(chain, chunk)) return;
  if (const std::string wrong = decode_chunk(chain, chunk, encoded, samples, scratch);
      !wrong.empty())
    throw FormatError(wrong);
}

void read_shard(const fs::path& path) {
  const ShardArtifact shard(path);
  shard.summary();
  shard.each_piece([](const PieceRecord&) {});
  const ArtifactReader file(path, shard_kind, shard_version);
  BrickOctree brick, cut;
  for (std::uint64_t code = 0; code < 64; ++code)
    each_piece_in(file, code, [&](const PieceHead& head) {
      read_octree(file, head, min_brick_level, brick);
      if (can_be_cut(brick)) BrickCutter().cut(brick, 0.5, cut);
    });
  for (std::uint64_t page = 0; page < std::min<std::uint64_t>(shard.node_pages(), 16); ++page)
    shard.each_node(page, [&](const MaterialNode& node, std::span<const std::byte>) {
      shard.clusters(node.material, node.node.key);
    });
}
void read_tables(const MaterialTop& labels) {
  labels.batches();
  labels.surfaces(0, std::min<std::uint64_t>(labels.surface_count(), 2000));
  labels.tiles(0, std::min<std::uint64_t>(labels.tile_count(), 2000));
  for (std::uint64_t i = 0; i < std::min<std::uint64_t>(labels.surface_count(), 16); ++i)
    labels.clusters(i);
}
void read_top(const fs::path& path) {
  const TopArtifact top(path);
  top.counts();
  top.shards();
  read_tables(MaterialTop(top));
}
void read_tile(const fs::path& path) {
  const TileArtifact tile(path);
  for (std::size_t i = 0; i < std::min<std::size_t>(tile.meshes(), 16); ++i) tile.read(i);
}
void read_counts(const fs::path& path) {
  LabelCounts(path).each([](const LabelCount&) { return true; });
}
void read_bins(const fs::path& path) {
  const MeshBins bins(path);
  for (std::uint64_t brick = 0; brick < bins.bricks().size(); ++brick)
    if (bins.bricks()[brick] == MeshSide::reached) bins.triangles(brick);
}
void read_cubes(const fs::path& path) {
  const CubeMeshArtifact cubes(path);
  for (std::size_t i = 0; i < std::min<std::size_t>(cubes.pieces().size(), 64); ++i) {
    for (const CubePart part : {CubePart::inside, CubePart::leaving}) {
      cubes.part_hash(i, part);
      cubes.read(i, part);
    }
    cubes.holes(i);
  }
  cubes.blocks();
  cubes.changes();
}
void read_tile_plan(const fs::path& path) {
  const TilePlanArtifact plan(path);
  plan.sources();
  const MaterialTop tables(plan.file());
  read_tables(tables);
  plan.middles(0, std::min<std::uint64_t>(tables.surface_count(), 2000));
}
// Records want their array's layout: one of the sizes of the specimens' stores.
void read_shard_of_store(const fs::path& path) {
  StoreLayout layout;
  layout.records = path.parent_path() / "records";
  const fs::path record = layout.record_path({});
  fs::create_directories(record.parent_path());
  std::error_code none;  // of a bundle of files that names none: the record is missing then
  fs::remove(record, none);
  fs::copy_file(path, record, none);
  for (const SampleType type : {SampleType::u8, SampleType::u16, SampleType::f32})
    for (const std::int64_t chunks : {1, 2, 4}) {
      layout.type = type;
      layout.parameters.shard = chunks * layout.parameters.chunk;
      try {
        read_shard_record(layout, {}).range();
        return;
      } catch (const DamagedArtifact&) {
        if (type == SampleType::f32 && chunks == 4) throw;
      }
    }
}

struct ArtifactParser {
  const char* kind;  // four characters
  std::uint32_t version;
  void (*read)(const fs::path&);
};
const ArtifactParser parsers[] = {
    {"cubm", cube_mesh_version, read_cubes},
    {"hist", histogram_version, [](const fs::path& path) { read_histogram_artifact(path); }},
    {"rang", brick_ranges_version, [](const fs::path& path) { read_brick_ranges(path); }},
    {"nois", noise_version, [](const fs::path& path) { read_noise_artifact(path); }},
    {"lcnt", label_counts_version, read_counts},
    {"mesh", mesh_record_version, [](const fs::path& path) { read_mesh_record(path); }},
    {"mbin", mesh_bins_version, read_bins},
    {"mtab", mesh_bins_version, [](const fs::path& path) { read_mesh_table(path); }},
    {"octr", shard_version, read_shard},
    {"shrd", shard_record_version, read_shard_of_store},
    {"tile", tile_version, read_tile},
    {"tops", top_version, read_top},
    {"tpln", tile_plan_version, read_tile_plan},
    {"srvy", collapse_survey_version, [](const fs::path& path) { read_collapse_survey(path); }},
    {"tolr", tolerance_version, [](const fs::path& path) { read_tolerance_artifact(path); }}};

const ArtifactParser* parser_of(Bytes kind) {
  for (const ArtifactParser& parser : parsers)
    if (kind.size() >= 4 && std::memcmp(kind.data(), parser.kind, 4) == 0) return &parser;
  return nullptr;
}

// A file as it lies there. Its kind says who reads it.
void parse_container(const ParserEntry& entry, Bytes bytes) {
  const fs::path path = write_case(bytes, entry.ending);
  if (const ArtifactParser* parser = bytes.size() < 12 ? nullptr : parser_of(bytes.subspan(8)))
    return parser->read(path);
  read_unfinished_head(path);
}

void parse_spool_record(const ParserEntry& entry, Bytes bytes) {
  const fs::path path = write_case(bytes, entry.ending + ".record");
  read_spool_record(path.parent_path() / fmt::format("v{}", entry.ending));
}
void parse_asset_record(const ParserEntry& entry, Bytes bytes) {
  read_asset_record(write_case(bytes, entry.ending));
}

template <class T>
T take(Bytes& bytes) {
  T value{};
  const std::size_t there = std::min(bytes.size(), sizeof value);
  std::memcpy(&value, bytes.data(), there);
  bytes = bytes.subspan(there);
  return value;
}

// What a file of ours may hold with all its checksums right: the kind, then of each section the name
// u64, the size u32, and so many bytes.
void parse_sections(const ParserEntry& entry, Bytes bytes) {
  const ArtifactParser* parser = parser_of(bytes);
  if (parser == nullptr) return;
  ArtifactStamp stamp;
  stamp.version = parser->version;
  std::memcpy(stamp.kind.data(), parser->kind, 4);
  const fs::path path = case_folder() / fmt::format("v{}", entry.ending);
  ArtifactWriter file(path, stamp);
  std::set<std::uint64_t> names;
  for (bytes = bytes.subspan(4); bytes.size() >= 12;) {
    const auto name = take<std::uint64_t>(bytes);
    std::size_t size = take<std::uint32_t>(bytes);
    size = std::min(size, bytes.size());
    if (names.insert(name).second) file.section(name, bytes.first(size));
    bytes = bytes.subspan(size);
  }
  file.commit();
  parser->read(path);
}

}  // namespace

std::vector<ParserEntry> store_entries() {
  return {{"chunk", ".chunk", "", "", parse_chunk},
          {"container", ".part", "", "", parse_container},
          {"sections", ".part", "", "", parse_sections},
          {"spool-record", ".spool", "", "", parse_spool_record},
          {"asset-record", ".asset", "", "", parse_asset_record}};
}

}  // namespace voxweld::testing
