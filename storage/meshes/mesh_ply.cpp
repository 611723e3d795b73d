// PLY, text and binary: the x, y, z of its vertices, the vertex lists of its faces and the labels of
// those that have two; all other elements and properties are passed over.
#include <algorithm>
#include <array>

#include "storage/meshes/mesh_formats.h"
#include "storage/support/byte_order.h"
#include "storage/types/sample_type.h"

namespace voxweld {
namespace {

struct Property {
  std::string name;
  SampleType type;
  std::optional<SampleType> count_type;  // of lists
};

struct Element {
  std::string name;
  std::int64_t count = 0;
  std::vector<Property> properties;
};

enum class Encoding : std::uint8_t { text, little, big };

struct Header {
  std::optional<Encoding> encoding;
  std::vector<Element> elements;
};

SampleType type_named(const MeshLines& lines, std::string_view name) {
  // Those of the names that there are for sample types which PLY has too.
  constexpr std::string_view types[] = {"char",   "int8",    "uchar",  "uint8",  "short", "int16",
                                        "ushort", "uint16",  "int",    "int32",  "uint",  "uint32",
                                        "float",  "float32", "double", "float64"};
  if (std::ranges::find(types, name) != std::end(types)) return *parse_sample_type(name);
  lines.fail(fmt::format("unknown type \"{}\"", name));
}

Property property_of(const MeshLines& lines) {
  const auto& words = lines.words();
  if (words.size() == 5 && words[1] == "list")
    return {std::string(words[4]), type_named(lines, words[3]), type_named(lines, words[2])};
  if (words.size() != 3) lines.fail("expected \"property TYPE NAME\" or a list of that");
  return {std::string(words[2]), type_named(lines, words[1]), {}};
}

Header read_header(const MeshStream& file, MeshLines& lines) {
  Header header;
  if (!lines.next() || lines.words()[0] != "ply")
    file.fail("expected a file beginning with \"ply\"");
  while (true) {
    if (!lines.next()) file.fail("the header has no end: truncated");
    const auto& words = lines.words();
    if (words[0] == "end_header") break;
    if (words[0] == "format" && words.size() > 1) {
      if (words[1] == "ascii") header.encoding = Encoding::text;
      if (words[1] == "binary_little_endian") header.encoding = Encoding::little;
      if (words[1] == "binary_big_endian") header.encoding = Encoding::big;
    } else if (words[0] == "element" && words.size() > 1) {
      const std::int64_t count = lines.whole(2);
      // Each takes a byte at the least.
      if (count < 0 || static_cast<std::uint64_t>(count) > file.size())
        lines.fail(fmt::format("announces {} elements, more than a file of {} bytes can hold",
                               count, file.size()));
      header.elements.push_back({std::string(words[1]), count, {}});
    } else if (words[0] == "property") {
      if (header.elements.empty()) lines.fail("a property of no element");
      header.elements.back().properties.push_back(property_of(lines));
    } else if (words[0] != "comment" && words[0] != "obj_info") {
      lines.fail(fmt::format("unknown word \"{}\"", words[0].substr(0, 40)));
    }
  }
  if (!header.encoding)
    file.fail("expected format ascii, binary_little_endian or binary_big_endian");
  return header;
}

// The values of the body, one after the other, whatever the encoding.
class Body {
 public:
  Body(MeshStream& file, MeshLines& lines, const Header& header)
      : file_(file), lines_(lines), encoding_(*header.encoding) {}

  void begin_item() {
    if (encoding_ != Encoding::text) return;
    if (!lines_.next()) truncated();
    word_ = 0;
  }
  // How many values the property has here.
  std::uint32_t count(const Property& property) {
    if (!property.count_type) return 1;
    const double count = next(*property.count_type);
    if (!(count >= 0 && count < 4294967296.0))
      file_.fail(fmt::format("a list {} of {} values", property.name, count));
    return static_cast<std::uint32_t>(count);
  }
  double next(SampleType type) {
    if (encoding_ == Encoding::text) return next_word();
    const std::size_t width = sample_bytes(type);
    const auto bytes = file_.take(width);
    if (bytes.size() < width) truncated();
    std::array<std::byte, 8> value{};
    std::copy(bytes.begin(), bytes.end(), value.begin());
    to_native(value.data(), 1, width,
              encoding_ == Encoding::little ? std::endian::little : std::endian::big);
    return dispatch_sample_type(type, [&](auto tag) {
      typename decltype(tag)::type number;
      std::memcpy(&number, value.data(), sizeof number);
      return static_cast<double>(number);
    });
  }

 private:
  [[noreturn]] void truncated() const { file_.fail("ends before its last element: truncated"); }
  double next_word() {
    if (word_ >= lines_.words().size()) lines_.fail("too few values");
    return lines_.number(word_++);
  }

  MeshStream& file_;
  MeshLines& lines_;
  Encoding encoding_;
  std::size_t word_ = 0;
};

// Of the x, y and z among its properties.
Vec3 read_place(const Element& element, Body& body) {
  Vec3 place;
  for (const Property& property : element.properties) {
    double value = 0;
    for (std::uint32_t count = body.count(property); count > 0; --count)
      value = body.next(property.type);
    if (property.name.size() == 1 && property.name >= "x" && property.name <= "z")
      place[property.name[0] - 'x'] = value;
  }
  return place;
}

bool holds_corners(const Property& property) {
  return property.count_type &&
         (property.name == "vertex_indices" || property.name == "vertex_index");
}

void read_face(const MeshStream& file, const Element& element, Body& body, MeshOutput& out) {
  out.begin_polygon();
  std::optional<double> inside, outside;
  for (const Property& property : element.properties) {
    for (std::uint32_t count = body.count(property); count > 0; --count) {
      const double value = body.next(property.type);
      if (property.name == "label") inside = value;
      if (property.name == "label_outside") outside = value;
      // The double of a number of 32 bits is the number; what is no number is out of any range.
      const bool fits = value >= 0 && value < 4294967296.0;
      if (holds_corners(property) && !out.corner(fits ? static_cast<std::int64_t>(value) : -1))
        file.fail(fmt::format("a face has vertex {}, and there is none of that number", value));
    }
  }
  if (inside && outside) out.labels(*inside, *outside);
}

void require(const MeshStream& file, const Header& header) {
  const auto has = [&](std::string_view element, auto&& wanted) {
    for (const Element& e : header.elements)
      if (e.name == element && std::any_of(e.properties.begin(), e.properties.end(), wanted))
        return true;
    return false;
  };
  for (const std::string_view name : {"x", "y", "z"})
    if (!has("vertex", [&](const Property& p) { return p.name == name && !p.count_type; }))
      file.fail(fmt::format("vertices have no property {}", name));
  if (!has("face", holds_corners))
    file.fail("no faces with a list vertex_indices; strips and clouds of points are not read");
}

}  // namespace

void parse_ply(MeshStream& file, MeshOutput& out) {
  MeshLines lines(file, {});
  const Header header = read_header(file, lines);
  require(file, header);
  Body body(file, lines, header);
  for (const Element& element : header.elements)
    for (std::int64_t i = 0; i < element.count; ++i) {
      body.begin_item();
      if (element.name == "face") {
        read_face(file, element, body, out);
        continue;
      }
      const Vec3 place = read_place(element, body);
      if (element.name == "vertex") out.vertex(place);
    }
}

}  // namespace voxweld
