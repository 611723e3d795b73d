// How each member of Config is read from a value and written as one: what a row of the table of
// settings is bound to.
#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/config/config.h"
#include "pipeline/config/config_value.h"
#include "pipeline/config/rule.h"

namespace voxweld::binding {

// The rule says which values `set` can be given.
struct Binding {
  Rule rule;
  std::function<void(Config&, const ConfigValue&)> set;
  std::function<std::optional<ConfigValue>(const Config&)> get;
};

// Members of their own form.
Binding input_format();
Binding crop();
Binding spacing();
Binding unit();
Binding raw_size();
Binding raw_type();
Binding isovalue();
Binding label();
Binding selected_labels();
Binding background();
Binding formats();

// Members of a common form, named by their group and member.
template <class Group, class T>
using Field = std::pair<Group Config::*, T Group::*>;

template <class T, class Group>
T& at(Config& config, const Field<Group, T>& field) {
  return (config.*field.first).*field.second;
}
template <class T, class Group>
const T& at(const Config& config, const Field<Group, T>& field) {
  return (config.*field.first).*field.second;
}

inline std::size_t index_of(const std::vector<std::string>& names, const std::string& name) {
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

template <class Group>
Binding path(Group Config::*group, std::filesystem::path Group::*member) {
  const Field<Group, std::filesystem::path> field{group, member};
  return {PathRule{}, [=](Config& c, const ConfigValue& v) { at(c, field) = *v.text(); },
          [=](const Config& c) -> std::optional<ConfigValue> {
            if (at(c, field).empty()) return std::nullopt;
            return ConfigValue{at(c, field).string()};
          }};
}

// names[i] is the name of the enumerator i.
template <class Group, class Enum>
Binding choice(Group Config::*group, Enum Group::*member, std::vector<std::string> names) {
  const Field<Group, Enum> field{group, member};
  return {ChoiceRule{names},
          [=](Config& c, const ConfigValue& v) {
            at(c, field) = static_cast<Enum>(index_of(names, *v.text()));
          },
          [=](const Config& c) -> std::optional<ConfigValue> {
            return ConfigValue{names[static_cast<std::size_t>(at(c, field))]};
          }};
}

// Enumerators in the order automatic, always, never.
template <class Group, class Enum>
Binding switch_of(Group Config::*group, Enum Group::*member) {
  const Field<Group, Enum> field{group, member};
  return {SwitchRule{},
          [=](Config& c, const ConfigValue& v) {
            at(c, field) = v.flag() == nullptr ? Enum::automatic
                           : *v.flag()         ? Enum::always
                                               : Enum::never;
          },
          [=](const Config& c) -> std::optional<ConfigValue> {
            if (at(c, field) == Enum::automatic) return ConfigValue{std::string("auto")};
            return ConfigValue{at(c, field) == Enum::always};
          }};
}

template <class Group>
Binding flag(Group Config::*group, bool Group::*member) {
  const Field<Group, bool> field{group, member};
  return {FlagRule{}, [=](Config& c, const ConfigValue& v) { at(c, field) = *v.flag(); },
          [=](const Config& c) -> std::optional<ConfigValue> { return ConfigValue{at(c, field)}; }};
}

template <class Group>
Binding integer(Group Config::*group, std::int64_t Group::*member, Rule rule) {
  const Field<Group, std::int64_t> field{group, member};
  return {std::move(rule), [=](Config& c, const ConfigValue& v) { at(c, field) = *v.integer(); },
          [=](const Config& c) -> std::optional<ConfigValue> { return ConfigValue{at(c, field)}; }};
}

// The value 0 is "auto", whatever the range.
template <class Group>
Binding integer_or_auto(Group Config::*group, std::int64_t Group::*member, IntegerRule rule) {
  const Field<Group, std::int64_t> field{group, member};
  rule.automatic = true;
  return {rule,
          [=](Config& c, const ConfigValue& v) {
            at(c, field) = v.integer() == nullptr ? 0 : *v.integer();
          },
          [=](const Config& c) -> std::optional<ConfigValue> {
            if (at(c, field) == 0) return ConfigValue{std::string("auto")};
            return ConfigValue{at(c, field)};
          }};
}

// A size in bytes. Where the rule has "auto", 0 is that.
template <class Group>
Binding memory(Group Config::*group, std::uint64_t Group::*member, MemoryRule rule) {
  const Field<Group, std::uint64_t> field{group, member};
  return {rule,
          [=](Config& c, const ConfigValue& v) {
            at(c, field) = v.text() != nullptr ? parse_bytes(*v.text()).value_or(0)
                                               : static_cast<std::uint64_t>(*v.integer());
          },
          [=](const Config& c) -> std::optional<ConfigValue> {
            if (rule.automatic && at(c, field) == 0) return ConfigValue{std::string("auto")};
            return ConfigValue{bytes_text(at(c, field))};
          }};
}

template <class Group>
Binding text(Group Config::*group, std::string Group::*member, Rule rule) {
  const Field<Group, std::string> field{group, member};
  return {std::move(rule), [=](Config& c, const ConfigValue& v) { at(c, field) = *v.text(); },
          [=](const Config& c) -> std::optional<ConfigValue> { return ConfigValue{at(c, field)}; }};
}

template <class Group>
Binding texts(Group Config::*group, std::vector<std::string> Group::*member, Rule rule) {
  const Field<Group, std::vector<std::string>> field{group, member};
  return {std::move(rule),
          [=](Config& c, const ConfigValue& v) {
            at(c, field).clear();
            for (const ConfigValue& item : *v.list()) at(c, field).push_back(*item.text());
          },
          [=](const Config& c) -> std::optional<ConfigValue> {
            ConfigValue::List list;
            for (const std::string& item : at(c, field)) list.push_back({item});
            return ConfigValue{std::move(list)};
          }};
}

// Without a default: empty unless it is given.
template <class Group>
Binding optional(Group Config::*group, std::optional<std::int64_t> Group::*member,
                 IntegerRule rule) {
  const Field<Group, std::optional<std::int64_t>> field{group, member};
  return {rule, [=](Config& c, const ConfigValue& v) { at(c, field) = *v.integer(); },
          [=](const Config& c) -> std::optional<ConfigValue> {
            if (!at(c, field)) return std::nullopt;
            return ConfigValue{*at(c, field)};
          }};
}

template <class Group>
Binding optional_positive(Group Config::*group, std::optional<double> Group::*member) {
  const Field<Group, std::optional<double>> field{group, member};
  return {PositiveNumberRule{}, [=](Config& c, const ConfigValue& v) { at(c, field) = v.number(); },
          [=](const Config& c) -> std::optional<ConfigValue> {
            if (!at(c, field)) return std::nullopt;
            return ConfigValue{*at(c, field)};
          }};
}

template <class Group>
Binding positive(Group Config::*group, double Group::*member) {
  const Field<Group, double> field{group, member};
  return {PositiveNumberRule{}, [=](Config& c, const ConfigValue& v) { at(c, field) = v.number(); },
          [=](const Config& c) -> std::optional<ConfigValue> { return ConfigValue{at(c, field)}; }};
}

}  // namespace voxweld::binding
