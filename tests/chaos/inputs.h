// The kinds of input an episode may have, what they hold, and configs that make different meshes of
// them.
#pragma once

#include <string>
#include <vector>

#include "tests/fuzz/mutation.h"

namespace voxweld::testing {

enum class InputKind { raw, nrrd, nrrd_gzip, labels, mesh };
inline constexpr std::size_t input_kinds = 5;

std::string input_file_name(InputKind kind);
// The file's bytes: one of a few dozen solids, chosen at random.
std::string random_input(InputKind kind, Random& random);

// What differs between configs of a kind: keys of [input], and tables.
struct Variant {
  std::string input, tables;
};
const std::vector<Variant>& variants_of(InputKind kind);

}  // namespace voxweld::testing
