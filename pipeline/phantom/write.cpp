#include "pipeline/phantom/write.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <bit>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "storage/support/error.h"
#include "storage/support/file_io.h"

namespace voxweld {
namespace {

static_assert(std::endian::native == std::endian::little, "headers say little-endian");

constexpr std::int64_t slab_bytes = std::int64_t{1} << 28;

// A run of samples that is contiguous in the file: whole slices, or rows of one slice where a
// single slice is larger than a slab.
std::vector<Box3> slabs_of(const PhantomSource& source) {
  const Index3 size = source.info().geometry.size;
  const std::int64_t row = size.x * static_cast<std::int64_t>(sample_bytes(source.info().type));
  const std::int64_t rows = std::clamp<std::int64_t>(slab_bytes / row, 1, size.y);
  const std::int64_t slices =
      rows < size.y ? 1
                    : std::clamp<std::int64_t>(slab_bytes / (row * size.y), 1,
                                               std::max<std::int64_t>(source.block().z, 16));
  std::vector<Box3> slabs;
  for (std::int64_t z = 0; z < size.z; z += slices)
    for (std::int64_t y = 0; y < size.y; y += rows)
      slabs.push_back({{0, y, z}, min({size.x, y + rows, z + slices}, size)});
  return slabs;
}

void compute(const PhantomSource& source, const Box3& slab, std::vector<std::byte>& out) {
  const auto bytes = sample_bytes(source.info().type);
  out.resize(static_cast<std::size_t>(slab.count()) * bytes);
  const Index3 size = slab.size(), block = source.block();
  const PhantomSource::Strides strides{size.x, size.x * size.y};
  const auto parts = [](std::int64_t n, std::int64_t part) { return (n + part - 1) / part; };
  const std::int64_t bands = parts(size.y, block.y);
  tbb::parallel_for(std::int64_t{0}, bands * parts(size.z, block.z), [&](std::int64_t i) {
    const Index3 at{0, i % bands * block.y, i / bands * block.z};
    const Box3 part{slab.lo + at, min(slab.lo + at + Index3{size.x, block.y, block.z}, slab.hi)};
    const auto first = static_cast<std::size_t>(at.z * strides.slice + at.y * strides.row);
    source.read(part, out.data() + first * bytes, strides);
  });
}

void append_samples(const PhantomSource& source, const PhantomHooks& hooks, AtomicFile& file) {
  const std::vector<Box3> slabs = slabs_of(source);
  const auto total =
      static_cast<double>(source.info().geometry.size.x * source.info().geometry.size.y *
                          source.info().geometry.size.z);
  std::int64_t done = 0;
  std::vector<std::byte> current, next;
  compute(source, slabs.front(), current);
  for (std::size_t i = 0; i < slabs.size(); ++i) {
    if (hooks.cancelled && hooks.cancelled()) throw Interrupted();
    tbb::task_group ahead;
    if (i + 1 < slabs.size()) ahead.run([&] { compute(source, slabs[i + 1], next); });
    try {
      file.append(current);
    } catch (...) {
      ahead.wait();
      throw;
    }
    ahead.wait();
    done += slabs[i].count();
    if (hooks.progress) hooks.progress(static_cast<double>(done) / total);
    std::swap(current, next);
  }
}

std::string nrrd_header(const PhantomVolume& volume, const std::string& data_file) {
  const auto isovalue = phantom_isovalue(volume.kind, volume.type);
  const std::string_view type =
      volume.type == SampleType::f32 ? "float" : sample_type_name(volume.type);
  const Vec3 s = volume.spacing;
  std::string header = "NRRD0005\n";
  header += fmt::format("# voxweld phantom {}, {} samples a side, seed {}\n",
                        phantom_kind_name(volume.kind), volume.size, volume.seed);
  header += isovalue ? fmt::format("# isovalue {}, inside below\n", *isovalue)
                     : std::string("# labels, 0 outside\n");
  header += fmt::format("type: {}\ndimension: 3\nspace dimension: 3\nsizes: {} {} {}\n", type,
                        volume.size, volume.size, volume.size);
  header += fmt::format("space directions: ({},0,0) (0,{},0) (0,0,{})\n", s.x, s.y, s.z);
  header += "kinds: domain domain domain\n";
  if (!volume.unit.empty())
    header += fmt::format("space units: \"{0}\" \"{0}\" \"{0}\"\n", volume.unit);
  header += "space origin: (0,0,0)\nendian: little\nencoding: raw\n";
  if (!data_file.empty()) header += "data file: " + data_file + "\n";
  return header + "\n";
}

void write_nrrd(const PhantomSource& source, const PhantomSpec& spec, const PhantomHooks& hooks) {
  AtomicFile file(spec.path);
  file.append(as_bytes(nrrd_header(spec.volume, "")));
  append_samples(source, hooks, file);
  file.commit(Durability::fsync);
}

// The header goes last: where it is, its samples are.
void write_detached_nrrd(const PhantomSource& source, const PhantomSpec& spec,
                         const PhantomHooks& hooks) {
  const std::vector<std::filesystem::path> files = phantom_files(spec.path);
  const std::filesystem::path &header = files[0], &samples = files[1];
  AtomicFile file(samples);
  append_samples(source, hooks, file);
  file.commit(Durability::fsync);
  write_whole_file(header, as_bytes(nrrd_header(spec.volume, samples.filename().string())),
                   Durability::fsync);
}

}  // namespace

PhantomFormat phantom_format(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  if (extension == ".nrrd") return PhantomFormat::nrrd;
  if (extension == ".nhdr" || extension == ".raw") return PhantomFormat::detached_nrrd;
  if (extension == ".zarr") return PhantomFormat::zarr;
  throw InputError(fmt::format(
      "{}: cannot tell the format to write: expected a name ending in .nrrd, .nhdr, .raw or .zarr",
      path.string()));
}

std::vector<std::filesystem::path> phantom_files(const std::filesystem::path& path) {
  if (phantom_format(path) != PhantomFormat::detached_nrrd) return {path};
  std::filesystem::path header = path, samples = path;
  return {header.replace_extension(".nhdr"), samples.replace_extension(".raw")};
}

void write_phantom(const PhantomSpec& spec, const PhantomHooks& hooks) {
  const PhantomFormat format = phantom_format(spec.path);
  const PhantomSource source(spec.volume);
  if (format == PhantomFormat::nrrd) return write_nrrd(source, spec, hooks);
  if (format == PhantomFormat::detached_nrrd) return write_detached_nrrd(source, spec, hooks);
  if (!hooks.zarr)
    throw InputError(fmt::format("{}: Zarr cannot be written here: use .nrrd, .nhdr or .raw",
                                 spec.path.string()));
  hooks.zarr(source, spec.path);
}

// The comments that nrrd_header writes.
std::optional<PhantomSurface> phantom_surface(const std::filesystem::path& header) {
  const ReadFile file(header);
  std::string text(static_cast<std::size_t>(std::min<std::uint64_t>(file.size(), 512)), ' ');
  file.read(0, std::as_writable_bytes(std::span(text)));
  constexpr std::string_view mark = "\n# voxweld phantom ", before = "\n# isovalue ",
                             between = ", inside ";
  const std::size_t at = text.find(before);
  if (text.find(mark) == std::string::npos || at == std::string::npos) return std::nullopt;
  const std::size_t number = at + before.size(), end = text.find('\n', number);
  const std::size_t comma = text.find(between, number);
  if (end == std::string::npos || comma == std::string::npos || comma > end) return std::nullopt;
  const std::size_t side = comma + between.size();
  return PhantomSurface{text.substr(number, comma - number), text.substr(side, end - side)};
}

}  // namespace voxweld
