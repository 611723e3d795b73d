#include "storage/hdf5/hdf5_attributes.h"

#include <algorithm>
#include <cstring>

#include "storage/support/text_fields.h"

namespace voxweld {
namespace {

constexpr hsize_t most_elements = 4096;
constexpr std::size_t most_text_bytes = std::size_t{1} << 20;

struct OpenAttribute {
  Hdf5Handle attribute, type, space;
  std::size_t count = 0;  // 0: not there, or of too many elements
  H5T_class_t kind = H5T_NO_CLASS;
};

OpenAttribute open_attribute(hid_t object, const std::string& name) {
  OpenAttribute open;
  if (H5Aexists(object, name.c_str()) <= 0) return open;
  open.attribute = {H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose};
  if (!open.attribute) return open;
  open.type = {H5Aget_type(open.attribute.get()), H5Tclose};
  open.space = {H5Aget_space(open.attribute.get()), H5Sclose};
  if (!open.type || !open.space) return open;
  open.kind = H5Tget_class(open.type.get());
  const hssize_t count = H5Sget_simple_extent_npoints(open.space.get());
  if (count > 0 && static_cast<hsize_t>(count) <= most_elements)
    open.count = static_cast<std::size_t>(count);
  return open;
}

// Up to its first zero byte or its end, without blanks around it.
std::string text_of(const char* data, std::size_t most) {
  return std::string(trim(std::string_view(data, strnlen(data, most))));
}

std::vector<std::string> variable_texts(const OpenAttribute& open) {
  std::vector<char*> pointers(open.count, nullptr);
  const Hdf5Handle memory(H5Tcopy(open.type.get()), H5Tclose);
  if (H5Aread(open.attribute.get(), memory.get(), pointers.data()) < 0) return {};
  std::vector<std::string> texts;
  for (const char* pointer : pointers)
    texts.push_back(pointer == nullptr ? "" : text_of(pointer, most_text_bytes));
  H5Dvlen_reclaim(memory.get(), open.space.get(), H5P_DEFAULT, pointers.data());
  return texts;
}

std::vector<std::string> fixed_texts(const OpenAttribute& open) {
  const std::size_t width = H5Tget_size(open.type.get());
  if (width == 0 || width > most_text_bytes / open.count) return {};
  std::vector<char> bytes(width * open.count);
  if (H5Aread(open.attribute.get(), open.type.get(), bytes.data()) < 0) return {};
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < open.count; ++i)
    texts.push_back(text_of(bytes.data() + i * width, width));
  return texts;
}

// Its samples lie in this file, in pieces that are no larger than such a thing needs.
bool stored_plainly(hid_t dataset) {
  const Hdf5Handle created(H5Dget_create_plist(dataset), H5Pclose);
  if (!created || H5Pget_external_count(created.get()) != 0) return false;
  const H5D_layout_t layout = H5Pget_layout(created.get());
  if (layout == H5D_CONTIGUOUS || layout == H5D_COMPACT) return true;
  if (layout != H5D_CHUNKED) return false;
  hsize_t chunk[H5S_MAX_RANK];
  const int rank = H5Pget_chunk(created.get(), H5S_MAX_RANK, chunk);
  hsize_t count = 1;
  for (int i = 0; i < rank; ++i) {
    if (chunk[i] > most_text_bytes / count) return false;
    count *= std::max<hsize_t>(1, chunk[i]);
  }
  return rank > 0;
}

}  // namespace

std::vector<std::string> text_attributes(hid_t object, const std::string& name) {
  const OpenAttribute open = open_attribute(object, name);
  if (open.count == 0 || open.kind != H5T_STRING) return {};
  return H5Tis_variable_str(open.type.get()) > 0 ? variable_texts(open) : fixed_texts(open);
}

std::optional<std::string> text_attribute(hid_t object, const std::string& name) {
  const OpenAttribute open = open_attribute(object, name);
  if (open.count == 0 || open.kind != H5T_STRING) return {};
  if (H5Tis_variable_str(open.type.get()) <= 0 && H5Tget_size(open.type.get()) == 1) {
    std::string row(open.count, '\0');
    if (H5Aread(open.attribute.get(), open.type.get(), row.data()) < 0) return {};
    return text_of(row.data(), row.size());
  }
  const auto texts = text_attributes(object, name);
  if (texts.size() != 1) return {};
  return texts.front();
}

std::vector<double> number_attributes(hid_t object, const std::string& name) {
  const OpenAttribute open = open_attribute(object, name);
  if (open.count == 0 || (open.kind != H5T_INTEGER && open.kind != H5T_FLOAT)) return {};
  std::vector<double> values(open.count);
  if (H5Aread(open.attribute.get(), H5T_NATIVE_DOUBLE, values.data()) < 0) return {};
  return values;
}

std::optional<double> number_attribute(hid_t object, const std::string& name) {
  const auto values = number_attributes(object, name);
  if (values.size() == 1) return values.front();
  if (const auto text = text_attribute(object, name)) return parse_real(*text);
  return {};
}

std::optional<SmallDataset> small_dataset(hid_t dataset, hsize_t most) {
  const Hdf5Handle type(H5Dget_type(dataset), H5Tclose), space(H5Dget_space(dataset), H5Sclose);
  if (!type || !space) return {};
  const H5T_class_t kind = H5Tget_class(type.get());
  const hssize_t count = H5Sget_simple_extent_npoints(space.get());
  if (!stored_plainly(dataset)) return {};
  if ((kind != H5T_INTEGER && kind != H5T_FLOAT) || count <= 0 ||
      static_cast<hsize_t>(count) > most)
    return {};
  SmallDataset small;
  small.dims = space_dims(space.get()).value_or(std::vector<hsize_t>{});
  small.values.resize(static_cast<std::size_t>(count));
  if (H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, small.values.data()) < 0)
    return {};
  return small;
}

std::optional<std::vector<hsize_t>> space_dims(hid_t space) {
  const H5S_class_t kind = H5Sget_simple_extent_type(space);
  if (kind == H5S_SCALAR) return std::vector<hsize_t>{};
  const int rank = H5Sget_simple_extent_ndims(space);
  if (kind != H5S_SIMPLE || rank < 0 || rank > H5S_MAX_RANK) return {};
  std::vector<hsize_t> dims(static_cast<std::size_t>(rank));
  if (rank > 0 && H5Sget_simple_extent_dims(space, dims.data(), nullptr) < 0) return {};
  return dims;
}

}  // namespace voxweld
