// What others' errors say, in messages of ours.
#pragma once

#include <exception>
#include <filesystem>
#include <string>

namespace voxweld {

// What the system refused, where it was asked through std::filesystem: a link that leads to itself,
// a folder that may not be searched.
inline std::string refused_text(const std::filesystem::filesystem_error& error) {
  return "cannot use " + error.path1().string() + ": " + error.code().message();
}

// What nlohmann-json says, without its own name of the error, which stands before it in brackets.
inline std::string json_problem(const std::exception& error) {
  const std::string said = error.what();
  const std::size_t name_end = said.find("] ");
  return name_end == std::string::npos ? said : said.substr(name_end + 2);
}

}  // namespace voxweld
