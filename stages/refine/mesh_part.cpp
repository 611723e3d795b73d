#include "stages/refine/mesh_part.h"

#include <algorithm>
#include <map>
#include <utility>

#include "stages/exact/box_tree.h"
#include "stages/refine/vertex_cubes.h"

namespace voxweld {
namespace {

constexpr std::uint32_t no_number = 0xffffffffu;
constexpr std::uint64_t vertex_bytes = 12 + 8 + 12 + 12, triangle_bytes = 12;
constexpr std::uint64_t sides_bytes = sizeof(MaterialPair);

// Copies what hangs on triangle t, which is `as` in the other mesh, the last one there.
void copy_notes(const RefineMesh& from, SampleReader& samples, std::uint32_t t, RefineMesh& to,
                std::uint32_t as) {
  samples.each(t, [&](const SurfaceSample& s) { to.samples.push_back({s.point, as}); });
  if (!from.sides.empty()) to.sides.push_back(from.sides[t]);
}

std::uint32_t append_vertex(const RefineMesh& from, std::uint32_t v, RefineMesh& to) {
  to.positions.push_back(from.positions[v]);
  to.ids.push_back(from.ids[v]);
  if (!from.aims.empty()) to.aims.push_back(from.aims[v]);
  if (!from.normals.empty()) to.normals.push_back(from.normals[v]);
  return static_cast<std::uint32_t>(to.positions.size() - 1);
}

}  // namespace

Extract::Extract(const RefineMesh& from) : from_(from), number_(from.positions.size(), no_number) {}

RefineMesh Extract::of(std::span<const std::uint32_t> chosen) {
  RefineMesh part;
  part.checked = from_.checked;
  std::vector<std::uint32_t> used;
  part.triangles.reserve(chosen.size());
  used.reserve(chosen.size());
  SampleReader samples(from_);
  for (const std::uint32_t t : chosen) {
    const auto as = static_cast<std::uint32_t>(part.triangles.size());
    copy_notes(from_, samples, t, part, as);
    if (from_.intersects(t)) part.intersecting.push_back(as);
    auto triangle = from_.triangles[t];
    for (std::uint32_t& v : triangle) v = number(v, part, used);
    part.triangles.push_back(triangle);
  }
  for (const std::uint32_t v : used) number_[v] = no_number;
  return part;
}

std::uint32_t Extract::number(std::uint32_t v, RefineMesh& part, std::vector<std::uint32_t>& used) {
  if (number_[v] == no_number) {
    number_[v] = append_vertex(from_, v, part);
    used.push_back(v);
  }
  return number_[v];
}

void MeshGather::add(const RefineMesh& part, const std::function<bool(std::size_t)>& takes) {
  std::vector<std::uint32_t> triangles;
  for (std::uint32_t t = 0; t < part.triangles.size(); ++t)
    if (takes(t)) triangles.push_back(t);
  add(part, triangles);
}

void MeshGather::add(const RefineMesh& part, const std::vector<std::uint32_t>& triangles) {
  if (triangles.empty()) return;
  begin(part);
  Part from(part);
  for (const std::uint32_t t : triangles) add_triangle(from, t, part.intersects(t));
}

void MeshGather::add(const RefineMesh& part) {
  add_all(part, true);
}

void MeshGather::add_last(const RefineMesh& part) {
  add_all(part, false);
}

void MeshGather::add_all(const RefineMesh& part, bool keeps) {
  if (part.triangles.empty()) return;
  begin(part);
  const auto first = static_cast<std::uint32_t>(mesh_.triangles.size());
  Part from(part);
  for (const auto& corners : part.triangles) add_corners(from, corners, keeps);
  mesh_.sides.insert(mesh_.sides.end(), part.sides.begin(), part.sides.end());
  for (const SurfaceSample& sample : part.samples)
    mesh_.samples.push_back({sample.point, first + sample.triangle});
  for (const std::uint32_t t : part.intersecting) mesh_.intersecting.push_back(first + t);
}

void MeshGather::begin(const RefineMesh& part) {
  mesh_.checked = part.checked && (mesh_.checked || mesh_.triangles.empty());
}

void MeshGather::add_triangle(const RefineMesh& part, std::uint32_t triangle, bool intersects) {
  SampleReader samples(part);
  const auto as = static_cast<std::uint32_t>(mesh_.triangles.size());
  copy_notes(part, samples, triangle, mesh_, as);
  if (intersects) mesh_.intersecting.push_back(as);
  auto corners = part.triangles[triangle];
  for (std::uint32_t& v : corners) v = number(part, v);
  mesh_.triangles.push_back(corners);
}

void MeshGather::add_triangle(Part& part, std::uint32_t triangle, bool intersects) {
  const auto as = static_cast<std::uint32_t>(mesh_.triangles.size());
  copy_notes(part.mesh(), part.samples_, triangle, mesh_, as);
  if (intersects) mesh_.intersecting.push_back(as);
  add_corners(part, part.mesh().triangles[triangle]);
}

void MeshGather::add_corners(Part& part, std::array<std::uint32_t, 3> corners, bool keeps) {
  for (std::uint32_t& v : corners) {
    std::uint32_t& known = part.numbers_[v];
    if (known == VertexTable::none) known = number(part.mesh(), v, keeps);
    v = known;
  }
  mesh_.triangles.push_back(corners);
}

std::uint32_t MeshGather::number(const RefineMesh& part, std::uint32_t v, bool keeps) {
  const VertexId id = part.ids[v];
  const std::uint64_t hash = mix_bits(id.bits);
  const std::uint32_t known =
      numbers_.find(hash, [&](std::uint32_t other) { return mesh_.ids[other] == id; });
  if (known != VertexTable::none) return known;
  const std::uint32_t number = append_vertex(part, v, mesh_);
  if (keeps) numbers_.insert(hash, number);
  return number;
}

RefineMesh MeshGather::take() {
  numbers_.clear();
  return std::exchange(mesh_, {});
}

void MeshGather::reserve(std::uint64_t vertices, std::uint64_t triangles, std::uint64_t samples,
                         std::uint64_t sided, std::optional<std::uint64_t> shared) {
  mesh_.positions.reserve(vertices);
  mesh_.ids.reserve(vertices);
  mesh_.aims.reserve(vertices);
  mesh_.normals.reserve(vertices);
  mesh_.triangles.reserve(triangles);
  mesh_.sides.reserve(sided);
  mesh_.samples.reserve(samples);
  numbers_.reserve(std::min(shared.value_or(vertices), vertices));
}

void remove_inside(RefineMesh& mesh, const std::vector<LatticeBox>& boxes) {
  const BoxTree tree(boxes);
  const auto& positions = mesh.positions;
  std::vector<std::uint32_t> box_of(positions.size(), no_number);
  constexpr std::size_t run = 16;  // vertices that follow each other mostly lie close
  for (std::size_t first = 0; first < box_of.size(); first += run) {
    const std::size_t end = std::min(first + run, box_of.size());
    LatticeBox around{positions[first], positions[first]};
    for (std::size_t v = first + 1; v < end; ++v) around.extend({positions[v], positions[v]});
    if (!tree.any_meeting(around, [](std::uint32_t) { return true; })) continue;
    for (std::size_t v = first; v < end; ++v)
      tree.any_meeting({positions[v], positions[v]}, [&](std::uint32_t box) {
        box_of[v] = box;
        return true;
      });
  }
  std::vector<std::uint32_t> number(mesh.triangles.size(), no_number);
  std::uint32_t left = 0;
  for (std::size_t t = 0; t < number.size(); ++t) {
    const auto [a, b, c] = mesh.triangles[t];
    if (box_of[a] != no_number && box_of[a] == box_of[b] && box_of[a] == box_of[c]) continue;
    if (!mesh.sides.empty()) mesh.sides[left] = mesh.sides[t];
    mesh.triangles[left] = {a, b, c};
    number[t] = left++;
  }
  mesh.triangles.resize(left);
  if (!mesh.sides.empty()) mesh.sides.resize(left);
  std::erase_if(mesh.samples, [&](SurfaceSample& sample) {
    return (sample.triangle = number[sample.triangle]) == no_number;
  });
  std::erase_if(mesh.intersecting, [&](std::uint32_t& t) { return (t = number[t]) == no_number; });
}

std::uint64_t mesh_bytes(std::uint64_t vertices, std::uint64_t triangles, std::uint64_t samples,
                         std::uint64_t sided) {
  return vertices * vertex_bytes + triangles * triangle_bytes + samples * sizeof(SurfaceSample) +
         sided * sides_bytes;
}

std::uint64_t gather_bytes(std::uint64_t vertices, std::uint64_t triangles, std::uint64_t samples,
                           std::uint64_t sided) {
  // The table takes 11 bytes a vertex at most.
  return mesh_bytes(vertices, triangles, samples, sided) + vertices * 11 + 64;
}

std::uint64_t piece_bytes(std::uint64_t vertices, std::uint64_t triangles, std::uint64_t sided) {
  // Lists of triangles, which have grown; numbers of vertices; one piece, at worst all there is.
  return triangles * (12 + 2 * triangle_bytes) + vertices * (10 + 2 * vertex_bytes) +
         2 * sided * sides_bytes;
}

void each_piece(const RefineMesh& mesh, const CubeLattice& cubes,
                const std::function<void(const CubePiece&)>& f) {
  struct Chosen {
    std::vector<std::uint32_t> inside, leaving;
  };
  std::map<std::pair<std::uint64_t, std::uint64_t>, Chosen> pieces;  // by code and cube
  {
    const VertexCubes places(mesh, cubes);
    Index3 home;
    Chosen* piece = nullptr;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      if (piece == nullptr ||
          places.home(t) != home) {  // triangles come in the order of some lattice
        home = places.home(t);
        piece = &pieces[{cubes.code(home), morton_encode(home)}];
      }
      (places.is_inside(t) ? piece->inside : piece->leaving).push_back(t);
    }
  }
  Extract extract(mesh);
  for (const auto& [place, chosen] : pieces)
    f({morton_decode(place.second), place.first, extract.of(chosen.inside),
       extract.of(chosen.leaving)});
}

}  // namespace voxweld
