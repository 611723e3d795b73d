// Names of files, any number of them in bounded memory, each once however often it is given.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "storage/support/record_sorter.h"

namespace voxweld {

class FileNames {
 public:
  // scratch: a folder for those that do not fit memory.
  explicit FileNames(const std::filesystem::path& scratch);

  void add(std::string_view name) { push(name, false); }
  // Takes a name out, wherever it was or will be added.
  void leave_out(std::string_view name) { push(name, true); }

  // After the last: f of each name that is left. The order depends on the names alone.
  void each(const std::function<void(const std::string&)>& f);

 private:
  void push(std::string_view name, bool out);

  RecordSorter names_;
  std::vector<std::byte> record_;
};

}  // namespace voxweld
