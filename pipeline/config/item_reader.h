// The tables of a list in a config file, such as [[edit]], read by the table of their keys.
#pragma once

#include <fmt/format.h>

#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/config/cross_checks.h"
#include "pipeline/config/document.h"
#include "pipeline/config/item_settings.h"
#include "pipeline/config/refuse.h"

namespace voxweld {

// One item of a file: what its messages name it by, and its keys in the order they are written.
struct WrittenItem {
  const std::string& file;
  const std::string& table;  // "edit"
  std::size_t number;        // from 1
  TextPlace header_at;
  std::vector<const DocumentEntry*> keys{};

  std::string name() const { return fmt::format("{} {}", table, number); }
  // Null where it is not written.
  const DocumentEntry* find(std::string_view key) const;
  [[noreturn]] void fail(TextPlace at, const std::string& problem) const;

  // takes: what follows "A sphere takes", of which `names` are the nearest to look among.
  [[noreturn]] void fail_unknown(const DocumentEntry& entry, const std::vector<std::string>& names,
                                 const std::string& takes) const;
  // Throws InputError unless the key takes the value; paths come back absolute.
  ConfigValue accepted(const KeyFacts& key, const DocumentEntry& entry) const;
};

// Whether the entry is of the tables [[table]], rightly written or not.
bool is_of_items(std::string_view table, const DocumentEntry& entry);

// The entries of a whole file that are of one list's items.
class ItemEntries {
 public:
  // The entries must live as long; `file` names them in messages.
  ItemEntries(std::string table, std::span<const DocumentEntry> entries, std::string file);

  bool owns(const DocumentEntry& entry) const { return is_of_items(table_, entry); }
  // The item of which the entry is the header; empty of its keys, and of a list of none. InputError
  // where the entry is no header of such an item. Precondition: owns(entry).
  std::optional<WrittenItem> item(const DocumentEntry& entry,
                                  const std::vector<std::string>& all_keys) const;

 private:
  std::string table_, file_;
  std::map<std::size_t, std::vector<const DocumentEntry*>> keys_;  // by the number of the item
};

template <class Item, class Kind>
class ItemReader {
 public:
  using Table = ItemTable<Item, Kind>;
  // What looks at several keys of an item, after each was found right by itself.
  using Check = void (*)(const WrittenItem&, const Item&);

  ItemReader(const Table& table, std::span<const DocumentEntry> entries, std::string file,
             Check check)
      : table_(table), entries_(table.name, entries, std::move(file)), check_(check) {}

  bool owns(const DocumentEntry& entry) const { return entries_.owns(entry); }

  // Appends the item of which the entry is the header, and notes its place by its name ("edit 2");
  // its keys are passed over, they are read with it. Throws InputError where something is wrong.
  // Precondition: owns(entry).
  void read(const DocumentEntry& entry, std::vector<Item>& items, Places& places) const {
    const auto written = entries_.item(entry, table_.key_names());
    if (!written) return;
    Item item;
    const auto kind = kind_of(*written);
    for (const DocumentEntry* key : written->keys) read_key(*written, *key, kind, item);
    check_required(*written, item);
    check_(*written, item);
    items.push_back(std::move(item));
    places[written->name()] = place_text(written->file, written->header_at);
  }

 private:
  // Empty where the kind is missing or wrong, which is told of later.
  std::optional<Kind> kind_of(const WrittenItem& written) const {
    const auto& setting = *table_.find(table_.kind_key);
    const DocumentEntry* entry = written.find(setting.key);
    if (entry == nullptr || !check(setting.rule, entry->value).accepted) return std::nullopt;
    Item item;
    setting.set(item, entry->value);
    return item.*table_.kind;
  }

  std::string what_it_takes(std::optional<Kind> kind) const {
    std::string who = kind ? one(*kind) : table_.one;
    who.front() = 'A';
    return fmt::format("{} takes {}", who, joined(table_.key_names(kind)));
  }
  std::string one(Kind kind) const {
    return fmt::format("a {}{}", table_.kind_name(kind), table_.noun);
  }

  // Without a kind the keys of all are taken.
  void read_key(const WrittenItem& written, const DocumentEntry& entry, std::optional<Kind> kind,
                Item& item) const {
    const auto* setting = table_.find(entry.key);
    if (setting == nullptr)
      written.fail_unknown(entry, table_.key_names(kind), what_it_takes(kind));
    if (kind && !setting->taken_by(*kind))
      written.fail(entry.key_at,
                   fmt::format("{} has no {}. {}", one(*kind), setting->key, what_it_takes(kind)));
    setting->set(item, written.accepted(*setting, entry));
  }

  void check_required(const WrittenItem& written, const Item& item) const {
    for (const auto& setting : table_.settings)
      if (setting.required_by(item.*table_.kind) && written.find(setting.key) == nullptr)
        written.fail(written.header_at,
                     fmt::format("missing key {} (expected {}): {}", setting.key,
                                 accepted_text(setting.rule), setting.description));
  }

  const Table& table_;
  ItemEntries entries_;
  Check check_;
};

}  // namespace voxweld
