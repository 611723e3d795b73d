#include "stages/encode/draco_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <memory>
#include <string_view>
#include <unordered_map>

#include "stages/encode/corner_points.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

using Triangle = std::array<std::uint32_t, 3>;
constexpr std::uint32_t no_value = std::numeric_limits<std::uint32_t>::max();

// Of the generic attribute that says which labels a triangle separates: each value is a place in
// the list "inside,outside;..." of its metadata, where "-" is outside all labels.
constexpr const char* pairs_entry = "voxweld_label_pairs";

int add_float_attribute(draco::Mesh& out, draco::GeometryAttribute::Type type, bool identity,
                        std::size_t values) {
  draco::GeometryAttribute attribute;
  attribute.Init(type, nullptr, 3, draco::DT_FLOAT32, false, 3 * sizeof(float), 0);
  return out.AddAttribute(attribute, identity, static_cast<std::uint32_t>(values));
}

void set_value(draco::PointAttribute& attribute, std::size_t at, const std::array<float, 3>& p) {
  attribute.SetAttributeValue(draco::AttributeValueIndex(static_cast<std::uint32_t>(at)), p.data());
}

void set_face(draco::Mesh& out, std::size_t at, const Triangle& t) {
  out.SetFace(draco::FaceIndex(static_cast<std::uint32_t>(at)),
              {draco::PointIndex(t[0]), draco::PointIndex(t[1]), draco::PointIndex(t[2])});
}

void set_normal(draco::PointAttribute& attribute, std::size_t at, const Vec3& n) {
  set_value(attribute, at,
            {static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z)});
}

int add_positions(draco::Mesh& out, const TileMesh& mesh, bool identity) {
  const int id =
      add_float_attribute(out, draco::GeometryAttribute::POSITION, identity, mesh.positions.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    set_value(*out.attribute(id), v, float_position(mesh.lattice, mesh.positions[v]));
  return id;
}

// Points are vertices: without normals nothing tells two corners of a vertex apart.
int fill_plain(draco::Mesh& out, const TileMesh& mesh) {
  out.set_num_points(static_cast<std::uint32_t>(mesh.positions.size()));
  const int id = add_positions(out, mesh, true);
  out.SetNumFaces(mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) set_face(out, i, mesh.triangles[i]);
  return id;
}

DracoAttributes fill_with_normals(draco::Mesh& out, const TileMesh& mesh) {
  const CornerPoints points(mesh);
  out.set_num_points(points.count());
  DracoAttributes ids;
  ids.position = add_positions(out, mesh, false);
  ids.normal = add_float_attribute(out, draco::GeometryAttribute::NORMAL, true, points.count());
  draco::PointAttribute& position = *out.attribute(ids.position);
  draco::PointAttribute& normal = *out.attribute(ids.normal);
  points.each([&](std::uint32_t point, std::uint32_t vertex, CornerNormal of_corner) {
    position.SetPointMapEntry(draco::PointIndex(point), draco::AttributeValueIndex(vertex));
    set_normal(normal, point, of_corner.of(mesh.normals[vertex]));
  });
  out.SetNumFaces(mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    Triangle corner;
    for (std::size_t k = 0; k < 3; ++k)
      corner[k] = points.of(mesh.triangles[i][k], mesh.corner_normals[i][k]);
    set_face(out, i, corner);
  }
  return ids;
}

// One point for each vertex, normal and pair that corners have together, numbered by first use.
class LabelPoints {
 public:
  struct Point {
    std::uint32_t vertex, pair;
    CornerNormal normal;
  };
  LabelPoints(const TileMesh& mesh, bool normals) : corners_(mesh.triangles.size()) {
    const std::uint64_t pairs = mesh.pairs.size();
    std::unordered_map<std::uint64_t, std::uint32_t> known;
    known.reserve(mesh.positions.size() * 2);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t vertex = mesh.triangles[i][k], pair = mesh.triangle_pairs[i];
        const CornerNormal normal = normals ? mesh.corner_normals[i][k] : CornerNormal{};
        const auto [at, is_new] = known.try_emplace(
            (vertex * std::uint64_t{CornerNormal::values} + normal.bits) * pairs + pair,
            static_cast<std::uint32_t>(points_.size()));
        if (is_new) points_.push_back({vertex, pair, normal});
        corners_[i][k] = at->second;
      }
  }
  const std::vector<Point>& points() const { return points_; }
  const std::vector<Triangle>& corners() const { return corners_; }

 private:
  std::vector<Point> points_;
  std::vector<Triangle> corners_;
};

std::string pairs_text(const std::vector<MaterialPair>& pairs) {
  std::string text;
  const auto name = [](Material m) { return m == exterior ? "-" : fmt::to_string(m); };
  for (const MaterialPair& pair : pairs) text += name(pair.inside) + "," + name(pair.outside) + ";";
  return text;
}

