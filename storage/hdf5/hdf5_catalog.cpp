#include "storage/hdf5/hdf5_catalog.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "storage/hdf5/hdf5_attributes.h"
#include "storage/support/error.h"

namespace voxweld {
namespace {

constexpr std::size_t most_objects = 10'000, most_listed = 40;
constexpr std::size_t most_depth = 64;

struct Link {
  std::string name;
  H5L_type_t type;
};
struct Links {
  std::vector<Link> all;
  std::size_t most = 0;
};

herr_t note_link(hid_t /*group*/, const char* name, const H5L_info_t* info, void* to) {
  auto& links = *static_cast<Links*>(to);
  if (links.all.size() >= links.most) return 1;  // enough
  links.all.push_back({name, info->type});
  return 0;
}

using ObjectKey = std::pair<unsigned long, haddr_t>;

class Walk {
 public:
  explicit Walk(const Hdf5File& file) : file_(file) {}

  Catalog run() {
    groups_.push_back({"", 0});
    H5O_info_t info;
    if (H5Oget_info_by_name2(file_.id(), "/", &info, H5O_INFO_BASIC, H5P_DEFAULT) >= 0)
      seen_.insert({info.fileno, info.addr});
    // In the order in which one would list them: a group's members before the next group's.
    for (std::size_t i = 0; i < groups_.size(); ++i) visit(Group(groups_[i]));
    return std::move(catalog_);
  }

 private:
  struct Group {
    std::string path;
    std::size_t depth;
  };

  void visit(const Group& group) {
    const Hdf5Handle opened = file_.open_group(file_.id(), group.path.empty() ? "/" : group.path);
    if (!opened) return;
    const auto signal = text_attribute(opened.get(), "signal");
    const bool nexus = text_attribute(opened.get(), "NX_class") == "NXdata";
    Links links{.all = {}, .most = most_objects - std::min(most_objects, objects_)};
    if (H5Literate(opened.get(), H5_INDEX_NAME, H5_ITER_INC, nullptr, note_link, &links) != 0)
      catalog_.cut = catalog_.cut || links.all.size() >= links.most;
    objects_ += links.all.size();
    for (const Link& link : links.all) {
      const std::string path = group.path + "/" + link.name;
      const bool outside = link.type != H5L_TYPE_HARD && link.type != H5L_TYPE_SOFT;
      if (outside && !file_.follow()) {
        catalog_.refused.push_back(
            path +
            " leads into another file; set input.follow = true (--follow) if that is to be "
            "read");
        continue;
      }
      const Way way = nexus && signal == link.name ? Way::data_of_group
                      : link.type == H5L_TYPE_HARD ? Way::hard_link
                                                   : Way::soft_link;
      look(opened.get(), link.name, {path, group.depth + 1}, way);
    }
  }

  void look(hid_t group, const std::string& name, const Group& at, Way way) {
    H5O_info_t info;
    if (H5Oget_info_by_name2(group, name.c_str(), &info, H5O_INFO_BASIC, file_.link_access()) < 0)
      return;  // a link that leads nowhere
    const ObjectKey key{info.fileno, info.addr};
    const auto known = datasets_.find(key);
    if (known != datasets_.end()) {
      CatalogEntry& entry = catalog_.volumes[known->second];
      if (way > entry.way) entry.shape.path = at.path, entry.way = way;
      return;
    }
    if (!seen_.insert(key).second) return;
    if (info.type == H5O_TYPE_GROUP && at.depth < most_depth) groups_.push_back(at);
    if (info.type == H5O_TYPE_DATASET) look_at_dataset(group, name, at.path, way, key);
  }

  void look_at_dataset(hid_t group, const std::string& name, const std::string& path, Way way,
                       const ObjectKey& key) {
    const Hdf5Handle dataset = file_.open_dataset(group, name);
    if (!dataset) return;
    CatalogEntry entry{dataset_shape(dataset.get(), path), way};
    if (std::ranges::count_if(entry.shape.dims, [](auto side) { return side > 1; }) < 3) return;
    if (!entry.shape.type.type) {
      catalog_.refused.push_back(shape_text(entry.shape) + " holds no plain numbers");
      return;
    }
    datasets_[key] = catalog_.volumes.size();
    catalog_.volumes.push_back(std::move(entry));
  }

