// What the metadata of all versions of Zarr have in common. Errors: FormatError naming file and field.
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "storage/store/zarr_json.h"
#include "storage/store/zarr_metadata.h"

namespace voxweld {

// A JSON document that is not nested too deep for a parser. file: for messages.
nlohmann::ordered_json parse_zarr_document(const std::string& text, const std::string& file);

// The number of dimensions of a shape: 2 or 3.
int zarr_rank(const JsonField& shape);
// Zarr's extents, slowest first, as x, y, z.
Index3 zarr_extents(const JsonField& field, int rank);
// That so many samples have a size in bytes.
void check_zarr_size(const JsonField& field, Index3 extents, SampleType type);
// Numbers, "NaN", "Infinity", "-Infinity" and hexadecimal bit patterns; one sample in native byte
// order.
std::array<std::byte, 8> zarr_fill_value(const JsonField& field, SampleType type);
// That one chunk is no larger than any real one.
void check_zarr_chunk(const JsonField& root, const ZarrArray& array);

}  // namespace voxweld
