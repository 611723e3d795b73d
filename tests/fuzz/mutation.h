// Files as accidents leave them: bits turned, pieces lost, numbers out of all bounds.
#pragma once

#include <filesystem>
#include <random>
#include <string>
#include <vector>

namespace voxweld::testing {

using Random = std::mt19937_64;
// 0 .. count-1; the same on every machine.
std::size_t pick(Random& random, std::size_t count);
template <class T>
const T& pick_from(Random& random, const std::vector<T>& all) {
  return all[pick(random, all.size())];
}

// Bytes of a file changed in one way. `other`: bytes of another, to splice with. Says what was done.
std::string mutate_bytes(std::string& bytes, const std::string& other, Random& random);

// The same for a file on disk, or what takes its place: nothing, a folder, a link to itself. Half of
// the compressed ones are changed inside.
std::string mutate_file(const std::filesystem::path& path, const std::string& other,
                        Random& random);

std::string bytes_of_file(const std::filesystem::path& path);
void write_bytes(const std::filesystem::path& path, const std::string& bytes);

}  // namespace voxweld::testing
