// Calls of libhdf5: one at a time, silent, and every handle closed.
#pragma once

// The names of functions as version 1.10 has them, also with later libraries.
#define H5_USE_110_API
#include <hdf5.h>

#include <string>
#include <utility>

namespace voxweld {

// libhdf5 keeps its state in globals. Each call to it is made while one of these lives, in whatever
// thread. They may be nested.
class Hdf5Lock {
 public:
  Hdf5Lock();
  ~Hdf5Lock();
  Hdf5Lock(const Hdf5Lock&) = delete;
  Hdf5Lock& operator=(const Hdf5Lock&) = delete;
};

// Something of libhdf5 that has to be closed. Below 0: nothing.
class Hdf5Handle {
 public:
  using Close = herr_t (*)(hid_t);

  Hdf5Handle() = default;
  Hdf5Handle(hid_t id, Close close) : id_(id), close_(close) {}
  ~Hdf5Handle() { reset(); }
  Hdf5Handle(Hdf5Handle&& other) noexcept
      : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Hdf5Handle& operator=(Hdf5Handle&& other) noexcept {
    if (this != &other) {
      reset();
      id_ = std::exchange(other.id_, -1);
      close_ = other.close_;
    }
    return *this;
  }

  hid_t get() const { return id_; }
  explicit operator bool() const { return id_ >= 0; }

 private:
  void reset();

  hid_t id_ = -1;
  Close close_ = nullptr;
};

// What the library says of the call that failed last in this thread: its innermost reason. To be
// asked before the next call.
std::string hdf5_reason();

// FormatError "<where>: <what>: <reason>".
[[noreturn]] void fail_hdf5(const std::string& where, const std::string& what);

}  // namespace voxweld
