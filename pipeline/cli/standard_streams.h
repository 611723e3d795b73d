// The three streams a program is started with, which may be closed, full or broken.
#pragma once

namespace voxweld {

// Opens those that are closed on /dev/null, so that no file of ours gets their numbers and what is
// said ends up in it. What is written there is an error, as it would be.
void hold_standard_streams();

// Writes out what is left. Throws StorageError where anything of standard output was lost.
void finish_standard_output();

// Whether that is so already.
bool standard_output_failed();

}  // namespace voxweld
