# Address and undefined-behaviour sanitizers.
set(CMAKE_BUILD_TYPE RelWithDebInfo CACHE STRING "")
set(VOXWELD_SANITIZE "address,undefined" CACHE STRING "")