int add_pairs(draco::Mesh& out, const TileMesh& mesh) {
  draco::GeometryAttribute attribute;
  attribute.Init(draco::GeometryAttribute::GENERIC, nullptr, 1, draco::DT_UINT32, false,
                 sizeof(std::uint32_t), 0);
  const int id = out.AddAttribute(attribute, false, static_cast<std::uint32_t>(mesh.pairs.size()));
  for (std::uint32_t i = 0; i < mesh.pairs.size(); ++i)
    out.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i), &i);
  auto metadata = std::make_unique<draco::AttributeMetadata>();
  metadata->AddEntryString(pairs_entry, pairs_text(mesh.pairs));
  out.AddAttributeMetadata(id, std::move(metadata));
  return id;
}

DracoAttributes fill_with_pairs(draco::Mesh& out, const TileMesh& mesh, bool normals) {
  const LabelPoints points(mesh, normals);
  const auto count = static_cast<std::uint32_t>(points.points().size());
  out.set_num_points(count);
  DracoAttributes ids;
  ids.position = add_positions(out, mesh, false);
  if (normals) ids.normal = add_float_attribute(out, draco::GeometryAttribute::NORMAL, true, count);
  ids.pair = add_pairs(out, mesh);
  for (std::uint32_t i = 0; i < count; ++i) {
    const LabelPoints::Point& point = points.points()[i];
    const draco::PointIndex at(i);
    out.attribute(ids.position)->SetPointMapEntry(at, draco::AttributeValueIndex(point.vertex));
    out.attribute(ids.pair)->SetPointMapEntry(at, draco::AttributeValueIndex(point.pair));
    if (!normals) continue;
    set_normal(*out.attribute(ids.normal), i, point.normal.of(mesh.normals[point.vertex]));
  }
  out.SetNumFaces(mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) set_face(out, i, points.corners()[i]);
  return ids;
}

class PairsText {
 public:
  PairsText(std::string_view text, const std::string& where) : text_(text), where_(where) {}
  std::vector<MaterialPair> parse() {
    std::vector<MaterialPair> pairs;
    while (!text_.empty()) {
      const Material inside = material(',');
      pairs.push_back({inside, material(';')});
    }
    return pairs;
  }

 private:
  Material material(char end) {
    Material value = exterior;
    const char *first = text_.data(), *last = first + text_.size();
    if (text_.starts_with('-')) {
      ++first;
    } else {
      const auto [at, error] = std::from_chars(first, last, value);
      if (error != std::errc()) damaged();
      first = at;
    }
    if (first == last || *first != end) damaged();
    text_.remove_prefix(static_cast<std::size_t>(first + 1 - text_.data()));
    return value;
  }
  [[noreturn]] void damaged() const {
    throw FormatError(where_ + ": damaged Draco data: its list of label pairs does not parse");
  }
  std::string_view text_;
  const std::string& where_;
};

}  // namespace

DracoAttributes fill_draco_mesh(const TileMesh& mesh, bool normals, draco::Mesh& out) {
  if (!mesh.pairs.empty()) return fill_with_pairs(out, mesh, normals);
  if (normals) return fill_with_normals(out, mesh);
  DracoAttributes ids;
  ids.position = fill_plain(out, mesh);
  return ids;
}

void read_pairs(const draco::Mesh& mesh, DecodedMesh& out, const std::string& where) {
  const draco::PointAttribute* attribute = nullptr;
  std::string text;
  for (std::int32_t i = 0; i < mesh.num_attributes() && attribute == nullptr; ++i) {
    const draco::AttributeMetadata* metadata = mesh.GetAttributeMetadataByAttributeId(i);
    if (metadata != nullptr && metadata->GetEntryString(pairs_entry, &text))
      attribute = mesh.attribute(i);
  }
  if (attribute == nullptr) return;
  const auto damaged = [&](const char* what) {
    throw FormatError(where + ": damaged Draco data: " + what);
  };
  if (attribute->num_components() != 1 || attribute->data_type() != draco::DT_UINT32)
    damaged("its label pairs are not numbers");
  out.pair_id = static_cast<int>(attribute->unique_id());
  out.pairs = PairsText(text, where).parse();
  out.triangle_pairs.resize(mesh.num_faces());
  const auto pair_of = [&](draco::PointIndex point) {
    std::uint32_t value = no_value;
    const draco::AttributeValueIndex at = attribute->mapped_index(point);
    if (at.value() < attribute->size()) attribute->GetValue(at, &value);
    if (value >= out.pairs.size()) damaged("a triangle names a label pair that is not there");
    return value;
  };
  for (std::uint32_t i = 0; i < mesh.num_faces(); ++i) {
    const draco::Mesh::Face& face = mesh.face(draco::FaceIndex(i));
    out.triangle_pairs[i] = pair_of(face[0]);
    if (pair_of(face[1]) != out.triangle_pairs[i] || pair_of(face[2]) != out.triangle_pairs[i])
      damaged("the corners of a triangle name different label pairs");
  }
}

}  // namespace voxweld
