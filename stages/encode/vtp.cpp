// Based on: Kitware, "VTK File Formats" (2021), section "XML File Formats".
#include "stages/encode/vtp.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <pugixml.hpp>
#include <string_view>

#include "stages/encode/stream_out.h"
#include "storage/support/byte_order.h"
#include "storage/support/error.h"
#include "storage/support/text_fields.h"

namespace voxweld {
namespace {

constexpr std::uint64_t most_int32 = std::numeric_limits<std::int32_t>::max();
constexpr std::uint64_t most_int64 = std::numeric_limits<std::int64_t>::max();

struct VtpType {
  std::string_view name;
  std::uint64_t bytes;
};
constexpr VtpType vtp_float{"Float32", 4}, vtp_int32{"Int32", 4}, vtp_int64{"Int64", 8};

// What the header has to say of the arrays, which come one after the other, each behind its size.
class VtpArrays {
 public:
  std::string element(const char* name, const VtpType& type, std::uint64_t items,
                      int components = 1) {
    std::string text = fmt::format(
        "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" "
        "offset=\"{}\"/>\n",
        type.name, name, components, at_);
    at_ += sizeof(std::uint64_t) + items * static_cast<std::uint64_t>(components) * type.bytes;
    return text;
  }

 private:
  std::uint64_t at_ = 0;
};

void put_integer(StreamOut& out, const VtpType& type, std::uint64_t value) {
  if (type.bytes == 4)
    out.put(static_cast<std::int32_t>(value));
  else
    out.put(static_cast<std::int64_t>(value));
}

// Types of the corners' numbers and of labels.
struct VtpTypes {
  VtpType corners, labels;
};
VtpTypes vtp_types(const StreamTotals& totals) {
  if (totals.highest_label > most_int64)
    throw InputError(fmt::format(
        "a .vtp file holds labels up to 2^63 - 1, the mesh has label {}: leave \"vtp\" out of "
        "output.formats",
        totals.highest_label));
  const bool few = totals.vertices <= most_int32 && 3 * totals.triangles <= most_int32;
  return {few ? vtp_int32 : vtp_int64,
          vtp_label_bits(totals.highest_label) == 32 ? vtp_int32 : vtp_int64};
}

void put_vtp_header(StreamOut& out, const StreamTotals& totals, const VtpTypes& types) {
  VtpArrays arrays;
  const std::uint64_t v = totals.vertices, t = totals.triangles;
  const std::string points = arrays.element("Points", vtp_float, v, 3);
  std::string of_points, of_cells;
  if (totals.between_labels)
    of_cells = "<CellData Scalars=\"label\">\n";
  else if (totals.normals)
    of_points = "<PointData Normals=\"Normals\">\n" + arrays.element("Normals", vtp_float, v, 3) +
                "</PointData>\n";
  // One after the other: each takes its place behind those before.
  std::string corners = arrays.element("connectivity", types.corners, 3 * t);
  corners += arrays.element("offsets", types.corners, t);
  if (totals.between_labels) {
    of_cells += arrays.element("label", types.labels, t);
    of_cells += arrays.element("label_outside", types.labels, t) + "</CellData>\n";
  }
  out.text(
      "<?xml version=\"1.0\"?>\n<!-- voxweld " VOXWELD_VERSION
      " -->\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n<PolyData>\n<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" "
      "NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"{}\">\n{}{}<Points>\n{}</Points>\n"
      "<Polys>\n{}</Polys>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_",
      v, t, of_points, of_cells, points, corners);
}

void put_points(StreamOut& out, const EachTile& each_tile, bool normals) {
  TileWelder welder;
  each_tile([&](const TileMesh& tile) {
    welder.add(tile);
    for (const std::uint32_t v : welder.fresh())
      out.put(normals ? mean_direction(tile.normals[v])
                      : float_position(tile.lattice, tile.positions[v]));
  });
}

void put_corners(StreamOut& out, const EachTile& each_tile, const VtpType& type) {
  TileWelder welder;
  each_tile([&](const TileMesh& tile) {
    welder.add(tile);
    for (const auto& t : tile.triangles)
      for (const std::uint32_t v : t) put_integer(out, type, welder.numbers()[v]);
  });
}

// `exterior` becomes -1.
void put_labels(StreamOut& out, const EachTile& each_tile, const VtpType& type,
                Material MaterialPair::*side) {
  each_tile([&](const TileMesh& tile) {
    for (const std::uint32_t pair : tile.triangle_pairs)
      put_integer(out, type, tile.pairs[pair].*side);
  });
}

constexpr std::uint64_t array_head = sizeof(std::uint64_t);  // in front of each: its bytes
constexpr std::size_t most_header = std::size_t{1} << 16;

// The head of a file, and where its arrays lie.
class VtpHeader {
 public:
  VtpHeader(const VtpSource& source, const std::string& where) : source_(source), where_(where) {
    std::string text(static_cast<std::size_t>(std::min<std::uint64_t>(source.size, most_header)),
                     ' ');
    source.read(0, std::as_writable_bytes(std::span(text)));
    const std::size_t end = std::min(text.find("<AppendedData encoding=\"raw\">"), text.size());
    const std::size_t mark = text.find('_', end);
    if (mark == std::string::npos) fail("not a .vtp file with appended raw data, or truncated");
    begin_ = mark + 1;
    const std::string markup = text.substr(0, end) + "</VTKFile>";
    if (const auto parsed = document_.load_buffer(markup.data(), markup.size()); !parsed)
      fail(fmt::format("damaged .vtp file: its XML does not parse: {}", parsed.description()));
    const pugi::xml_node root = document_.child("VTKFile");
    for (const auto& [key, value] :
         {std::pair{"type", "PolyData"}, {"byte_order", "LittleEndian"}, {"header_type", "UInt64"}})
      if (std::string_view(root.attribute(key).value()) != value)
        fail(fmt::format("a VTK file without {}=\"{}\"", key, value));
    if (root.attribute("compressor")) fail("a .vtp file with compression");
    piece_ = root.child("PolyData").child("Piece");
  }

