// What a glTF says of the pairs of labels that its triangles separate: a property table
// (EXT_structural_metadata), whose rows the feature ids of the points number (EXT_mesh_features).
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "stages/encode/draco_codec.h"
#include "stages/encode/glb_format.h"
#include "storage/types/material_table.h"

namespace voxweld::glb {

inline constexpr const char* features_extension = "EXT_mesh_features";
inline constexpr const char* metadata_extension = "EXT_structural_metadata";
inline constexpr const char* feature_attribute = "_FEATURE_ID_0";
inline constexpr const char* pair_class = "label_pair";

struct PairColumn {
  std::string name;
  Json property;  // as the schema has it
  std::vector<std::byte> values;
  std::vector<std::byte> offsets;  // of texts: where each begins, and the end
};

// The numbers of the labels on either side, their names where any has one, and their colours.
std::vector<PairColumn> pair_columns(std::span<const MaterialPair> pairs,
                                     const MaterialTable* materials);

// Of the points of each pair, for viewers that know no feature ids: what its inside is given, or what
// tells it from others.
std::vector<PairColour> pair_colours(std::span<const MaterialPair> pairs,
                                     const MaterialTable* materials);

using ViewOf = std::function<std::span<const std::byte>(std::size_t number)>;
// The rows of the table that the primitive's feature ids number. FormatError, starting with `where`, or
// Json::exception for what no pair_columns has written.
std::vector<MaterialPair> read_pair_table(const Json& document, const Json& primitive,
                                          const ViewOf& view_of, const std::string& where);

}  // namespace voxweld::glb
