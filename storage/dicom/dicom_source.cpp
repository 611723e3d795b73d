#include "storage/dicom/dicom_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <mutex>

#include "storage/dicom/arrange_slices.h"
#include "storage/dicom/choose_series.h"
#include "storage/dicom/dicom_files.h"
#include "storage/dicom/frame_store.h"
#include "storage/dicom/padding.h"
#include "storage/support/error.h"
#include "storage/volumes/axes.h"
#include "storage/volumes/data_layout.h"

namespace voxweld {
namespace {

class DicomSource final : public SampleSource {
 public:
  explicit DicomSource(const InputSpec& spec);

  const VolumeInfo& info() const override { return info_; }
  void read(const Box3& box, std::byte* out) const override;

 private:
  void keep_images(std::vector<DicomImage> all);
  void set_scale();
  void warn_of_image(const DicomImage& image);
  void read_rows(const DicomSlice& slice, std::int64_t begin, std::int64_t end,
                 std::byte* out) const;
  void blend_rows(std::int64_t plane, std::int64_t begin, std::int64_t end, std::byte* out) const;

  VolumeInfo info_;
  SliceStack stack_;
  std::vector<DicomImage> images_;  // those that the stack is made of, in its order
  mutable std::mutex reading_;
  mutable std::unique_ptr<FrameStore> frames_;
};

bool same_samples(FrameStore& store, const std::vector<DicomImage>& images, const DicomSlice& a,
                  const DicomSlice& b) {
  const DicomImage& image = images[a.image];
  std::vector<std::byte> first(image.frame_bytes()), second(image.frame_bytes());
  store.read_rows(a, 0, image.rows, first.data());
  store.read_rows(b, 0, image.rows, second.data());
  return first == second;
}

DicomSource::DicomSource(const InputSpec& spec) {
  info_.format = "dicom";
  info_.access = Access::slice;
  std::vector<DicomImage> all = find_dicom_images(spec, info_.warnings);
  const std::vector<DicomGroup> groups = group_slices(all);
  const DicomGroup& group = groups[choose_group(all, groups, spec, info_)];
  for (const DicomSlice& slice : group.slices)
    if (const std::string objection = image_objection(all[slice.image]); !objection.empty())
      throw FormatError(all[slice.image].file.path + ": " + objection);
  FrameStore store(all);
  stack_ = arrange_slices(
      all, group, spec,
      [&](const DicomSlice& a, const DicomSlice& b) { return same_samples(store, all, a, b); },
      info_);
  keep_images(std::move(all));
  const DicomImage& first = images_.front();
  info_.type = image_sample_type(first.bits);
  info_.geometry.size = {first.columns, first.rows, stack_.planes};
  checked_volume_bytes(info_.geometry.size, info_.type, spec.path);
  warn_of_image(first);
  set_scale();
  frames_ = std::make_unique<FrameStore>(images_);
}

// Keeps what the stack needs, numbered by its order.
void DicomSource::keep_images(std::vector<DicomImage> all) {
  std::map<std::size_t, std::size_t> numbers;
  for (DicomSlice& slice : stack_.slices) {
    const auto [place, is_new] = numbers.try_emplace(slice.image, images_.size());
    if (is_new) {
      images_.push_back(std::move(all[slice.image]));
      info_.files.push_back(images_.back().file);
      info_.largest_decode =
          std::max(info_.largest_decode, FrameStore::largest_bytes(images_.back()));
    }
    slice.image = place->second;
  }
  if (!stack_.at.empty()) info_.largest_decode += 2 * images_.front().frame_bytes();
}

void DicomSource::set_scale() {
  const DicomSlice& front = stack_.slices.front();
  const FrameFacts& first = images_[front.image].frames[front.frame];
  for (const DicomSlice& slice : stack_.slices) {
    const FrameFacts& other = images_[slice.image].frames[slice.frame];
    if (other.slope != first.slope || other.intercept != first.intercept)
      throw FormatError(fmt::format(
          "{}: its values are {:g} * stored + {:g}, but those of {} are {:g} * stored + {:g}: "
          "slices with scales of their own, as of PET, are not supported: convert them to one "
          "scale",
          images_[slice.image].file.path, other.slope, other.intercept,
          images_[front.image].file.path, first.slope, first.intercept));
  }
  info_.scale = sound_scale(first.slope, first.intercept, images_[front.image].file.path, info_);
}

void DicomSource::warn_of_image(const DicomImage& image) {
  const auto warn = [&](const std::string& text) {
    info_.warnings.push_back(image.file.path + ": " + text);
  };
  if (!image.note.empty()) warn(image.note + ": read as they are");
  if (image.photometric == "MONOCHROME1")
    warn("is shown with low values bright (MONOCHROME1); values are taken as stored");
  if (image.modality_table)
    warn(
        "has a table of real values (ModalityLUTSequence), which is ignored: values are taken as "
        "stored");
  if (image.syntax.uid == "1.2.840.10008.1.2.4.50" || image.syntax.uid == "1.2.840.10008.1.2.4.51")
    warn("JPEG is lossy; its blocks show in the surface");
  const std::optional<Padding> padding = padding_of(image);
  if (!padding) return;
  const FrameFacts& facts = image.frames.front();
  const ValueScale scale = value_scale(facts.slope, facts.intercept);
  const auto real = [&](std::int64_t stored) { return scale.real(static_cast<double>(stored)); };
  std::string range = fmt::format("{:g}", real(padding->lo));
  if (padding->hi != padding->lo) range += fmt::format(" to {:g}", real(padding->hi));
  warn(fmt::format("samples of {} lie outside of the scanned field (PixelPaddingValue): {}", range,
                   padding->high
                       ? fmt::format("they are read as {:g}", real(padding->lowest))
                       : "an isovalue below what surrounds them shows the field's border"));
}

void DicomSource::read(const Box3& box, std::byte* out) const {
  require_inside(box, info_);
  const std::lock_guard lock(reading_);
  const std::size_t bytes =
      static_cast<std::size_t>(box.size().x * box.size().y) * sample_bytes(info_.type);
  for (std::int64_t z = box.lo.z; z < box.hi.z; ++z, out += bytes)
    if (stack_.at.empty())
      read_rows(stack_.slices[static_cast<std::size_t>(z)], box.lo.y, box.hi.y, out);
    else
      blend_rows(z, box.lo.y, box.hi.y, out);
}

void DicomSource::read_rows(const DicomSlice& slice, std::int64_t begin, std::int64_t end,
                            std::byte* out) const {
  frames_->read_rows(slice, begin, end, out);
  const std::optional<Padding> padding = padding_of(images_[slice.image]);
  if (padding && padding->high)
    lower_padding(out, static_cast<std::size_t>((end - begin) * info_.geometry.size.x), info_.type,
                  *padding);
}

// Between the slices below and above the plane, by their distances from it.
void DicomSource::blend_rows(std::int64_t plane, std::int64_t begin, std::int64_t end,
                             std::byte* out) const {
  constexpr double at_slice = 1e-6;
  const auto z = static_cast<double>(plane);
  const auto& at = stack_.at;
  const auto above =
      std::min<std::ptrdiff_t>(std::ranges::upper_bound(at, z + at_slice) - at.begin(),
                               static_cast<std::ptrdiff_t>(at.size()) - 1);
  const auto upper = static_cast<std::size_t>(above), lower = upper - 1;
  const double weight = (z - at[lower]) / (at[upper] - at[lower]);
  const bool is_lower = z - at[lower] < at_slice, is_upper = at[upper] - z < at_slice;
  read_rows(stack_.slices[is_upper ? upper : lower], begin, end, out);
  if (is_lower || is_upper) return;
  const auto count = static_cast<std::size_t>((end - begin) * info_.geometry.size.x);
  std::vector<std::byte> top(count * sample_bytes(info_.type));
  read_rows(stack_.slices[upper], begin, end, top.data());
  dispatch_sample_type(info_.type, [&](auto tag) {
    using T = typename decltype(tag)::type;
    for (std::size_t i = 0; i < count; ++i) {
      T a, b;
      std::memcpy(&a, out + i * sizeof(T), sizeof(T));
      std::memcpy(&b, top.data() + i * sizeof(T), sizeof(T));
      const auto low = static_cast<double>(a), high = static_cast<double>(b);
      const T value = static_cast<T>(std::round(low + weight * (high - low)));
      std::memcpy(out + i * sizeof(T), &value, sizeof(T));
    }
  });
}

}  // namespace

std::unique_ptr<SampleSource> open_dicom(const InputSpec& spec) {
  return std::make_unique<DicomSource>(spec);
}

}  // namespace voxweld
