#include "pipeline/output/verify_tiles.h"

#include <fmt/format.h>

#include "pipeline/output/seam_check.h"
#include "storage/support/error.h"
#include "storage/support/file_io.h"
#include "storage/support/hash.h"
#include "storage/support/hash_file.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

void compare(const FileRecord& record, std::uint64_t bytes, Hash128 found, Problems& problems) {
  if (bytes != record.bytes)
    problems.push_back({record.path, fmt::format("has {} bytes, {} are listed: write it again",
                                                 bytes, record.bytes)});
  else if (const std::string hash = to_hex(found); hash != record.xxh3_128)
    problems.push_back({record.path, fmt::format("damaged: its hash is {}, {} is listed: write it "
                                                 "again",
                                                 hash, record.xxh3_128)});
}

std::optional<LatticeMesh> decoded(const FormatFile& file, const OutputLattice& lattice,
                                   Problems& problems) {
  if (file.bytes.empty()) return std::nullopt;
  try {
    return weld(file.format->read(file.bytes, file.path), lattice, file.path);
  } catch (const Error& e) {
    problems.push_back({file.path, e.what()});
    return std::nullopt;
  }
}

void expect(TileResult& result, const char* what, std::uint64_t found, std::uint64_t listed) {
  if (found != listed)
    result.problems.push_back(
        {record_name(result.record), fmt::format("has {} {}, {} are listed", found, what, listed)});
}

void check_listing(TileResult& result) {
  const TileRecord& r = result.record;
  expect(result, "triangles by its quads and polygon triangles", 2 * r.quads + r.polygon_triangles,
         r.triangles);
}

}  // namespace

std::vector<std::byte> checked_file(const fs::path& directory, const FileRecord& record,
                                    Problems& problems) {
  std::vector<std::byte> bytes;
  try {
    bytes = read_whole_file(directory / record.path);
  } catch (const Error& e) {
    problems.push_back({record.path, e.what()});
    return bytes;
  }
  compare(record, bytes.size(), hash_bytes(bytes), problems);
  return bytes;
}

void check_file(const fs::path& directory, const FileRecord& record, Problems& problems) {
  try {
    const ReadFile file(directory / record.path);
    compare(record, file.size(), hash_file(file), problems);
  } catch (const Error& e) {
    problems.push_back({record.path, e.what()});
  }
}

std::optional<LatticeMesh> decode(const std::vector<FormatFile>& files,
                                  const OutputLattice& lattice, Problems& problems) {
  std::optional<LatticeMesh> mesh;
  std::string of;
  for (const FormatFile& file : files) {
    auto other = decoded(file, lattice, problems);
    if (!other) continue;
    if (!mesh) {
      mesh = std::move(other);
      of = file.path;
    } else if (digest(*other) != digest(*mesh)) {
      problems.push_back({file.path, "its triangles differ from those of " + of});
    }
  }
  return mesh;
}

std::string record_name(const TileRecord& record) {
  std::string tile = tile_name(record.tile);
  if (record.lod > 0) tile = fmt::format("level {} {}", record.lod, tile);
  return record.label ? fmt::format("label {} {}", *record.label, tile) : tile;
}

TileResult TileReader::check(TileRecord record, const TileChecks& checks) const {
  TileResult result;
  result.record = std::move(record);
  std::optional<LatticeMesh> mesh = read(result);
  check_listing(result);
  if (!mesh) return result;
  check_mesh(*mesh, checks, result);
  if (checks.intersections)
    result.intersections = intersections_within(*mesh, result.record.tile, frame_);
  return result;
}

LatticeMesh TileReader::mesh_again(const TileRecord& record) const {
  TileResult result;
  result.record = record;
  std::optional<LatticeMesh> mesh = read(result);
  if (!mesh) return {};
  drop_degenerate(*mesh);
  return std::move(*mesh);
}

Problems TileReader::use_of(const TileRecord& record,
                            const std::vector<LatticePoint>& points) const {
  const LatticeMesh mesh = mesh_again(record);
  Problems problems;
  PointIndex index;
  for (const LatticePoint& q : mesh.positions) index.add(q);
  for (const LatticePoint& q : points) {
    if (index.find(q) == PointIndex::none) continue;
    const Vec3 p = frame_.position(q);
    problems.push_back(
        {fmt::format("{} at ({}, {}, {})", record_name(record), p.x, p.y, p.z),
         "not 2-manifold: this vertex is surrounded in its tile and used by another one too"});
  }
  return problems;
}

std::optional<LatticeMesh> TileReader::read(TileResult& result) const {
  std::vector<FormatFile> files;
  for (const FileRecord& file : result.record.files) {
    auto bytes = checked_file(directory_, file, result.problems);
    ++result.files;
    result.bytes += bytes.size();
    const MeshWriter* format = writer_named(formats_, file.format);
    if (format != nullptr) files.push_back({format, file.path, std::move(bytes)});
  }
  if (files.empty())
    result.problems.push_back({record_name(result.record),
                               "lists no file of a known format: its mesh cannot be checked"});
  return decode(files, manifest_.lattice, result.problems);
}

void TileReader::check_mesh(LatticeMesh& mesh, const TileChecks& checks, TileResult& result) const {
  if (checks.vertices_listed)
    expect(result, "vertices", mesh.positions.size(), result.record.vertices);
  expect(result, "triangles", mesh.triangles.size(), result.record.triangles);
  result.triangles = digest(mesh);
  if (result.record.label) result.measure = measure(mesh.positions, mesh.triangles);
  const std::uint64_t degenerate = drop_degenerate(mesh);
  if (degenerate > 0)
    result.problems.push_back({record_name(result.record),
                               fmt::format("has {} triangles with two equal corners", degenerate)});
  if (checks.by_label && result.record.label)
    mesh.pairs.assign(mesh.triangles.size(), {*result.record.label, exterior});
  const bool shared = manifest_.labels == LabelMode::shared || checks.by_label;
  if (shared && mesh.pairs.empty() && !mesh.triangles.empty())
    result.problems.push_back(
        {record_name(result.record), "does not say which labels its triangles separate"});
  result.seams = shared && !mesh.pairs.empty() ? find_label_seams(mesh, result.record.tile, frame_)
                                               : find_seams(mesh, result.record.tile, frame_);
}

}  // namespace voxweld
