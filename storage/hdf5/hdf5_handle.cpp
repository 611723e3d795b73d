#include "storage/hdf5/hdf5_handle.h"

#include <fmt/format.h>

#include <mutex>

#include "storage/support/error.h"

namespace voxweld {
namespace {

// Not a recursive mutex: the thread of a child process has another number, and would wait for the one
// that it is the copy of.
std::mutex& library_mutex() {
  static std::mutex mutex;
  return mutex;
}
thread_local int locks_held = 0;

// The stack is walked from the outermost call inwards, so the last one is the reason.
herr_t keep_description(unsigned /*depth*/, const H5E_error2_t* error, void* text) {
  if (error->desc != nullptr && *error->desc != '\0')
    *static_cast<std::string*>(text) = error->desc;
  return 0;
}

}  // namespace

Hdf5Lock::Hdf5Lock() {
  if (locks_held++ == 0) library_mutex().lock();
  // Errors are told by what we throw. The library keeps this setting for each thread.
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Hdf5Lock::~Hdf5Lock() {
  if (--locks_held == 0) library_mutex().unlock();
}

void Hdf5Handle::reset() {
  if (id_ < 0) return;
  const Hdf5Lock lock;
  close_(id_);
  id_ = -1;
}

std::string hdf5_reason() {
  std::string text;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_DOWNWARD, keep_description, &text);
  return text.empty() ? "libhdf5 does not say why" : text;
}

void fail_hdf5(const std::string& where, const std::string& what) {
  throw FormatError(fmt::format("{}: {}: {}", where, what, hdf5_reason()));
}

}  // namespace voxweld
