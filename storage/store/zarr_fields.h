// What the metadata of all versions of Zarr have in common. Errors: FormatError naming file and field.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "storage/store/zarr_json.h"
#include "storage/store/zarr_metadata.h"

namespace voxweld {

// A JSON document that is not nested too deep for a parser. file: for messages.
nlohmann::ordered_json parse_zarr_document(const std::string& text, const std::string& file);

// Extents of all dimensions, each at least 1.
Extents zarr_extents(const JsonField& field, std::size_t rank);
// Sets axes, at, size, choices and warnings: which dimensions are z, y and x, by their names or by
// their places, and which index of the others is read. InputError where the user has to choose, or
// chose what is not there. Precondition: shape holds Extents.
void settle_dimensions(const JsonField& shape, const ArrayContext& context, ZarrArray& array);
// The names that xarray gives the dimensions of an array of version 2; empty where it gives none.
std::vector<std::string> zarr_v2_names(const StoreFolder& array);
// 0, 1 ... rank - 1; and the other way round, as in Fortran.
std::vector<int> rows_first(std::size_t rank);
std::vector<int> columns_first(std::size_t rank);
// That so many samples have a size in bytes.
void check_zarr_size(const JsonField& field, const Extents& extents, std::size_t sample_bytes);
// Numbers, "NaN", "Infinity", "-Infinity" and hexadecimal bit patterns of the stored type, for bytes
// true and false too; one sample in native byte order. Preconditions: type and half are set.
void parse_fill_value(const JsonField& field, ZarrArray& array);
// Spacing, origin and unit, where the context says a scale for each dimension.
std::optional<VolumeGeometry> geometry_of(const ArrayContext& context, const ZarrArray& array);
// That one chunk is no larger than any real one.
void check_zarr_chunk(const JsonField& root, const ZarrArray& array);

}  // namespace voxweld
