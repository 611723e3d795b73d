#include "pipeline/slurm/array_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "storage/support/error.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& path) {
  const auto bytes = read_whole_file(path);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

ArrayFolder ArrayFolder::create(const fs::path& parent, const std::vector<std::string>& tasks) {
  make_directories(parent);
  for (std::size_t number = all(parent).size();; ++number) {
    const ArrayFolder folder(parent / fmt::format("array-{:03}", number));
    // Made by one process only: another driver that is at it too takes the next.
    std::error_code error;
    const bool is_new = fs::create_directory(folder.path(), error);
    if (error) throw_errno("create directory", folder.path().string(), error.value());
    if (!is_new) continue;
    make_directories(folder.logs());
    make_directories(folder.reports());
    std::string text;
    for (const std::string& task : tasks) text += task + "\n";
    write_whole_file(folder.tasks_path(), as_bytes(text), Durability::rename_only);
    return folder;
  }
}

std::vector<ArrayFolder> ArrayFolder::all(const fs::path& parent) {
  std::vector<fs::path> paths;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(parent, error))
    if (entry.path().filename().string().starts_with("array-")) paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end(), [](const fs::path& a, const fs::path& b) {
    const auto name = a.string().size() <=> b.string().size();  // array-999 before array-1000
    return name != 0 ? name < 0 : a < b;
  });
  return {paths.begin(), paths.end()};
}

fs::path ArrayFolder::report_path(std::int64_t task) const {
  return reports() / fmt::format("{}.json", task);
}

fs::path ArrayFolder::log_path(std::int64_t job, std::int64_t task) const {
  const fs::path log = logs() / fmt::format("{}_{}.log", job, task);
  return fs::exists(log) ? log : logs();
}

std::vector<std::string> ArrayFolder::tasks() const {
  std::vector<std::string> lines;
  if (!fs::exists(tasks_path())) return lines;
  const std::string text = text_of(tasks_path());
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    lines.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return lines;
}

std::optional<std::int64_t> ArrayFolder::job() const {
  if (!fs::exists(path_ / "job")) return std::nullopt;
  const std::string text = text_of(path_ / "job");
  std::int64_t id = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), id);
  return parsed.ec == std::errc() && id > 0 ? std::optional(id) : std::nullopt;
}

void ArrayFolder::set_job(std::int64_t job) const {
  write_whole_file(path_ / "job", as_bytes(fmt::format("{}\n", job)), Durability::rename_only);
}

}  // namespace voxweld
