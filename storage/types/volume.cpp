#include "storage/types/volume.h"

namespace voxweld {

const char* access_name(Access access) {
  switch (access) {
    case Access::box:
      return "box";
    case Access::rows:
      return "rows";
    case Access::slice:
      return "slice";
    case Access::stream:
      break;
  }
  return "stream";
}

}  // namespace voxweld
