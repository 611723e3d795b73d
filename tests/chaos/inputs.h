// The kinds of input an episode may have, what they hold, and configs that make different meshes of
// them.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "tests/fuzz/mutation.h"

namespace voxweld::testing {

enum class InputKind {
  raw,
  nrrd,
  nrrd_gzip,
  two_files,  // whose header names two files of samples
  labels,
  label_map,  // of labels that stay
  mesh,
  solid,  // a mesh that an edit takes out of a volume that stays
};
inline constexpr std::size_t input_kinds = 8;

struct InputFiles {
  std::string changing;                                     // the one that users lay hands on
  std::string path;                                         // what input.path names
  std::vector<std::pair<std::string, std::string>> others;  // their names and bytes
};
const InputFiles& files_of(InputKind kind);
// Bytes of the changing file: one of a few dozen, chosen at random.
std::string random_input(InputKind kind, Random& random);

// What differs between configs of a kind: keys of [input], and tables.
struct Variant {
  std::string input, tables;
};
const std::vector<Variant>& variants_of(InputKind kind);

}  // namespace voxweld::testing
