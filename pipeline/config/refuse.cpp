#include "pipeline/config/refuse.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "storage/support/error.h"

namespace voxweld {

std::string joined(const std::vector<std::string>& names) {
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string shown(const std::string& name) {
  const std::string text = toml_string_short(name);
  return text.substr(1, text.size() - 2);
}

std::string did_you_mean(const std::string& name) {
  return name.empty() ? "" : "; did you mean " + name + "?";
}

void require_accepted(const std::string& where, const std::string& name, const KeyFacts& key,
                      const ConfigValue& value) {
  const Verdict verdict = check(key.rule, value);
  if (verdict.accepted) return;
  const std::string by_default =
      key.required ? "" : fmt::format(" (default: {})", key.default_text());
  throw InputError(fmt::format("{}: {}: expected {}{}, found {}{}{}", where, name,
                               accepted_text(key.rule), by_default, describe(value),
                               verdict.hint.empty() ? "" : "; ", verdict.hint));
}

}  // namespace voxweld
