#include "storage/store/byte_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <system_error>

#include "storage/support/error.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t largest_text = std::uint64_t{64} << 20;

class FileObject final : public StoredObject {
 public:
  explicit FileObject(const fs::path& path) : file_(path) {}
  const std::string& name() const override { return file_.path(); }
  std::uint64_t size() const override { return file_.size(); }
  void read(std::uint64_t offset, std::span<std::byte> out) const override {
    file_.read(offset, out);
  }

 private:
  ReadFile file_;
};

class HeldObject final : public StoredObject {
 public:
  HeldObject(std::string name, std::vector<std::byte> bytes)
      : name_(std::move(name)), bytes_(std::move(bytes)) {}
  const std::string& name() const override { return name_; }
  std::uint64_t size() const override { return bytes_.size(); }
  void read(std::uint64_t offset, std::span<std::byte> out) const override {
    require_range(*this, offset, out.size());
    if (!out.empty()) std::memcpy(out.data(), bytes_.data() + offset, out.size());
  }

 private:
  std::string name_;
  std::vector<std::byte> bytes_;
};

class FolderStore final : public ByteStore {
 public:
  explicit FolderStore(fs::path root) : root_(std::move(root)) {}

  std::string name() const override { return root_.string(); }
  std::unique_ptr<StoredObject> open(const std::string& key, ObjectUse /*use*/) const override {
    const fs::path path = path_of(key);
    std::error_code error;
    if (!fs::exists(path, error)) {
      if (error) throw_errno("look up", path.string(), error.value());
      return nullptr;
    }
    return std::make_unique<FileObject>(path);
  }
  bool holds(const std::string& key) const override {
    std::error_code ignored;
    return fs::exists(path_of(key), ignored);
  }
  std::optional<std::vector<std::string>> list(const std::string& folder) const override {
    std::vector<std::string> names;
    std::error_code error;
    for (fs::directory_iterator entry(path_of(folder), error), end; !error && entry != end;
         entry.increment(error))
      names.push_back(entry->path().filename().string());
    std::ranges::sort(names);
    return names;
  }
  std::optional<fs::path> file_of(const std::string& key) const override { return path_of(key); }
  InputFile input_file(const std::string& key) const override {
    const ReadFile file(path_of(key));
    return {file.path(), file.state()};
  }
  Above above() const override {
    fs::path path = fs::absolute(root_).lexically_normal();
    if (!path.has_filename()) path = path.parent_path();
    if (!path.has_relative_path()) return {};
    return {std::make_shared<FolderStore>(path.parent_path()), path.filename().string()};
  }

 private:
  fs::path path_of(const std::string& key) const { return key.empty() ? root_ : root_ / key; }

  fs::path root_;
};

}  // namespace

void require_range(const StoredObject& object, std::uint64_t offset, std::uint64_t bytes) {
  if (offset <= object.size() && bytes <= object.size() - offset) return;
  throw FormatError(fmt::format("{}: truncated: {} bytes wanted at {}, it has {}", object.name(),
                                bytes, offset, object.size()));
}

std::unique_ptr<StoredObject> held_object(std::string name, std::vector<std::byte> bytes) {
  return std::make_unique<HeldObject>(std::move(name), std::move(bytes));
}

std::shared_ptr<const ByteStore> folder_store(const fs::path& directory) {
  return std::make_shared<FolderStore>(directory);
}

std::string StoreFolder::at(const std::string& name) const {
  if (key_.empty() || name.empty()) return key_ + name;
  return key_ + '/' + name;
}

std::string StoreFolder::name() const {
  return key_.empty() ? store_->name() : (fs::path(store_->name()) / key_).string();
}

std::optional<std::string> StoreFolder::text(const std::string& name) const {
  const auto object = open(name, ObjectUse::whole);
  if (!object) return std::nullopt;
  if (object->size() > largest_text)
    throw FormatError(fmt::format("{}: has {} bytes, and such a file at most 64 MiB",
                                  object->name(), object->size()));
  std::string text(object->size(), '\0');
  object->read(0, std::as_writable_bytes(std::span(text)));
  return text;
}

std::optional<StoreFolder::Above> StoreFolder::above() const {
  if (!key_.empty()) {
    const auto cut = key_.rfind('/');
    if (cut == std::string::npos) return Above{StoreFolder(store_), key_};
    return Above{StoreFolder(store_, key_.substr(0, cut)), key_.substr(cut + 1)};
  }
  auto [store, name] = store_->above();
  if (!store) return std::nullopt;
  return Above{StoreFolder(std::move(store)), std::move(name)};
}

std::optional<std::string> key_of(const std::string& path) {
  if (path.starts_with('/')) return std::nullopt;
  std::string key;
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('/', begin), path.size());
    const std::string part = path.substr(begin, end - begin);
    if (part == "..") return std::nullopt;
    if (!part.empty() && part != ".") {
      if (!key.empty()) key += '/';
      key += part;
    }
    begin = end + 1;
  }
  return key;
}

}  // namespace voxweld
