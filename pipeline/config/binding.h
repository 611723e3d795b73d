// How a member of a config is read from a value and written as one: what a row of the table of
// settings, or of the keys of an edit or a filter, is bound to.
#pragma once

#include <algorithm>
#include <array>
#include <filesystem>
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
template <class Owner>
struct Binding {
  Rule rule;
  std::function<void(Owner&, const ConfigValue&)> set;
  std::function<std::optional<ConfigValue>(const Owner&)> get;
};

// Empty where the member leaves it open.
using Written = std::optional<ConfigValue>;

// What a value stands for and the value of a member in its one canonical form, by the member's type.
// Precondition: a value that is read is of that form.
struct Form {
  using Path = std::filesystem::path;
  using Value = const ConfigValue&;
  using Texts = std::vector<std::string>;
  using Pair = std::array<double, 2>;

  static void read(Value v, bool& out) { out = *v.flag(); }
  static void read(Value v, std::int64_t& out) { out = *v.integer(); }
  static void read(Value v, std::uint64_t& out) { out = static_cast<std::uint64_t>(*v.integer()); }
  static void read(Value v, double& out) { out = v.number(); }
  static void read(Value v, std::string& out) { out = *v.text(); }
  static void read(Value v, Path& out) { out = *v.text(); }
  static void read(Value v, SampleType& out) { out = parse_sample_type(*v.text()).value(); }
  static void read(Value v, Texts& out);
  static void read(Value v, Pair& out);
  // Three numbers, or one for all three.
  static void read(Value v, Index3& out);
  static void read(Value v, Vec3& out);
  static void read(Value v, Box3& out);
  template <class T>
  static void read(Value v, std::optional<T>& out) {
    read(v, out.emplace());
  }

  static Written written(bool v) { return ConfigValue{v}; }
  static Written written(std::int64_t v) { return ConfigValue{v}; }
  static Written written(std::uint64_t v) { return ConfigValue{static_cast<std::int64_t>(v)}; }
  static Written written(double v) { return ConfigValue{v}; }
  static Written written(const std::string& v) { return ConfigValue{v}; }
  static Written written(const Path& v);  // empty: open
  static Written written(SampleType v) { return ConfigValue{std::string(sample_type_name(v))}; }
  static Written written(const Texts& v);
  static Written written(Pair v) { return ConfigValue{ConfigValue::List{{v[0]}, {v[1]}}}; }
  static Written written(Index3 v) { return ConfigValue{ConfigValue::List{{v.x}, {v.y}, {v.z}}}; }
  static Written written(Vec3 v) { return ConfigValue{ConfigValue::List{{v.x}, {v.y}, {v.z}}}; }
  static Written written(const Box3& v);
  template <class T>
  static Written written(const std::optional<T>& v) {
    return v ? written(*v) : std::nullopt;
  }
};

// at(owner) is the member; read(value, member) and written(member) as those of Form.
template <class Owner, class At, class Read, class Write>
Binding<Owner> bound(Rule rule, At at, Read read, Write written) {
  return {std::move(rule), [=](Owner& owner, const ConfigValue& value) { read(value, at(owner)); },
          [=](const Owner& owner) -> Written { return written(at(owner)); }};
}
template <class Owner, class At>
Binding<Owner> bound(Rule rule, At at) {
  return bound<Owner>(
      std::move(rule), at,
      [](const ConfigValue& value, auto& member) { Form::read(value, member); },
      [](const auto& member) { return Form::written(member); });
}

// An enumeration: names[i] is the name of the enumerator i.
template <class Owner, class At>
Binding<Owner> bound_choice(const std::vector<std::string>& names, At at) {
  return bound<Owner>(
      ChoiceRule{names}, at,
      [names](const ConfigValue& value, auto& member) {
        const auto found = std::ranges::find(names, *value.text());
        member = static_cast<std::remove_reference_t<decltype(member)>>(found - names.begin());
      },
      [names](auto member) { return ConfigValue{names[static_cast<std::size_t>(member)]}; });
}

// Members of a group of the config.
template <class Group, class T>
auto place(Group Config::*group, T Group::*member) {
  return [=](auto& config) -> auto& {
    return config.*group.*member;
  };
}

// Of a form that goes with the member's type.
template <class Group, class T>
Binding<Config> member(Group Config::*group, T Group::*member, Rule rule) {
  return bound<Config>(std::move(rule), place(group, member));
}

template <class Group, class Enum>
Binding<Config> choice(Group Config::*group, Enum Group::*member, std::vector<std::string> names) {
  return bound_choice<Config>(std::move(names), place(group, member));
}

// The same; where it is the first of the names the config leaves it open.
template <class Group, class Enum>
Binding<Config> choice_or_open(Group Config::*group, Enum Group::*member,
                               std::vector<std::string> names) {
  Binding<Config> bound = choice(group, member, std::move(names));
  bound.get = [get = bound.get, group, member](const Config& config) -> Written {
    return config.*group.*member == Enum{} ? std::nullopt : get(config);
  };
  return bound;
}

// Enumerators in the order automatic, always, never.
template <class Group, class Enum>
Binding<Config> switch_of(Group Config::*group, Enum Group::*member) {
  return bound<Config>(
      SwitchRule{}, place(group, member),
      [](const ConfigValue& value, Enum& out) {
        out = value.flag() == nullptr ? Enum::automatic
              : *value.flag()         ? Enum::always
                                      : Enum::never;
      },
      [](Enum in) {
        return in == Enum::automatic ? ConfigValue{std::string("auto")}
                                     : ConfigValue{in == Enum::always};
      });
}

// The value 0 is "auto", whatever the range.
template <class Group>
Binding<Config> integer_or_auto(Group Config::*group, std::int64_t Group::*member,
                                IntegerRule rule) {
  rule.automatic = true;
  return bound<Config>(
      rule, place(group, member),
      [](const ConfigValue& value, std::int64_t& out) {
        out = value.integer() == nullptr ? 0 : *value.integer();
      },
      [](std::int64_t in) { return in == 0 ? ConfigValue{std::string("auto")} : ConfigValue{in}; });
}

// A size in bytes. Where the rule has "auto", 0 is that.
template <class Group>
Binding<Config> memory(Group Config::*group, std::uint64_t Group::*member, MemoryRule rule) {
  return bound<Config>(
      rule, place(group, member),
      [](const ConfigValue& value, std::uint64_t& out) {
        out = value.text() != nullptr ? parse_bytes(*value.text()).value_or(0)
                                      : static_cast<std::uint64_t>(*value.integer());
      },
      [rule](std::uint64_t in) {
        return ConfigValue{rule.automatic && in == 0 ? "auto" : bytes_text(in)};
      });
}

// Members of their own form.
Binding<Config> input_format();
Binding<Config> unit();
// input.dataset and input.series: empty where it is open.
Binding<Config> selected(std::string InputSelection::*text);
// input.level, input.channel and input.time.
Binding<Config> selected(std::optional<std::int64_t> InputSelection::*number);
Binding<Config> raw_type();
// By their names.
ChoiceRule sample_types();
Binding<Config> isovalue();
Binding<Config> surface_label();
Binding<Config> selected_labels();
Binding<Config> background();
Binding<Config> formats();

}  // namespace voxweld::binding
