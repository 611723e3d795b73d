#include "storage/vtk/vti_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <pugixml.hpp>
#include <utility>

#include "storage/support/error.h"
#include "storage/support/text_fields.h"
#include "storage/vtk/xml_outline.h"

namespace voxweld {
namespace {

constexpr std::int64_t most_index = std::int64_t{1} << 40;

constexpr std::pair<const char*, SampleType> vti_types[] = {
    {"Int8", SampleType::i8},    {"UInt8", SampleType::u8},   {"Int16", SampleType::i16},
    {"UInt16", SampleType::u16}, {"Int32", SampleType::i32},  {"UInt32", SampleType::u32},
    {"Int64", SampleType::i64},  {"UInt64", SampleType::u64}, {"Float32", SampleType::f32},
    {"Float64", SampleType::f64}};

class VtiParser {
 public:
  explicit VtiParser(const ReadFile& file) : file_(file) {}

  VtiHeader run() {
    const XmlOutline outline = read_xml_outline(file_, "VTKFile");
    appended_ = outline.appended;
    pugi::xml_document document;
    const pugi::xml_parse_result parsed =
        document.load_buffer(outline.markup.data(), outline.markup.size());
    if (!parsed) {
      const auto at = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, parsed.offset));
      fail(fmt::format("the XML is damaged: {}, near '{}'", parsed.description(),
                       shown(outline.markup.substr(std::min(at, outline.markup.size()), 40))));
    }
    const pugi::xml_node root = document.child("VTKFile");
    if (!root) fail("not a VTK file: expected the element VTKFile");
    read_root(root);
    const pugi::xml_node image = root.child("ImageData");
    if (!image) fail("no element ImageData");
    read_lattice(image);
    const pugi::xml_node piece = only_piece(image);
    read_arrays(piece.child("PointData"), false);
    read_arrays(piece.child("CellData"), true);
    return std::move(header_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw FormatError(file_.path() + ": " + what);
  }
  // One short line whatever the file holds.
  static std::string shown(std::string text) {
    for (char& c : text)
      if (c < ' ' || c > '~') c = '?';
    return text.size() > 80 ? text.substr(0, 80) + "..." : text;
  }
  [[noreturn]] void reject(const pugi::xml_node& node, const char* key,
                           const std::string& expected) const {
    fail(fmt::format("{}, attribute {}: expected {}, found '{}'", node.name(), key, expected,
                     shown(node.attribute(key).value())));
  }

  void read_root(const pugi::xml_node& root) {
    const std::string type = root.attribute("type").value();
    if (type == "PImageData")
      fail(
          "a list of pieces in other files (PImageData): open one of the pieces, or write them "
          "into one .vti file first");
    if (type != "ImageData")
      fail(fmt::format("a VTK file of type '{}': expected ImageData, samples on a regular lattice",
                       shown(type)));
    const std::string order = root.attribute("byte_order").value();
    if (order == "BigEndian")
      header_.words.order = std::endian::big;
    else if (order.empty())
      header_.warnings.push_back(file_.path() + ": no byte_order: little-endian assumed");
    else if (order != "LittleEndian")
      reject(root, "byte_order", "LittleEndian or BigEndian");
    const std::string word = root.attribute("header_type").value();
    if (word == "UInt64")
      header_.words.bytes = 8;
    else if (!word.empty() && word != "UInt32")
      reject(root, "header_type", "UInt32 or UInt64");
    const std::string codec = root.attribute("compressor").value();
    if (codec == "vtkZLibDataCompressor")
      header_.codec = BlockCodec::zlib;
    else if (codec == "vtkLZ4DataCompressor")
      header_.codec = BlockCodec::lz4;
    else if (codec == "vtkLZMADataCompressor")
      header_.codec = BlockCodec::lzma;
    else if (!codec.empty())
      reject(root, "compressor",
             "vtkZLibDataCompressor, vtkLZ4DataCompressor or vtkLZMADataCompressor");
    read_appended(root.child("AppendedData"));
  }

  // The data begins behind an underscore.
  void read_appended(const pugi::xml_node& node) {
    if (!node || !appended_) return;
    const std::string encoding = node.attribute("encoding").value();
    header_.appended_is_base64 = encoding == "base64";
    if (encoding != "base64" && encoding != "raw") reject(node, "encoding", "raw or base64");
    std::array<std::byte, 4096> bytes{};
    const std::uint64_t begin = *appended_;
    const auto there = std::span(bytes).first(
        static_cast<std::size_t>(std::min<std::uint64_t>(bytes.size(), file_.size() - begin)));
    file_.read(begin, there);
    const auto mark = std::ranges::find(there, std::byte{'_'});
    if (mark == there.end())
      fail(
          fmt::format("AppendedData: no '_', which is where the data begins, within {} bytes from "
                      "byte {} on: truncated or damaged",
                      bytes.size(), begin));
    appended_ = begin + static_cast<std::uint64_t>(mark - there.begin()) + 1;
  }