  std::uint64_t count(const char* key) const {
    const auto value = parse_integer(piece_.attribute(key).value());
    // More than there are bytes is damage, and is not to be multiplied.
    if (!value || *value < 0 || static_cast<std::uint64_t>(*value) > source_.size)
      fail(fmt::format("damaged .vtp file: {}", key));
    return static_cast<std::uint64_t>(*value);
  }
  pugi::xml_node node(const char* parent, const char* name) const {
    return piece_.child(parent).find_child_by_attribute("DataArray", "Name", name);
  }
  // Where the array's values begin. FormatError unless it has `bytes` of them.
  std::uint64_t place_of(const pugi::xml_node& array, std::uint64_t bytes) const {
    const std::string name = array.attribute("Name").value();
    const auto offset = parse_integer(array.attribute("offset").value());
    const std::uint64_t size = source_.size - begin_;
    if (!offset || *offset < 0 || size < array_head ||
        static_cast<std::uint64_t>(*offset) > size - array_head)
      fail(fmt::format("truncated .vtp file: the array {} is not in it", name));
    const std::uint64_t at = begin_ + static_cast<std::uint64_t>(*offset);
    std::array<std::byte, array_head> head{};
    source_.read(at, head);
    const auto found = load_as<std::uint64_t>(head.data(), 0, std::endian::little);
    if (found != bytes)
      fail(fmt::format("damaged .vtp file: the array {} has {} bytes, expected {}", name, found,
                       bytes));
    if (bytes > source_.size - array_head - at)
      fail(fmt::format("truncated .vtp file: the array {} has {} bytes, {} are left", name, bytes,
                       source_.size - array_head - at));
    return at + array_head;
  }
  const VtpSource& source() const { return source_; }
  [[noreturn]] void fail(const std::string& what) const { throw FormatError(where_ + ": " + what); }

 private:
  const VtpSource& source_;
  const std::string& where_;
  pugi::xml_document document_;
  pugi::xml_node piece_;
  std::uint64_t begin_ = 0;  // of the data
};

// An array's values, one after the other.
class VtpColumn {
 public:
  VtpColumn(const VtpHeader& header, const char* parent, const char* name, std::uint64_t count,
            std::span<const VtpType> types)
      : source_(header.source()), left_(count) {
    const pugi::xml_node array = header.node(parent, name);
    if (!array) header.fail(fmt::format("a .vtp file without the array {} of {}", name, parent));
    const std::string_view found = array.attribute("type").value();
    const auto type = std::ranges::find(types, found, &VtpType::name);
    if (type == types.end())
      header.fail(fmt::format("the array {} of a .vtp file has type {}", name, found));
    size_ = type->bytes;
    at_ = header.place_of(array, count * size_);
  }
  float real() { return load_as<float>(next(), 0, std::endian::little); }
  std::int64_t integer() {
    const std::byte* const value = next();
    return size_ == 4 ? load_as<std::int32_t>(value, 0, std::endian::little)
                      : load_as<std::int64_t>(value, 0, std::endian::little);
  }

 private:
  // Precondition: some are left.
  const std::byte* next() {
    if (used_ == bytes_.size()) {
      constexpr std::uint64_t ahead = 1 << 15;
      bytes_.resize(static_cast<std::size_t>(std::min(left_, ahead) * size_));
      source_.read(at_, bytes_);
      at_ += bytes_.size();
      left_ -= bytes_.size() / size_;
      used_ = 0;
    }
    used_ += size_;
    return bytes_.data() + used_ - size_;
  }

