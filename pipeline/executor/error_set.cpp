#include "pipeline/executor/error_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <new>
#include <tuple>

#include "storage/support/refused_text.h"

namespace voxweld {
namespace {

// Units named on one line of equal messages before the rest is counted only.
constexpr std::size_t named_units = 4;

std::string join_units(const std::vector<std::string>& units) {
  std::string text;
  for (std::size_t i = 0; i < std::min(units.size(), named_units); ++i)
    text += (i == 0 ? "" : ", ") + units[i];
  if (units.size() > named_units) text += fmt::format(" and {} more", units.size() - named_units);
  return text;
}

// One line a distinct message, in the order of its first unit.
std::string describe(const std::string& stage, const std::vector<UnitError>& errors) {
  std::map<std::string, std::size_t> line_of;
  std::vector<std::pair<std::string, std::vector<std::string>>> lines;
  std::size_t failed = 0;
  bool interrupted = false;
  for (const UnitError& error : errors) {
    if (error.interrupted) {
      interrupted = true;
      continue;
    }
    ++failed;
    const auto [found, is_new] = line_of.emplace(error.message, lines.size());
    if (is_new) lines.push_back({error.message, {}});
    lines[found->second].second.push_back(error.unit);
  }
  std::string text = fmt::format("{}: {} failed:", stage,
                                 failed == 1 ? "1 unit" : fmt::format("{} units", failed));
  for (const auto& [message, units] : lines)
    text += fmt::format("\n  {}: {}", join_units(units), message);
  if (interrupted) text += fmt::format("\n  {}", Interrupted().what());
  return text;
}

int common_exit_code(const std::vector<UnitError>& errors) {
  const bool all_users = std::all_of(errors.begin(), errors.end(),
                                     [](const UnitError& e) { return e.exit_code == 2; });
  return all_users ? 2 : 1;
}

// Fills in what the class of the exception tells. Returns true for the errors that end the stage.
bool classify_current(UnitError& entry) {
  bool ends_stage = false;
  try {
    throw;
  } catch (const Interrupted& e) {
    entry.message = e.what();
    entry.interrupted = ends_stage = true;
  } catch (const StorageError& e) {
    entry.message = e.what();
    ends_stage = e.disk_full();
  } catch (const DamagedArtifact& e) {
    entry.message = e.what();
    entry.damaged_path = e.path();
  } catch (const Error& e) {
    entry.message = e.what();
    entry.exit_code = e.exit_code();
  } catch (const std::bad_alloc&) {
    entry.message = "out of memory";
  } catch (const std::filesystem::filesystem_error& e) {
    entry.message = refused_text(e);
  } catch (const std::exception& e) {
    entry.message = fmt::format("unexpected error: {}", e.what());
  } catch (...) {
    entry.message = "unexpected error of unknown kind";
  }
  return ends_stage;
}

}  // namespace

ErrorSet::ErrorSet(const std::string& stage, std::vector<UnitError> errors)
    : Error(describe(stage, errors), common_exit_code(errors)), errors_(std::move(errors)) {}

bool ErrorSet::interrupted() const {
  return std::any_of(errors_.begin(), errors_.end(),
                     [](const UnitError& e) { return e.interrupted; });
}

bool ErrorSet::only_damaged() const {
  return std::all_of(errors_.begin(), errors_.end(),
                     [](const UnitError& e) { return !e.damaged_path.empty(); });
}

std::vector<std::string> damaged_paths(const std::exception& error) {
  std::vector<std::string> paths;
  if (const auto* damaged = dynamic_cast<const DamagedArtifact*>(&error)) {
    paths.push_back(damaged->path());
  } else if (const auto* set = dynamic_cast<const ErrorSet*>(&error)) {
    for (const UnitError& entry : set->errors())
      if (!entry.damaged_path.empty()) paths.push_back(entry.damaged_path);
  }
  std::sort(paths.begin(), paths.end());
  paths.erase(std::unique(paths.begin(), paths.end()), paths.end());
  return paths;
}

bool is_only_damage(const std::exception& error) {
  if (const auto* set = dynamic_cast<const ErrorSet*>(&error)) return set->only_damaged();
  return dynamic_cast<const DamagedArtifact*>(&error) != nullptr;
}

bool ErrorCollector::record_current(std::uint64_t key, const std::string& unit) {
  UnitError entry;
  entry.key = key;
  entry.unit = unit;
  entry.error = std::current_exception();
  const bool ends_stage = classify_current(entry);
  const std::scoped_lock lock(mutex_);
  // How many units a stop found at work is chance: all of them are one interruption.
  if (entry.interrupted)
    interrupted_ = true;
  else
    errors_.push_back(std::move(entry));
  return ends_stage;
}

void ErrorCollector::record_interrupt() {
  const std::scoped_lock lock(mutex_);
  interrupted_ = true;
}

void ErrorCollector::throw_if_any(const std::string& stage) {
  const std::scoped_lock lock(mutex_);
  if (errors_.empty()) {
    if (interrupted_) throw Interrupted();
    return;
  }
  if (errors_.size() == 1 && !interrupted_) std::rethrow_exception(errors_.front().error);
  std::sort(errors_.begin(), errors_.end(), [](const UnitError& a, const UnitError& b) {
    return std::tie(a.key, a.unit, a.message) < std::tie(b.key, b.unit, b.message);
  });
  if (interrupted_) {
    UnitError last;
    last.key = ~std::uint64_t{0};
    last.message = Interrupted().what();
    last.interrupted = true;
    last.error = std::make_exception_ptr(Interrupted());
    errors_.push_back(std::move(last));
  }
  throw ErrorSet(stage, std::move(errors_));
}

}  // namespace voxweld
