#include "pipeline/config/item_reader.h"

#include <algorithm>
#include <filesystem>

#include "pipeline/config/suggest.h"
#include "storage/support/error.h"

namespace voxweld {

const DocumentEntry* WrittenItem::find(std::string_view key) const {
  const auto found =
      std::ranges::find_if(keys, [&](const DocumentEntry* entry) { return entry->key == key; });
  return found == keys.end() ? nullptr : *found;
}

void WrittenItem::fail(TextPlace at, const std::string& problem) const {
  throw InputError(fmt::format("{}: {}: {}", place_text(file, at), name(), problem));
}

void WrittenItem::fail_unknown(const DocumentEntry& entry, const std::vector<std::string>& names,
                               const std::string& takes) const {
  const std::string nearest = nearest_name(entry.key, names);
  fail(entry.key_at, fmt::format("unknown key {}{} {}", shown(entry.key),
                                 nearest.empty() ? "." : did_you_mean(nearest), takes));
}

ConfigValue WrittenItem::accepted(const KeyFacts& key, const DocumentEntry& entry) const {
  require_accepted(place_text(file, entry.value_at), fmt::format("{}: {}", name(), key.key), key,
                   entry.value);
  if (!std::holds_alternative<PathRule>(key.rule)) return entry.value;
  const auto folder = std::filesystem::absolute(file).parent_path();
  return {(folder / *entry.value.text()).lexically_normal().string()};
}

bool is_of_items(std::string_view table, const DocumentEntry& entry) {
  return entry.table == table || (entry.table.empty() && entry.key == table);
}

ItemEntries::ItemEntries(std::string table, std::span<const DocumentEntry> entries,
                         std::string file)
    : table_(std::move(table)), file_(std::move(file)) {
  for (const DocumentEntry& entry : entries)
    if (owns(entry) && entry.item > 0 && !entry.key.empty()) keys_[entry.item].push_back(&entry);
}

std::optional<WrittenItem> ItemEntries::item(const DocumentEntry& entry,
                                             const std::vector<std::string>& all_keys) const {
  const std::string where = place_text(file_, entry.key_at);
  if (entry.table.empty()) {
    // The other way TOML has to write that there are none.
    if (entry.value.list() != nullptr && entry.value.list()->empty()) return std::nullopt;
    throw InputError(fmt::format("{}: expected tables [[{}]] with keys {}, found {}", where, table_,
                                 joined(all_keys), describe(entry.value)));
  }
  if (entry.item == 0)
    throw InputError(fmt::format(
        "{0}: found a single table [{1}]; write [[{1}]], which may stand any number of times",
        where, table_));
  if (!entry.key.empty()) return std::nullopt;
  WrittenItem written{file_, table_, entry.item, entry.key_at};
  if (const auto keys = keys_.find(entry.item); keys != keys_.end()) written.keys = keys->second;
  return written;
}

}  // namespace voxweld
