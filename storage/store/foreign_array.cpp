#include "storage/store/foreign_array.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

#include "storage/store/array_listing.h"
#include "storage/store/http_store.h"
#include "storage/store/n5.h"
#include "storage/store/zarr_fields.h"
#include "storage/store/zip_store.h"
#include "storage/support/error.h"
#include "storage/support/text_fields.h"

namespace voxweld {
namespace {

// The way from what the user named to an array.
class ArraySearch {
 public:
  ArraySearch(const InputSpec& spec, ArrayFamily family)
      : spec_(spec), family_(family), folder_(open_byte_store(spec.path)) {}

  ForeignArray run() {
    FolderContents contents = contents_of(named_folder(), family_);
    list_datasets(contents);
    if (contents.array) return take_array();
    if (!contents.pyramids.empty()) return take_level(contents.pyramids);
    // Nothing here by itself, or a file that is no array of ours: the reader says what is wrong.
    return take_array();
  }

 private:
  StoreFolder named_folder() {
    if (spec_.select.dataset.empty()) return folder_;
    const auto key = key_of(spec_.select.dataset);
    const StoreFolder inner = key && !key->empty() ? folder_ / *key : folder_;
    if (!key || !inner.holds(""))
      throw InputError(fmt::format(
          "{}: input.dataset (--dataset) is '{}', and there is no such "
          "folder in it{}",
          spec_.path, spec_.select.dataset, there_are(datasets_below(folder_, family_))));
    folder_ = inner;
    return folder_;
  }

  // What else lies below. Of a folder that is nothing itself one of these is taken.
  void list_datasets(FolderContents& contents) {
    if (contents.array) return;
    const std::vector<std::string> all = datasets_below(folder_, family_);
    const bool itself = !contents.pyramids.empty();
    const std::string prefix =
        spec_.select.dataset.empty() ? "" : key_of(spec_.select.dataset).value_or("");
    const auto full = [&](const std::string& path) {
      return prefix.empty() ? path : prefix + '/' + path;
    };
    if (all.empty()) return;
    if (!itself && all.size() > 1 && !spec_.survey)
      throw InputError(
          fmt::format("{}: holds several arrays, of which one is read: set "
                      "input.dataset or --dataset{}",
                      folder_.name(), there_are(all, prefix)));
    if (itself || all.size() > 1) {
      if (itself) choices_.push_back({"dataset", prefix.empty() ? "." : prefix, "", true});
      for (const std::string& path : all)
        choices_.push_back({"dataset", full(path), "", !itself && path == all.front()});
    }
    if (itself) return;
    if (all.size() > 1)
      warnings_.push_back(
          fmt::format("{}: of {} arrays the first is shown: set input.dataset or "
                      "--dataset for another",
                      folder_.name(), all.size()));
    folder_ = folder_ / all.front();
    contents = contents_of(folder_, family_);
  }

  static std::string there_are(const std::vector<std::string>& datasets,
                               const std::string& prefix = {}) {
    constexpr std::size_t most = 16;
    std::string text;
    for (std::size_t i = 0; i < std::min(most, datasets.size()); ++i)
      text += fmt::format("{}'{}{}{}'", i == 0 ? "; there are " : ", ", prefix,
                          prefix.empty() ? "" : "/", datasets[i]);
    return datasets.size() > most ? text + fmt::format(" and {} more", datasets.size() - most)
                                  : text;
  }

  ArrayContext chosen(ArrayContext context) const {
    context.select = spec_.select;
    context.survey = spec_.survey;
    return context;
  }

  ZarrArray parse(const StoreFolder& folder, const ArrayContext& context) const {
    if (family_ == ArrayFamily::zarr) {
      if (!context.axes.empty()) return read_zarr_array(folder, context);
      ArrayContext named = context;
      named.axes = zarr_v2_names(folder);
      return read_zarr_array(folder, named);
    }
    const auto text = folder.text("attributes.json");
    if (!text || !is_n5_array(*text))
      throw InputError(folder.name() +
                       ": no array of N5 in it (an attributes.json with \"dimensions\"); name the "
                       "folder of one");
    return parse_n5_array(*text, folder.name(), context);
  }

