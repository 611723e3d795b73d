// The rows of a table of items: what edit_settings.cpp and filter_settings.cpp make them of.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "pipeline/config/binding.h"
#include "pipeline/config/item_settings.h"

namespace voxweld::item_rows {

struct ItemWords {
  const char* key;
  const char* description;
  const char* sample;
};

template <class Item, class Kind>
ItemSetting<Item, Kind> row(ItemWords words, const binding::Binding<Item>& bound,
                            std::vector<Kind> kinds = {}) {
  return {{words.key, bound.rule, words.description, false, {}, bound.get(Item{})},
          std::move(kinds),
          {},
          words.sample,
          bound.set,
          bound.get};
}

template <class Item, class Kind>
ItemSetting<Item, Kind> required(ItemSetting<Item, Kind> setting) {
  setting.required = true;
  setting.default_note = "required";
  return setting;
}

// An item may have no value for it; the note says what that means.
template <class Item, class Kind>
ItemSetting<Item, Kind> open(const char* note, ItemSetting<Item, Kind> setting) {
  setting.default_value.reset();
  setting.default_note = note;
  return setting;
}

// The member of an item, for a binding.
template <class Item, class T>
auto place(T Item::*member) {
  return [=](auto& item) -> auto& {
    return item.*member;
  };
}

template <class Item, class T>
binding::Binding<Item> member(T Item::*member, Rule rule) {
  return binding::bound<Item>(std::move(rule), place(member));
}

template <class Item, class Enum>
binding::Binding<Item> choice(Enum Item::*member, const std::vector<std::string>& names) {
  return binding::bound_choice<Item>(names, place(member));
}

}  // namespace voxweld::item_rows
