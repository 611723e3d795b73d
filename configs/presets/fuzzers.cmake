# Programs of libFuzzer (tests/fuzz): clang, with addresses and undefined behaviour checked.
set(CMAKE_CXX_COMPILER clang++ CACHE STRING "")
set(CMAKE_BUILD_TYPE RelWithDebInfo CACHE STRING "")
set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O1 -g1 -DNDEBUG" CACHE STRING "")
set(VOXWELD_SANITIZE "address,undefined,fuzzer-no-link" CACHE STRING "")
set(VOXWELD_FUZZERS ON CACHE BOOL "")
