// Based on: the OME-XML schema and the OME-TIFF specification, version 6 (ome-model.readthedocs.io).
#include "storage/image/ome_parse.h"

#include <fmt/format.h>

#include <cstring>
#include <limits>
#include <pugixml.hpp>
#include <stdexcept>
#include <string_view>

#include "storage/support/text_fields.h"

namespace voxweld {
namespace {

class OmeProblem : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Elements may carry the prefix of their name space.
bool is_element(const pugi::xml_node& node, std::string_view name) {
  const std::string_view whole = node.name();
  const std::size_t colon = whole.rfind(':');
  return (colon == std::string_view::npos ? whole : whole.substr(colon + 1)) == name;
}

pugi::xml_node child_of(const pugi::xml_node& parent, std::string_view name) {
  return parent.find_child([&](const pugi::xml_node& node) { return is_element(node, name); });
}

std::optional<std::int64_t> number_of(const pugi::xml_node& node, const char* name) {
  const pugi::xml_attribute attribute = node.attribute(name);
  if (!attribute) return std::nullopt;
  const std::optional<std::int64_t> value = parse_integer(trim(attribute.value()));
  if (!value || *value < 0 || *value > std::numeric_limits<std::int32_t>::max())
    throw OmeProblem(fmt::format("{} {}: expected a number from 0 to 2147483647, found '{:.40}'",
                                 node.name(), name, attribute.value()));
  return value;
}

std::int64_t size_of(const pugi::xml_node& node, const char* name) {
  const std::int64_t value = number_of(node, name).value_or(0);
  if (value == 0)
    throw OmeProblem(fmt::format("{} {}: expected a number of 1 or more, found '{:.40}'",
                                 node.name(), name, node.attribute(name).value()));
  return value;
}

OmePages pages_of(const pugi::xml_node& node) {
  OmePages pages;
  pages.page = number_of(node, "IFD");
  pages.count = number_of(node, "PlaneCount");
  pages.z = number_of(node, "FirstZ").value_or(0);
  pages.c = number_of(node, "FirstC").value_or(0);
  pages.t = number_of(node, "FirstT").value_or(0);
  const pugi::xml_node uuid = child_of(node, "UUID");
  pages.file = uuid.attribute("FileName").value();
  pages.uuid = trim(uuid.child_value());
  return pages;
}

OmeImage image_of(const pugi::xml_node& node, const pugi::xml_node& pixels) {
  OmeImage image;
  image.id = node.attribute("ID").value();
  image.name = node.attribute("Name").value();
  image.order = pixels.attribute("DimensionOrder").value();
  image.type = pixels.attribute("Type").value();
  image.x = size_of(pixels, "SizeX");
  image.y = size_of(pixels, "SizeY");
  image.z = size_of(pixels, "SizeZ");
  image.c = size_of(pixels, "SizeC");
  image.t = size_of(pixels, "SizeT");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string name = fmt::format("PhysicalSize{}", "XYZ"[axis]);
    image.step[axis] = trim(pixels.attribute(name.c_str()).value());
    const pugi::xml_attribute unit = pixels.attribute((name + "Unit").c_str());
    image.unit[axis] = unit ? std::string(trim(unit.value())) : "um";
  }
  for (const pugi::xml_node& child : pixels.children()) {
    if (is_element(child, "Channel")) image.channels.emplace_back(child.attribute("Name").value());
    if (is_element(child, "TiffData")) image.pages.push_back(pages_of(child));
  }
  return image;
}

}  // namespace

bool parse_ome(const std::string& xml, OmeMetadata& out, std::string& error) try {
  pugi::xml_document document;
  const pugi::xml_parse_result result = document.load_buffer(xml.data(), xml.size());
  if (!result)
    throw OmeProblem(
        fmt::format("at byte {} of {}: {}", result.offset, xml.size(), result.description()));
  const pugi::xml_node root = child_of(document, "OME");
  if (!root) throw OmeProblem("no element OME");
  out.uuid = trim(root.attribute("UUID").value());
  out.metadata_file = child_of(root, "BinaryOnly").attribute("MetadataFile").value();
  for (const pugi::xml_node& node : root.children()) {
    const pugi::xml_node pixels =
        is_element(node, "Image") ? child_of(node, "Pixels") : pugi::xml_node();
    if (pixels) out.images.push_back(image_of(node, pixels));
  }
  return true;
} catch (const std::exception& problem) {
  error = problem.what();
  return false;
}

}  // namespace voxweld
