#include "tests/pipeline/cli/workplace.h"

#include <algorithm>
#include <fstream>
#include <sstream>

namespace voxweld::testing {

std::string Workplace::phantom(const std::string& name, int size) const {
  run({"phantom", "gyroid", "--size", std::to_string(size), "--type", "uint8", "-o", at(name),
       "--force"});
  return at(name);
}

ProgramResult Workplace::run(const std::vector<std::string>& arguments) const {
  ProgramResult result = run_voxweld(arguments);
  EXPECT_EQ(result.exit_code, 0) << arguments.front() << ": " << result.err;
  return result;
}

void Workplace::run_scene(const std::vector<std::string>& settings) const {
  run({"init", phantom("scene.nrrd"), "-o", at("scene.toml")});
  run(Arguments{"run", at("scene.toml")} + set_options(settings));
}

nlohmann::json Workplace::info(const std::string& path, std::vector<std::string> more) const {
  std::vector<std::string> arguments = {"info", path, "--json"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const ProgramResult result = run(arguments);
  const nlohmann::json document = nlohmann::json::parse(result.out, nullptr, false);
  EXPECT_TRUE(document.is_object()) << path << ": " << result.out;
  return document;
}

void expect_refused(const std::vector<std::string>& arguments,
                    const std::vector<std::string>& message) {
  const ProgramResult result = run_voxweld(arguments);
  EXPECT_EQ(result.exit_code, 2) << result.out << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
  for (const std::string& part : message) EXPECT_THAT(result.err, ::testing::HasSubstr(part));
}

void write_bytes(const std::string& path, const std::string& bytes) {
  std::ofstream file(path, std::ios::binary);
  file << bytes;
  ASSERT_TRUE(file.flush().good()) << path;
}

std::string read_bytes(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

std::string first_file(const std::string& folder, const std::string& ending) {
  std::vector<std::string> found;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.is_regular_file() && entry.path().string().ends_with(ending))
      found.push_back(entry.path().string());
  std::ranges::sort(found);
  EXPECT_FALSE(found.empty()) << "no " << ending << " below " << folder;
  return found.empty() ? std::string() : found.front();
}

}  // namespace voxweld::testing
