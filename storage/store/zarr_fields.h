// What the metadata of all versions of Zarr have in common. Errors: FormatError naming file and field.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "storage/store/zarr_json.h"
#include "storage/store/zarr_metadata.h"

namespace voxweld {

// A JSON document that is not nested too deep for a parser. file: for messages.
nlohmann::ordered_json parse_zarr_document(const std::string& text, const std::string& file);

// Which of x, y, z each of the dimensions is: as they are named, or z, y, x. names: of the
// dimensions, slowest first; empty: none are known.
std::vector<int> zarr_axes(const JsonField& shape, const std::vector<std::string>& names);
// Zarr's extents, slowest first, as x, y, z.
Index3 zarr_extents(const JsonField& field, const std::vector<int>& axes);
// The axes of a chunk's samples, the fastest first, where `slowest_first` numbers the dimensions so.
std::array<int, 3> order_of(const std::vector<int>& axes, const std::vector<int>& slowest_first);
// 0, 1 ... rank - 1; and the other way round, as in Fortran.
std::vector<int> rows_first(std::size_t rank);
std::vector<int> columns_first(std::size_t rank);
// That so many samples have a size in bytes.
void check_zarr_size(const JsonField& field, Index3 extents, SampleType type);
// Numbers, "NaN", "Infinity", "-Infinity" and hexadecimal bit patterns; one sample in native byte
// order.
std::array<std::byte, 8> zarr_fill_value(const JsonField& field, SampleType type);
// That one chunk is no larger than any real one.
void check_zarr_chunk(const JsonField& root, const ZarrArray& array);

}  // namespace voxweld
