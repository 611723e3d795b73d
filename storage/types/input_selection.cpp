#include "storage/types/input_selection.h"

namespace voxweld {

bool InputSelection::has(Selector selector) const {
  switch (selector) {
    case Selector::dataset:
      return !dataset.empty();
    case Selector::series:
      return !series.empty();
    case Selector::level:
      return level.has_value();
    case Selector::channel:
      return channel.has_value();
    case Selector::time:
      return time.has_value();
  }
  return false;
}

}  // namespace voxweld
