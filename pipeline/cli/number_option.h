// An option that takes several numbers, in all the ways people write them.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <vector>

namespace voxweld {

// As "1 2 3", "1,2,3", "[1, 2, 3]" or "1x2x3". counts: how many it may be, ascending.
CLI::Option* add_numbers(CLI::App& command, const std::string& name, std::vector<double>& numbers,
                         const std::vector<std::size_t>& counts, const std::string& help);
// Whole ones.
CLI::Option* add_numbers(CLI::App& command, const std::string& name,
                         std::vector<std::int64_t>& numbers, const std::vector<std::size_t>& counts,
                         const std::string& help);

// Of an option that takes an integer of at least 0.
CLI::Validator whole_number();

}  // namespace voxweld
