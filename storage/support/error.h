// The errors voxweld throws. Each message says what, where, what was expected and found, and what
// to do; the class decides the exit code (2: the user's to mend, 1: a failure under way).
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace voxweld {

// Base of all. Never thrown itself.
class Error : public std::runtime_error {
 public:
  int exit_code() const { return exit_code_; }

 protected:
  Error(const std::string& message, int exit_code)
      : std::runtime_error(message), exit_code_(exit_code) {}

 private:
  int exit_code_;
};

// A wrong config, argument or request.
class InputError : public Error {
 public:
  explicit InputError(const std::string& message) : Error(message, 2) {}
};

// A file of the user's that is not what it should be: damaged, truncated, unsupported.
class FormatError : public Error {
 public:
  explicit FormatError(const std::string& message) : Error(message, 2) {}
};

// The system refused: open, read, write, rename, disk full.
class StorageError : public Error {
 public:
  explicit StorageError(const std::string& message, int error_number = 0)
      : Error(message, 1), error_number_(error_number) {}
  int error_number() const { return error_number_; }  // an errno value; 0 where there is none
  // No space or quota left: every other write would fail in the same way.
  bool disk_full() const;

 private:
  int error_number_;
};

// An artifact of ours fails its checks. `path` is the file to rebuild.
class DamagedArtifact : public Error {
 public:
  DamagedArtifact(std::string path, const std::string& what)
      : Error(path + ": " + what, 1), path_(std::move(path)) {}
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

// The user asked to stop (Ctrl-C, SIGTERM). Work done so far is kept.
class Interrupted : public Error {
 public:
  Interrupted()
      : Error("interrupted; what is finished is kept, run the same command again to go on", 1) {}
};

// StorageError "cannot <verb> <path>: <strerror>".
[[noreturn]] void throw_errno(const std::string& verb, const std::string& path, int error);

}  // namespace voxweld
