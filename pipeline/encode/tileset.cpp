#include "pipeline/encode/tileset.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "stages/encode/glb.h"
#include "stages/refine/coarsen.h"
#include "storage/artifact/asset_record.h"
#include "storage/manifest/manifest.h"
#include "storage/support/json_text.h"

namespace voxweld {
namespace {

using Json = nlohmann::ordered_json;

// A nested file begins with a node that has more below it, of what is in no other nested file.
constexpr std::uint64_t few_tiles = 1000;

// A part of the tree, as it stands in its parent's list of children.
// NOLINTNEXTLINE(bugprone-exception-escape): to move a Json throws nothing
struct Part {
  Json json;
  std::optional<LatticeBox> box;  // nothing where it has no triangle
  double error = 0;
};

class TilesetWriter {
 public:
  explicit TilesetWriter(const TilesetInputs& inputs)
      : inputs_(inputs),
        tree_(inputs.levels.tree()),
        nested_(nested_tilesets(tree_)),
        matrix_(world_matrix(inputs.frame)) {
    for (std::size_t r = 0; r < 3; ++r) scale_ += matrix_[r] * matrix_[r];
    scale_ = std::sqrt(scale_);
  }

  std::vector<FileRecord> write() {
    std::vector<Part> roots;
    for (const std::uint64_t node : tree_.root_nodes()) keep(roots, of_node(node, ""));
    for (const std::uint64_t leaf : tree_.root_leaves()) keep(roots, of_leaf(leaf, ""));
    Json root;
    if (roots.size() == 1)
      root = std::move(roots.front().json);
    else  // as one more level would have it
      root = without_content(roots, in_metres(4 * inputs_.levels.largest_tolerance()));
    files_.insert(files_.begin(), put(tileset_name, root, diagonal_of(root)));
    return std::move(files_);
  }

 private:
  double in_metres(double steps) const { return steps * inputs_.lattice.step * scale_; }
  static void keep(std::vector<Part>& parts, Part part) {
    if (part.box) parts.push_back(std::move(part));
  }

  // Of a tile's box, in metres.
  static double diagonal_of(const Json& tile) {
    double sum = 0;
    const Json& numbers = tile.at("boundingVolume").at("box");
    for (std::size_t i = 3; i < numbers.size(); ++i)
      sum += numbers[i].get<double>() * numbers[i].get<double>();
    return 2 * std::sqrt(sum);
  }

  Json bounding_volume(const LatticeBox& box) const {
    std::array<double, 3> middle{}, half{};
    for (std::size_t a = 0; a < 3; ++a) {
      const int axis = static_cast<int>(a);
      const double lo = inputs_.lattice.coordinate(axis, box.lo[a]);
      const double hi = inputs_.lattice.coordinate(axis, box.hi[a]);
      middle[a] = (lo + hi) / 2;
      half[a] = (hi - lo) / 2;
    }
    Json numbers = Json::array();
    for (std::size_t r = 0; r < 3; ++r) {
      double at = matrix_[12 + r];
      for (std::size_t a = 0; a < 3; ++a) at += matrix_[4 * a + r] * middle[a];
      numbers.push_back(at + 0.0);
    }
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t r = 0; r < 3; ++r) numbers.push_back(matrix_[4 * a + r] * half[a] + 0.0);
    return {{"box", numbers}};
  }

  // up: from the file that it stands in to the output directory.
  static Part of_mesh(const TilesetMesh& mesh, const std::string& up) {
    Part part;
    part.box = mesh.box;
    if (mesh.file.empty()) return part;
    part.json["refine"] = "REPLACE";
    part.json["content"]["uri"] = up + mesh.file;
    return part;
  }
  void finish(Part& part) const {
    part.json["boundingVolume"] = bounding_volume(*part.box);
    part.json["geometricError"] = part.error;
  }

  Part of_leaf(std::uint64_t leaf, const std::string& up) const {
    Part part = of_mesh(inputs_.leaves[leaf], up);
    if (part.box) finish(part);
    return part;
  }

  Part of_node(std::uint64_t number, const std::string& up) {
    const LevelNode& node = tree_.nodes()[number];
    const bool nested = nested_[number];
    const std::string below = nested ? "../../" : up;
    Part part = of_mesh(inputs_.nodes[number], below);
    part.error = in_metres(inputs_.errors[number].p99);
    Json children = Json::array();
    const auto add = [&](Part child) {
      if (!child.box) return;
      if (part.box)
        part.box->extend(*child.box);
      else
        part.box = child.box;
      part.error = std::max(part.error, child.error);
      children.push_back(std::move(child.json));
    };
    for (const std::uint64_t child : node.nodes) add(of_node(child, below));
    for (const std::uint64_t child : node.leaves) add(of_leaf(child, below));
    if (!part.box) return part;
    finish(part);
    part.json["children"] = std::move(children);
    if (!nested) return part;
    const std::string name = tileset_name_of(node);
    files_.push_back(put(name, part.json, part.error));
    Part link{{{"refine", "REPLACE"}, {"content", {{"uri", up + name}}}}, part.box, part.error};
    finish(link);
    return link;
  }

  Json without_content(std::vector<Part>& parts, double error) const {
    Part all;
    Json children = Json::array();
    for (Part& part : parts) {
      if (!all.box) all.box = part.box;
      all.box->extend(*part.box);
      all.error = std::max({all.error, part.error, error});
      children.push_back(std::move(part.json));
    }
    if (!all.box) all.box.emplace();
    all.json["refine"] = "REPLACE";
    finish(all);
    all.json["children"] = std::move(children);
    return std::move(all.json);
  }

  FileRecord put(const std::string& name, const Json& root, double error) const {
    Json asset = {{"version", "1.1"}, {"generator", "voxweld " VOXWELD_VERSION}};
    if (name == tileset_name)
      asset["extras"] = {{"made_from", inputs_.source},
                         {"coordinates", "local, in metres"},
                         {"manifest", manifest_name}};
    const Json document = {
        {"asset", std::move(asset)},
        {"geometricError", std::max(error, root.at("geometricError").get<double>())},
        {"root", root}};
    AssetFile file(inputs_.output, name);
    const std::string text = json_text(document) + "\n";
    file.append(as_bytes(text));
    FileRecord record = file.finish("3dtiles");
    record.role = "tileset";
    return record;
  }

  const TilesetInputs& inputs_;
  const LevelTree& tree_;
  const std::vector<bool> nested_;
  const std::array<double, 16> matrix_;
  double scale_ = 0;  // metres in a unit of the files
  std::vector<FileRecord> files_;
};

}  // namespace

std::string tileset_name_of(const LevelNode& node) {
  return level_stem(node) + ".json";
}

std::vector<bool> nested_tilesets(const LevelTree& tree) {
  const auto& nodes = tree.nodes();
  std::vector<bool> nested(nodes.size());
  std::vector<std::uint64_t> tiles(
      nodes.size());  // in the file that it stands in, below it and itself
  for (std::uint64_t n = 0; n < nodes.size(); ++n) {
    tiles[n] = 1 + nodes[n].leaves.size();
    for (const std::uint64_t child : nodes[n].nodes) tiles[n] += nested[child] ? 1 : tiles[child];
    nested[n] = tiles[n] > few_tiles && nodes[n].height < tree.top();
  }
  return nested;
}

std::vector<FileRecord> write_tileset(const TilesetInputs& inputs) {
  return TilesetWriter(inputs).write();
}

}  // namespace voxweld
