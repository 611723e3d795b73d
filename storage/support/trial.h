// Doing something first where it can do no harm.
#pragma once

#include <cstdint>
#include <functional>

namespace voxweld {

enum class TrialEnd : std::uint8_t { survived, crashed, out_of_time };

// Runs `what` in a child process that is a copy of this one, and says what became of that. What it
// throws or returns is lost. Where no child can be made it counts as survived.
// most_seconds: of the processor; of the clock ten times as many.
// Precondition: `what` needs no other thread, and no lock that another thread may hold.
TrialEnd try_in_child(const std::function<void()>& what, unsigned most_seconds);

}  // namespace voxweld
