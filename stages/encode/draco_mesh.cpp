#include "stages/encode/draco_mesh.h"

#include <draco/compression/decode.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <memory>
#include <string_view>

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

// Measured at 512^3: one connectivity for both takes 15 % less time to encode and 28 % less to decode. With
// 1.2 % more points than vertices (gyroid) the bytes are 0.7 % more, with 6.9 % (porous) 4 %, with 31 %
// (part) 16 %.
bool has_few_seams(std::uint64_t vertices, std::uint64_t points) {
  return points <= vertices + vertices / 12;
}

DracoAttributes fill_with_normals(draco::Mesh& out, const TileMesh& mesh) {
  const CornerPoints points(mesh);
  out.set_num_points(points.count());
  DracoAttributes ids;
  ids.one_normal_each = has_few_seams(mesh.positions.size(), points.count());
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

std::string pairs_text(const std::vector<MaterialPair>& pairs) {
  std::string text;
  const auto name = [](Material m) { return m == exterior ? "-" : fmt::to_string(m); };
  for (const MaterialPair& pair : pairs) text += name(pair.inside) + "," + name(pair.outside) + ";";
  return text;
}

// As .drc has it: numbers of 32 bits, with the list.
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

template <class T>
int add_feature_ids(draco::Mesh& out, std::size_t pairs, draco::DataType type) {
  draco::GeometryAttribute attribute;
  attribute.Init(draco::GeometryAttribute::GENERIC, nullptr, 1, type, false, sizeof(T), 0);
  const int id = out.AddAttribute(attribute, false, static_cast<std::uint32_t>(pairs));
  for (std::uint32_t i = 0; i < pairs; ++i) {
    const auto value = static_cast<T>(i);
    out.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i), &value);
  }
  return id;
}

int add_feature_ids(draco::Mesh& out, std::size_t pairs) {
  switch (feature_id_type(pairs)) {
    case FeatureIdType::u8:
      return add_feature_ids<std::uint8_t>(out, pairs, draco::DT_UINT8);
    case FeatureIdType::u16:
      return add_feature_ids<std::uint16_t>(out, pairs, draco::DT_UINT16);
    default:
      return add_feature_ids<float>(out, pairs, draco::DT_FLOAT32);
  }
}

int add_colours(draco::Mesh& out, const std::vector<PairColour>& colours) {
  draco::GeometryAttribute attribute;
  attribute.Init(draco::GeometryAttribute::COLOR, nullptr, 4, draco::DT_UINT8, true,
                 sizeof(PairColour), 0);
  const int id = out.AddAttribute(attribute, false, static_cast<std::uint32_t>(colours.size()));
  for (std::uint32_t i = 0; i < colours.size(); ++i)
    out.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i), colours[i].data());
  return id;
}

// Sets each point's place in the values of an attribute.
template <class Place>
void map_points(draco::PointAttribute& attribute, const PairPoints& points, Place place) {
  for (std::uint32_t i = 0; i < points.points().size(); ++i)
    attribute.SetPointMapEntry(draco::PointIndex(i),
                               draco::AttributeValueIndex(place(points.points()[i])));
}

DracoAttributes fill_with_pairs(draco::Mesh& out, const TileMesh& mesh, bool normals,
                                const std::vector<PairColour>* colours) {
  const PairPoints points(mesh, normals);
  const auto count = static_cast<std::uint32_t>(points.points().size());
  const auto pair_of = [](const PairPoints::Point& point) { return point.pair; };
  out.set_num_points(count);
  DracoAttributes ids;
  ids.position = add_positions(out, mesh, false);
  map_points(*out.attribute(ids.position), points,
             [](const PairPoints::Point& point) { return point.vertex; });
  if (normals) {
    ids.normal = add_float_attribute(out, draco::GeometryAttribute::NORMAL, true, count);
    for (std::uint32_t i = 0; i < count; ++i) {
      const PairPoints::Point& point = points.points()[i];
      set_normal(*out.attribute(ids.normal), i, point.normal.of(mesh.normals[point.vertex]));
    }
  }
  ids.pair = colours == nullptr ? add_pairs(out, mesh) : add_feature_ids(out, mesh.pairs.size());
  map_points(*out.attribute(ids.pair), points, pair_of);
  if (colours != nullptr) {
    ids.colour = add_colours(out, *colours);
    map_points(*out.attribute(ids.colour), points, pair_of);
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

std::unique_ptr<draco::Mesh> decode_draco_mesh(std::span<const std::byte> bytes,
                                               const std::string& where) {
  check_draco_header(bytes, where);
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  draco::Decoder decoder;
  try {
    auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok())
      throw FormatError(fmt::format("{}: damaged Draco data of {} bytes: {}", where, bytes.size(),
                                    decoded.status().error_msg_string()));
    return std::move(decoded).value();
  } catch (const std::bad_alloc&) {
  } catch (const std::length_error&) {
  }
  throw FormatError(
      fmt::format("{}: damaged Draco data of {} bytes: it states sizes that memory cannot hold",
                  where, bytes.size()));
}

std::vector<std::byte> copy_bytes(const draco::EncoderBuffer& buffer) {
  const auto bytes = std::as_bytes(std::span(buffer.data(), buffer.size()));
  return {bytes.begin(), bytes.end()};
}

DracoAttributes fill_draco_mesh(const TileMesh& mesh, bool normals,
                                const std::vector<PairColour>* colours, draco::Mesh& out) {
  if (!mesh.pairs.empty()) return fill_with_pairs(out, mesh, normals, colours);
  if (normals) return fill_with_normals(out, mesh);
  DracoAttributes ids;
  ids.position = fill_plain(out, mesh);
  return ids;
}

void read_pairs(const draco::Mesh& mesh, const PairList* features, DecodedMesh& out,
                const std::string& where) {
  const draco::PointAttribute* attribute = nullptr;
  std::string text;
  if (features != nullptr && features->id >= 0)
    attribute = mesh.GetAttributeByUniqueId(static_cast<std::uint32_t>(features->id));
  for (std::int32_t i = 0; features == nullptr && i < mesh.num_attributes(); ++i) {
    const draco::AttributeMetadata* metadata = mesh.GetAttributeMetadataByAttributeId(i);
    if (attribute == nullptr && metadata != nullptr && metadata->GetEntryString(pairs_entry, &text))
      attribute = mesh.attribute(i);
  }
  const auto damaged = [&](const char* what) {
    throw FormatError(where + ": damaged Draco data: " + what);
  };
  if (attribute == nullptr) {
    if (features != nullptr) damaged("the attribute of its feature ids is not there");
    return;
  }
  if (attribute->num_components() != 1) damaged("its label pairs are not numbers");
  out.pair_id = static_cast<int>(attribute->unique_id());
  out.pairs = features != nullptr ? features->pairs : PairsText(text, where).parse();
  out.triangle_pairs.resize(mesh.num_faces());
  const auto pair_of = [&](draco::PointIndex point) {
    std::uint32_t value = no_value;
    const draco::AttributeValueIndex at = attribute->mapped_index(point);
    if (at.value() >= attribute->size() || !attribute->ConvertValue(at, 1, &value) ||
        value >= out.pairs.size())
      damaged("a triangle names a label pair that is not there");
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
