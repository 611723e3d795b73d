// Types of HDF5 as types of samples.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "storage/hdf5/hdf5_dataset.h"

namespace voxweld {
namespace {

const char* class_name(H5T_class_t kind) {
  switch (kind) {
    case H5T_TIME:
      return "time";
    case H5T_STRING:
      return "text";
    case H5T_BITFIELD:
      return "bit field";
    case H5T_OPAQUE:
      return "opaque";
    case H5T_COMPOUND:
      return "compound";
    case H5T_REFERENCE:
      return "references";
    case H5T_VLEN:
      return "lists of variable length";
    case H5T_ARRAY:
      return "arrays";
    default:
      return "unknown";
  }
}

// As h5py stores complex numbers.
bool is_complex(hid_t type) {
  if (H5Tget_nmembers(type) != 2) return false;
  std::string names;
  for (unsigned i = 0; i < 2; ++i) {
    char* name = H5Tget_member_name(type, i);
    if (name == nullptr) return false;
    names += name;
    H5free_memory(name);
  }
  return names == "ri";
}

std::optional<std::endian> order_of_type(hid_t type) {
  const H5T_order_t order = H5Tget_order(type);
  if (order == H5T_ORDER_LE || order == H5T_ORDER_NONE) return std::endian::little;
  if (order == H5T_ORDER_BE) return std::endian::big;
  return {};
}

bool fills_its_bytes(hid_t type, std::size_t bytes) {
  return H5Tget_precision(type) == 8 * bytes && H5Tget_offset(type) == 0;
}

StoredType integer_type(hid_t type, std::endian order) {
  const std::size_t bytes = H5Tget_size(type), bits = H5Tget_precision(type);
  const bool is_signed = H5Tget_sign(type) == H5T_SGN_2;
  StoredType found{.text = fmt::format("{}{}", is_signed ? "int" : "uint", bits)};
  found.order = order;
  if (bytes < 1 || bytes > 8 || bits < 1) return found;
  const int step = bytes == 1 ? 0 : bytes == 2 ? 1 : bytes <= 4 ? 2 : 3;
  found.type = static_cast<SampleType>(2 * step + (is_signed ? 1 : 0));
  found.plain = sample_bytes(*found.type) == bytes && fills_its_bytes(type, bytes);
  return found;
}

StoredType float_type(hid_t type, std::endian order) {
  const std::size_t bytes = H5Tget_size(type), bits = H5Tget_precision(type);
  StoredType found{.text = fmt::format("float{}", bits)};
  found.order = order;
  if (bytes < 1 || bytes > 8) return found;
  found.type = bytes <= 4 ? SampleType::f32 : SampleType::f64;
  const hid_t standard[] = {H5T_IEEE_F32LE, H5T_IEEE_F32BE, H5T_IEEE_F64LE, H5T_IEEE_F64BE};
  found.plain = std::ranges::any_of(standard, [&](hid_t one) { return H5Tequal(type, one) > 0; });
  return found;
}

StoredType enum_type(hid_t type, std::endian order) {
  const Hdf5Handle base(H5Tget_super(type), H5Tclose);
  StoredType found = integer_type(base.get(), order);
  bool truth = H5Tget_nmembers(type) == 2 && H5Tget_size(type) == 1;
  for (unsigned i = 0; truth && i < 2; ++i) {
    char* name = H5Tget_member_name(type, i);
    truth = name != nullptr && std::strcmp(name, i == 0 ? "FALSE" : "TRUE") == 0;
    H5free_memory(name);
  }
  if (truth) found.type = SampleType::u8;  // 0 and 1 are the same in both
  found.text = truth ? "bool" : "names of " + found.text;
  return found;
}

}  // namespace

StoredType stored_type(hid_t type) {
  const H5T_class_t kind = H5Tget_class(type);
  if (kind == H5T_COMPOUND && is_complex(type)) return {.text = "complex numbers", .type = {}};
  if (kind != H5T_INTEGER && kind != H5T_FLOAT && kind != H5T_ENUM)
    return {.text = class_name(kind), .type = {}};
  const auto order = order_of_type(type);
  if (!order) return {.text = "numbers in VAX byte order", .type = {}};
  if (kind == H5T_INTEGER) return integer_type(type, *order);
  return kind == H5T_FLOAT ? float_type(type, *order) : enum_type(type, *order);
}

Hdf5Handle memory_type(hid_t dataset, SampleType type) {
  const Hdf5Handle stored(H5Dget_type(dataset), H5Tclose);
  if (H5Tget_class(stored.get()) == H5T_ENUM)
    return {H5Tget_native_type(stored.get(), H5T_DIR_ASCEND), H5Tclose};
  const hid_t native[] = {H5T_NATIVE_UINT8,  H5T_NATIVE_INT8,  H5T_NATIVE_UINT16, H5T_NATIVE_INT16,
                          H5T_NATIVE_UINT32, H5T_NATIVE_INT32, H5T_NATIVE_UINT64, H5T_NATIVE_INT64,
                          H5T_NATIVE_FLOAT,  H5T_NATIVE_DOUBLE};
  return {H5Tcopy(native[static_cast<std::size_t>(type)]), H5Tclose};
}

}  // namespace voxweld
