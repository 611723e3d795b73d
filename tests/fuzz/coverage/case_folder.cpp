// The files of one input.
#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>
#include <stdexcept>

#include "tests/fuzz/coverage/entries.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view mark = "@@file ";
constexpr std::size_t most_files = 64, longest_name = 100;

class CaseFolder {
 public:
  CaseFolder() {
    std::string name = (fs::temp_directory_path() / "voxweld-parse-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make a folder " + name);
    path_ = name;
  }
  ~CaseFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  CaseFolder(const CaseFolder&) = delete;
  CaseFolder& operator=(const CaseFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

// Not fs::path's own functions: the folder is left and made some thousand times a second.
void write_file(const fs::path& path, std::string_view bytes) {
  const auto close = [](std::FILE* file) { std::fclose(file); };
  const std::unique_ptr<std::FILE, decltype(close)> file(std::fopen(path.c_str(), "wb"), close);
  if (!file || std::fwrite(bytes.data(), 1, bytes.size(), file.get()) != bytes.size())
    throw std::runtime_error("cannot write " + path.string());
}

// Relative, in plain characters, and nowhere above.
bool is_usable(std::string_view name) {
  if (name.empty() || name.size() > longest_name || name.front() == '/') return false;
  if (name.find("..") != name.npos || name.back() == '/') return false;
  for (const char c : name)
    if (c <= ' ' || c > '~' || c == '\\') return false;
  return true;
}

// The name of the file whose part of a bundle begins at `at`, and where its bytes do.
struct PartHead {
  std::string_view name;
  std::size_t begin = 0;
};
std::optional<PartHead> part_at(std::string_view text, std::size_t at) {
  const std::size_t end = text.find('\n', at);
  if (end == text.npos) return std::nullopt;
  const std::string_view name = text.substr(at + mark.size(), end - at - mark.size());
  if (!is_usable(name)) return std::nullopt;
  return PartHead{name, end + 1};
}

// Files that cannot be made (a name that is a folder already) are left out.
void unpack(std::string_view text, const fs::path& folder) {
  const std::string next = fmt::format("\n{}", mark);
  std::size_t count = 0;
  for (std::size_t at = 0; at < text.size() && count < most_files; ++count) {
    const std::size_t end = std::min(text.find(next, at), text.size());
    if (const auto head = part_at(text, at); head && head->begin <= end) {
      std::error_code none;
      const fs::path path = folder / head->name;
      fs::create_directories(path.parent_path(), none);
      if (!none && !fs::is_directory(path, none))
        write_file(path, text.substr(head->begin, end - head->begin));
    }
    at = end + 1;
  }
}

}  // namespace

fs::path case_folder() {
  static const CaseFolder folder;
  return folder.path();
}

fs::path write_case(Bytes bytes, const std::string& ending) {
  static bool tidy = true;  // nothing there but the file of one name
  const fs::path folder = case_folder();
  if (!tidy) {
    for (const auto& entry : fs::directory_iterator(folder)) fs::remove_all(entry.path());
    tidy = true;
  }
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const auto head = text.starts_with(mark) ? part_at(text, 0) : std::nullopt;
  if (!head) {
    fs::path path = folder / fmt::format("v{}", ending);
    write_file(path, text);
    return path;
  }
  tidy = false;
  unpack(text, folder);
  return folder / head->name.substr(0, head->name.find('/'));
}

std::string bundle_of(const std::vector<std::pair<std::string, std::string>>& files) {
  std::string text;
  for (const auto& [name, bytes] : files) {
    if (!is_usable(name)) throw std::logic_error("a bundle cannot name " + name);
    if (!text.empty()) text += '\n';
    text += fmt::format("{}{}\n{}", mark, name, bytes);
  }
  return text;
}

}  // namespace voxweld::testing