  const Hdf5File& file_;
  Catalog catalog_;
  std::vector<Group> groups_;
  std::set<ObjectKey> seen_;
  std::map<ObjectKey, std::size_t> datasets_;
  std::size_t objects_ = 0;
};

double samples_of(const CatalogEntry& entry) {
  double samples = 1;
  for (const std::int64_t side : entry.shape.dims) samples *= static_cast<double>(side);
  return samples;
}

// NeXus: the attribute "default" of a group names the member to look at, and so on down to the one
// whose "signal" names the data. Empty where the file says nothing of it.
std::string default_dataset(const Hdf5File& file) {
  std::string path = "/";
  for (std::size_t depth = 0; depth < most_depth; ++depth) {
    const Hdf5Handle group = file.open_group(file.id(), path);
    if (!group) return {};
    const std::string slash = path == "/" ? "" : "/";
    if (const auto signal = text_attribute(group.get(), "signal"); signal && !signal->empty())
      return path + slash + *signal;
    const auto next = text_attribute(group.get(), "default");
    if (!next || next->empty()) return {};
    path += slash + *next;
  }
  return {};
}

std::string list_of(const Catalog& catalog) {
  std::string text;
  for (std::size_t i = 0; i < catalog.volumes.size(); ++i) {
    if (i == most_listed) return text + fmt::format(" and {} more", catalog.volumes.size() - i);
    text += (text.empty() ? "" : ", ") + shape_text(catalog.volumes[i].shape);
  }
  return text;
}

[[noreturn]] void refuse_none(const Hdf5File& file, const Catalog& catalog) {
  std::string text = fmt::format(
      "{}: no dataset of three dimensions of numbers{}: name one by input.dataset or --dataset",
      file.path(), catalog.cut ? fmt::format(" among the first {} objects", most_objects) : "");
  for (std::size_t i = 0; i < std::min<std::size_t>(5, catalog.refused.size()); ++i)
    text += "; " + catalog.refused[i];
  throw InputError(text);
}

}  // namespace

Catalog hdf5_catalog(const Hdf5File& file) {
  return Walk(file).run();
}

std::string chosen_dataset(const Hdf5File& file, const InputSpec& spec, VolumeInfo& info) {
  if (!spec.select.dataset.empty() && !spec.survey)
    return (spec.select.dataset.front() == '/' ? "" : "/") + spec.select.dataset;
  const Catalog catalog = hdf5_catalog(file);
  const std::vector<CatalogEntry>& all = catalog.volumes;
  std::string chosen;
  if (!spec.select.dataset.empty())
    chosen = (spec.select.dataset.front() == '/' ? "" : "/") + spec.select.dataset;
  else if (all.empty())
    refuse_none(file, catalog);
  else if (all.size() == 1)
    chosen = all.front().shape.path;
  else if (const std::string said = default_dataset(file);
           std::ranges::any_of(all, [&](const auto& one) { return one.shape.path == said; }))
    chosen = said;
  else if (spec.survey)
    chosen = std::ranges::max_element(all, {}, samples_of)->shape.path;
  for (std::size_t i = 0; all.size() > 1 && i < all.size(); ++i)
    info.choices.push_back(
        {"dataset", all[i].shape.path, shape_text(all[i].shape), all[i].shape.path == chosen});
  if (chosen.empty())
    throw InputError(fmt::format(
        "{}: holds {} datasets that may be the volume: set input.dataset or --dataset to one of {}",
        file.path(), all.size(), list_of(catalog)));
  if (spec.survey && spec.select.dataset.empty() && all.size() > 1 &&
      chosen != default_dataset(file))
    info.warnings.push_back(
        fmt::format("{}: holds {} datasets that may be the volume; this is {}, the first of the "
                    "largest: set input.dataset "
                    "or --dataset to choose",
                    file.path(), all.size(), chosen));
  return chosen;
}

}  // namespace voxweld