  ForeignArray finish(ZarrArray array, const StoreFolder& folder) {
    ForeignArray found{std::move(array), folder, std::move(choices_), std::move(warnings_)};
    for (InputChoice& choice : found.array.choices) found.choices.push_back(std::move(choice));
    for (std::string& warning : found.array.warnings) found.warnings.push_back(std::move(warning));
    found.array.choices.clear();
    found.array.warnings.clear();
    return found;
  }

  ForeignArray take_array() {
    if (spec_.select.level.value_or(0) != 0)
      throw InputError(
          fmt::format("{}: input.level (--level) is set, and this is an array of one "
                      "resolution; name the group that it lies in, or remove it",
                      folder_.name()));
    const ArrayContext context = family_ == ArrayFamily::n5
                                     ? n5_context_of(folder_)
                                     : ome_context_of(folder_).value_or(ArrayContext{});
    return finish(parse(folder_, chosen(context)), folder_);
  }

  ForeignArray take_level(const std::vector<Pyramid>& pyramids) {
    const Pyramid& pyramid = pyramids.front();
    if (pyramids.size() > 1)
      warnings_.push_back(
          fmt::format("{}: holds {} images of their own resolutions each; the "
                      "first is read: name an array inside for another",
                      pyramid.where, pyramids.size()));
    const auto levels = static_cast<std::int64_t>(pyramid.levels.size());
    const std::int64_t wanted = spec_.select.level.value_or(0);
    if (wanted < 0 || wanted >= levels)
      throw InputError(fmt::format("{}: input.level (--level) is {}, and there are {}: 0 to {}",
                                   pyramid.where, wanted, levels, levels - 1));
    for (std::int64_t i = 0; levels > 1 && i < levels; ++i)
      choices_.push_back({"level", std::to_string(i),
                          level_text(pyramid, static_cast<std::size_t>(i)), i == wanted});
    const auto level = static_cast<std::size_t>(wanted);
    const StoreFolder folder = folder_ / pyramid.levels[level].path;
    return finish(parse(folder, chosen(pyramid.context(level))), folder);
  }

  // "0: 512 x 512 x 100 samples, 0.5 x 0.5 x 2 um"
  std::string level_text(const Pyramid& pyramid, std::size_t level) const {
    const std::string& path = pyramid.levels[level].path;
    try {
      ArrayContext context = chosen(pyramid.context(level));
      context.survey = true;
      const ZarrArray array = parse(folder_ / path, context);
      std::string text =
          fmt::format("{}: {} x {} x {} samples", path, array.size.x, array.size.y, array.size.z);
      if (!array.geometry) return text;
      const auto& [x, y, z] = array.geometry->spacing;
      return text + fmt::format(", {:.6g} x {:.6g} x {:.6g} {}", x, y, z, array.geometry->unit);
    } catch (const Error&) {
      return path + ": cannot be read";
    }
  }

  const InputSpec& spec_;
  ArrayFamily family_;
  StoreFolder folder_;
  std::vector<InputChoice> choices_;
  std::vector<std::string> warnings_;
};

}  // namespace

std::shared_ptr<const ByteStore> open_byte_store(const std::string& path) {
  if (is_url(path)) return http_store(path);
  std::error_code ignored;
  if (std::filesystem::is_regular_file(path, ignored) && is_zip_file(path)) return zip_store(path);
  return folder_store(path);
}

ForeignArray find_foreign_array(const InputSpec& spec, ArrayFamily family) {
  return ArraySearch(spec, family).run();
}

ZarrArray read_foreign_array(const InputSpec& spec, const std::string& format) {
  return find_foreign_array(spec, format == "n5" ? ArrayFamily::n5 : ArrayFamily::zarr).array;
}

}  // namespace voxweld
