#include "pipeline/slurm/array_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <sstream>
#include <string_view>

#include "storage/support/error.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

// The number in a folder's name; nothing where it is no array's.
std::optional<std::size_t> number_of(const fs::path& path) {
  const std::string name = path.filename().string();
  constexpr std::string_view prefix = "array-";
  if (!name.starts_with(prefix)) return std::nullopt;
  std::size_t number = 0;
  const char* const end = name.data() + name.size();
  const auto parsed = std::from_chars(name.data() + prefix.size(), end, number);
  return parsed.ec == std::errc() && parsed.ptr == end ? std::optional(number) : std::nullopt;
}

std::string text_of(const fs::path& path) {
  const auto bytes = read_whole_file(path);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

ArrayFolder ArrayFolder::create(const fs::path& parent, const std::vector<std::string>& tasks,
                                const std::string& name) {
  make_directories(parent);
  const std::vector<ArrayFolder> before = all(parent);
  std::size_t number = before.empty() ? 0 : *number_of(before.back().path()) + 1;
  for (;; ++number) {
    const ArrayFolder folder(parent / fmt::format("array-{:03}", number));
    // Made by one process only: another driver that is at it too takes the next.
    std::error_code error;
    if (!fs::create_directory(folder.path(), error)) {
      if (error) throw_errno("create", folder.path().string(), error.value());
      continue;
    }
    make_directories(folder.logs());
    make_directories(folder.reports());
    std::string text;
    for (const std::string& task : tasks) text += task + "\n";
    write_whole_file(folder.tasks_path(), as_bytes(text), Durability::rename_only);
    write_whole_file(folder.path_ / "name", as_bytes(name + "\n"), Durability::rename_only);
    return folder;
  }
}

std::vector<ArrayFolder> ArrayFolder::all(const fs::path& parent) {
  std::map<std::size_t, fs::path> paths;
  std::error_code error;
  for (fs::directory_iterator at(parent, error), end; !error && at != end; at.increment(error))
    if (const auto number = number_of(at->path())) paths.emplace(*number, at->path());
  std::vector<ArrayFolder> folders;
  folders.reserve(paths.size());
  for (auto& [number, path] : paths) folders.emplace_back(std::move(path));
  return folders;
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
  std::istringstream text(text_of(tasks_path()));
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

std::string ArrayFolder::name() const {
  if (!fs::exists(path_ / "name")) return {};
  const std::string text = text_of(path_ / "name");
  const bool whole = !text.empty() && text.find('\n') + 1 == text.size();
  return whole ? text.substr(0, text.size() - 1) : std::string();
}

std::optional<std::int64_t> ArrayFolder::job() const {
  if (!fs::exists(path_ / "job")) return std::nullopt;
  const std::string text = text_of(path_ / "job");
  std::int64_t id = 0;
  const char* const end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, id);
  const bool whole = parsed.ec == std::errc() && std::string_view(parsed.ptr, end) == "\n";
  return whole && id > 0 ? std::optional(id) : std::nullopt;
}

void ArrayFolder::set_job(std::int64_t job) const {
  write_whole_file(path_ / "job", as_bytes(fmt::format("{}\n", job)), Durability::rename_only);
}

}  // namespace voxweld
