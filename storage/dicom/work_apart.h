// Work that may take its process down, in a process of its own.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>

namespace voxweld {

// Calls work(out) in a copy of the process and brings `out` back. False where that returns false,
// throws, aborts, crashes or takes more than five minutes of computing; then `why` says which, as a
// clause, if it is known. What it prints is lost. StorageError where no process can be started.
bool work_apart(std::span<std::byte> out, const std::function<bool(std::span<std::byte>)>& work,
                std::string& why);

}  // namespace voxweld