  const VtpSource& source_;
  std::vector<std::byte> bytes_;
  std::size_t used_ = 0, size_ = 4;
  std::uint64_t at_ = 0, left_;  // of those that are not in bytes_
};

// Calls f(corners, pair) with each triangle; pair is null where there are no labels.
template <class F>
void each_vtp_triangle(const VtpHeader& header, std::uint64_t points, std::uint64_t triangles,
                       const F& f) {
  static constexpr std::array integers{vtp_int32, vtp_int64};
  VtpColumn corners(header, "Polys", "connectivity", 3 * triangles, integers);
  VtpColumn ends(header, "Polys", "offsets", triangles, integers);
  std::optional<VtpColumn> inside, outside;
  if (header.node("CellData", "label")) {
    inside.emplace(header, "CellData", "label", triangles, integers);
    outside.emplace(header, "CellData", "label_outside", triangles, integers);
  }
  const auto material = [&](std::int64_t label) {
    if (label < -1) header.fail(fmt::format("a triangle has label {}", label));
    return label == -1 ? exterior : static_cast<Material>(label);
  };
  for (std::uint64_t i = 0; i < triangles; ++i) {
    if (ends.integer() != static_cast<std::int64_t>(3 * i + 3))
      header.fail("a polygon is no triangle");
    std::array<std::uint32_t, 3> triangle{};
    for (std::uint32_t& corner : triangle) {
      const std::int64_t number = corners.integer();
      if (number < 0 || static_cast<std::uint64_t>(number) >= points)
        header.fail(fmt::format("a triangle has vertex {} of {}", number, points));
      corner = static_cast<std::uint32_t>(number);
    }
    MaterialPair pair;
    if (inside) pair = {material(inside->integer()), material(outside->integer())};
    f(triangle, inside ? &pair : nullptr);
  }
}

}  // namespace

int vtp_label_bits(Material highest) {
  return highest <= most_int32 ? 32 : 64;
}

void stream_vtp(const EachTile& each_tile, const StreamTotals& totals, const ByteSink& sink) {
  const VtpTypes types = vtp_types(totals);
  const std::uint64_t v = totals.vertices, t = totals.triangles;
  StreamOut out(sink);
  put_vtp_header(out, totals, types);
  out.put(std::uint64_t{v * 12});
  put_points(out, each_tile, false);
  if (totals.normals && !totals.between_labels) {
    out.put(std::uint64_t{v * 12});
    put_points(out, each_tile, true);
  }
  out.put(std::uint64_t{3 * t * types.corners.bytes});
  put_corners(out, each_tile, types.corners);
  out.put(std::uint64_t{t * types.corners.bytes});
  for (std::uint64_t i = 1; i <= t; ++i) put_integer(out, types.corners, 3 * i);
  if (totals.between_labels)
    for (const auto side : {&MaterialPair::inside, &MaterialPair::outside}) {
      out.put(std::uint64_t{t * types.labels.bytes});
      put_labels(out, each_tile, types.labels, side);
    }
  out.text("\n</AppendedData>\n</VTKFile>\n");
  out.flush();
}

void read_vtp(const VtpSource& source, const std::string& where, VtpSink& sink) {
  const VtpHeader header(source, where);
  const std::uint64_t points = header.count("NumberOfPoints");
  if (points > std::numeric_limits<std::uint32_t>::max())
    header.fail(fmt::format("{} points: more than 32 bits count", points));
  VtpColumn coordinates(header, "Points", "Points", 3 * points, std::span(&vtp_float, 1));
  for (std::uint64_t i = 0; i < points; ++i) {
    Floats place{};
    for (float& coordinate : place) coordinate = coordinates.real();
    sink.vertex(place);
  }
  each_vtp_triangle(
      header, points, header.count("NumberOfPolys"),
      [&](const auto& triangle, const MaterialPair* pair) { sink.triangle(triangle, pair); });
}

DecodedMesh decode_vtp(std::span<const std::byte> bytes, const std::string& where) {
  class InMemory final : public VtpSink {
   public:
    void vertex(const std::array<float, 3>& place) override { mesh.positions.push_back(place); }
    void triangle(const std::array<std::uint32_t, 3>& corners, const MaterialPair* pair) override {
      mesh.triangles.push_back(corners);
      if (pair == nullptr) return;
      if (mesh.pairs.empty() || mesh.pairs.back() != *pair) mesh.pairs.push_back(*pair);
      mesh.triangle_pairs.push_back(static_cast<std::uint32_t>(mesh.pairs.size() - 1));
    }
    DecodedMesh mesh;
  };
  const VtpSource source{bytes.size(), [&](std::uint64_t at, std::span<std::byte> to) {
                           std::memcpy(to.data(), bytes.data() + at, to.size());
                         }};
  InMemory sink;
  read_vtp(source, where, sink);
  return std::move(sink.mesh);
}

}  // namespace voxweld