  template <std::size_t count>
  std::array<double, count> reals(const pugi::xml_node& node, const char* key) const {
    const std::vector<std::string> words = split_words(node.attribute(key).value());
    std::array<double, count> values{};
    if (words.size() != count) reject(node, key, fmt::format("{} numbers", count));
    for (std::size_t i = 0; i < count; ++i) {
      const auto value = parse_real(words[i]);
      if (!value) reject(node, key, fmt::format("{} numbers", count));
      values[i] = *value;
    }
    return values;
  }

  std::array<std::int64_t, 6> extent(const pugi::xml_node& node, const char* key) const {
    const std::vector<std::string> words = split_words(node.attribute(key).value());
    const char* expected = "six whole numbers: first and last index along x, y and z";
    if (words.size() != 6) reject(node, key, expected);
    std::array<std::int64_t, 6> values{};
    for (std::size_t i = 0; i < 6; ++i) {
      const auto value = parse_integer(words[i]);
      if (!value || *value > most_index || *value < -most_index) reject(node, key, expected);
      values[i] = *value;
    }
    for (std::size_t a = 0; a < 6; a += 2)
      if (values[a] > values[a + 1]) reject(node, key, "no last index below the first");
    return values;
  }

  void read_lattice(const pugi::xml_node& image) {
    VtkLattice& lattice = header_.lattice;
    const auto whole = extent(image, "WholeExtent");
    for (int a = 0; a < 3; ++a) {
      const auto i = static_cast<std::size_t>(2 * a);
      lattice.size[a] = whole[i + 1] - whole[i] + 1;
      lattice.first[a] = static_cast<double>(whole[i]);
    }
    if (image.attribute("Spacing")) {
      const auto spacing = reals<3>(image, "Spacing");
      lattice.spacing = {spacing[0], spacing[1], spacing[2]};
    }
    if (image.attribute("Origin")) {
      const auto origin = reals<3>(image, "Origin");
      lattice.origin = {origin[0], origin[1], origin[2]};
    }
    if (image.attribute("Direction")) {  // rows of a matrix whose columns are the axes
      const auto m = reals<9>(image, "Direction");
      for (std::size_t a = 0; a < 3; ++a) lattice.direction[a] = {m[a], m[a + 3], m[a + 6]};
    }
  }

  pugi::xml_node only_piece(const pugi::xml_node& image) const {
    const pugi::xml_node piece = image.child("Piece");
    if (!piece) fail("ImageData has no Piece: there is nothing to read");
    if (piece.next_sibling("Piece"))
      fail("ImageData is in several pieces: write the file in one piece first");
    if (extent(piece, "Extent") != extent(image, "WholeExtent"))
      reject(piece, "Extent",
             fmt::format("the WholeExtent '{}'", shown(image.attribute("WholeExtent").value())));
    return piece;
  }

  void read_arrays(const pugi::xml_node& data, bool of_cells) {
    (of_cells ? header_.marked_cells : header_.marked_points) = data.attribute("Scalars").value();
    for (const pugi::xml_node node : data.children("DataArray")) read_array(node, of_cells);
  }

  void read_array(const pugi::xml_node& node, bool of_cells) {
    VtiArray array;
    array.array.name = node.attribute("Name").value();
    array.array.of_cells = of_cells;
    array.array.type_name = shown(node.attribute("type").value());
    for (const auto& [name, type] : vti_types)
      if (array.array.type_name == name) array.array.type = type;
    if (node.attribute("NumberOfComponents")) {
      const auto count = parse_integer(node.attribute("NumberOfComponents").value());
      if (!count || *count < 1) reject(node, "NumberOfComponents", "a positive number");
      array.array.components = *count;
    }
    const std::string format = node.attribute("format").value();
    if (format == "appended")
      read_offset(node, array);
    else if (format == "binary" || format == "ascii")
      array.format = format == "binary" ? VtiFormat::binary : VtiFormat::ascii;
    else
      reject(node, "format", "ascii, binary or appended");
    if (array.format != VtiFormat::appended) {
      const std::vector<std::string> place = split_words(node.child_value());
      if (place.size() >= 2) {
        array.begin = static_cast<std::uint64_t>(parse_integer(place[0]).value_or(0));
        array.end = static_cast<std::uint64_t>(parse_integer(place[1]).value_or(0));
      }
    }
    header_.arrays.push_back(std::move(array));
  }

  void read_offset(const pugi::xml_node& node, VtiArray& array) const {
    const auto offset = parse_integer(trim(node.attribute("offset").value()));
    if (!offset || *offset < 0) reject(node, "offset", "a whole number from 0 on");
    if (!appended_) fail("an array is appended, but there is no AppendedData: truncated");
    array.format = VtiFormat::appended;
    array.begin = *appended_ + static_cast<std::uint64_t>(*offset);
    array.end = file_.size();
    if (array.begin >= array.end)
      fail(fmt::format("array '{}': its data begins at byte {}, the file has {}: truncated",
                       shown(array.array.name), array.begin, array.end));
  }

  const ReadFile& file_;
  std::optional<std::uint64_t> appended_;
  VtiHeader header_;
};

}  // namespace

VtiHeader read_vti_header(const ReadFile& file) {
  return VtiParser(file).run();
}

}  // namespace voxweld
