// Where the pieces of an array lie: named ranges of bytes, in a folder, in a zip file, or elsewhere.
// Names (keys) are paths with "/", without one in front: "0/c/1/2/3".
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "storage/types/volume.h"

namespace voxweld {

// One named piece, open for reading by many threads.
class StoredObject {
 public:
  virtual ~StoredObject() = default;
  virtual const std::string& name() const = 0;  // for messages
  virtual std::uint64_t size() const = 0;       // bytes
  // Exactly out.size() bytes from `offset` on. FormatError where it ends before.
  virtual void read(std::uint64_t offset, std::span<std::byte> out) const = 0;
};

// FormatError unless the object has so many bytes from `offset` on.
void require_range(const StoredObject& object, std::uint64_t offset, std::uint64_t bytes);

// An object whose bytes are all in memory.
std::unique_ptr<StoredObject> held_object(std::string name, std::vector<std::byte> bytes);

// What will be read of an object: a store that is far away may fetch all of it at once.
enum class ObjectUse : std::uint8_t { whole, ranges };

class ByteStore {
 public:
  virtual ~ByteStore() = default;

  virtual std::string name() const = 0;  // for messages: of the folder or file
  // Null where there is no such object.
  virtual std::unique_ptr<StoredObject> open(const std::string& key, ObjectUse use) const = 0;
  virtual bool holds(const std::string& key) const = 0;
  // The names of what is in the folder, sorted; nothing where the store cannot tell.
  virtual std::optional<std::vector<std::string>> list(const std::string& folder) const = 0;
  // The most bytes of memory that one open object below the folder takes.
  virtual std::uint64_t object_memory(const std::string& /*folder*/) const { return 0; }
  // The file of its own that the object is, or would be; nothing where it is part of another.
  virtual std::optional<std::filesystem::path> file_of(const std::string& key) const = 0;
  // The file that the bytes of the object lie in, as it is now.
  virtual InputFile input_file(const std::string& key) const = 0;
  // What the store as a whole lies in, and what it is called there; null: nothing is known of it.
  struct Above {
    std::shared_ptr<const ByteStore> store;
    std::string name;
  };
  virtual Above above() const { return {}; }
};

// The files below a directory. An object is a file.
std::shared_ptr<const ByteStore> folder_store(const std::filesystem::path& directory);

// A folder of a store.
class StoreFolder {
 public:
  explicit StoreFolder(std::shared_ptr<const ByteStore> store, std::string key = {})
      : store_(std::move(store)), key_(std::move(key)) {}

  StoreFolder operator/(const std::string& name) const { return StoreFolder(store_, at(name)); }
  const std::string& key() const { return key_; }  // within the store
  std::string name() const;                        // for messages
  const ByteStore& store() const { return *store_; }

  std::unique_ptr<StoredObject> open(const std::string& name, ObjectUse use) const {
    return store_->open(at(name), use);
  }
  bool holds(const std::string& name) const { return store_->holds(at(name)); }
  // The whole of a small object; nothing where there is none. FormatError for one over 64 MiB.
  std::optional<std::string> text(const std::string& name) const;
  std::optional<std::vector<std::string>> list() const { return store_->list(key_); }
  std::optional<std::filesystem::path> file_of(const std::string& name) const {
    return store_->file_of(at(name));
  }
  InputFile input_file(const std::string& name) const { return store_->input_file(at(name)); }
  std::uint64_t object_memory() const { return store_->object_memory(key_); }

  // The folder that this one lies in, and its own name there.
  struct Above;
  std::optional<Above> above() const;

 private:
  std::string at(const std::string& name) const;

  std::shared_ptr<const ByteStore> store_;
  std::string key_;
};

struct StoreFolder::Above {
  StoreFolder folder;
  std::string name;
};

// A path as a key: without empty parts and ".". Nothing where it is absolute or has "..".
std::optional<std::string> key_of(const std::string& path);

}  // namespace voxweld
