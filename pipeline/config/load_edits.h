// The [[edit]] tables of a config file.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "pipeline/config/config.h"
#include "pipeline/config/document.h"

namespace voxweld {

class EditReader {
 public:
  // The entries of the whole file, which must live as long; `file` names it in messages.
  EditReader(std::span<const DocumentEntry> entries, std::string file);

  // Whether the entry is of edits, rightly written or not.
  static bool owns(const DocumentEntry& entry);
  // Appends the edit of which the entry is the header; its keys are passed over, they are read with
  // it. Throws InputError where something is wrong. Precondition: owns(entry).
  void read(const DocumentEntry& entry, std::vector<EditConfig>& edits) const;

 private:
  std::string file_;
  std::map<std::size_t, std::vector<const DocumentEntry*>> keys_;  // by the number of the edit
};

}  // namespace voxweld
