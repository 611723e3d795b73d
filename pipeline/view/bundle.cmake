# Makes the viewer's page: installs what it needs with npm, bundles it, and writes the source that puts
# its files into the program. Run by the build:
#   cmake -DVIEWER=AUTO|ON|OFF -DPAGE=SOURCES -DBUNDLE=FOLDER -DLIST=FILE.cpp -DNPM=.. -DNODE=.. -P bundle.cmake
# With AUTO a failure leaves a program without the page; with ON it ends the build.
set(out ${BUNDLE}/files)

# fail(WHAT OUTPUT): sets failed in the caller.
macro(fail what output)
  if(VIEWER STREQUAL ON)
    message(FATAL_ERROR "viewer: ${what}:\n${output}")
  endif()
  message(NOTICE "viewer: ${what}; the program is built without it. "
    "Configure with -DVOXWELD_VIEWER=ON to see why, OFF to leave it out")
  set(failed TRUE)
endmacro()

# Nothing is installed again while the lock is the one that was installed.
macro(install)
  file(SHA256 ${PAGE}/package-lock.json lock)
  set(installed "")
  if(EXISTS ${BUNDLE}/installed.txt)
    file(READ ${BUNDLE}/installed.txt installed)
  endif()
  if(NOT installed STREQUAL lock)
    file(COPY ${PAGE}/package.json ${PAGE}/package-lock.json DESTINATION ${BUNDLE})
    execute_process(COMMAND ${NPM} ci --ignore-scripts --no-audit --no-fund --prefer-offline
      WORKING_DIRECTORY ${BUNDLE} RESULT_VARIABLE status OUTPUT_VARIABLE text ERROR_VARIABLE text)
    if(status EQUAL 0)
      file(WRITE ${BUNDLE}/installed.txt ${lock})
    else()
      fail("npm cannot install what the page needs" "${text}")
    endif()
  endif()
endmacro()

# The sources are bundled from a copy beside node_modules, where they find what they import.
macro(bundle)
  file(REMOVE_RECURSE ${BUNDLE}/src ${out})
  file(GLOB sources ${PAGE}/src ${PAGE}/*.html ${PAGE}/*.css ${PAGE}/*.mjs)
  file(COPY ${sources} DESTINATION ${BUNDLE})
  execute_process(COMMAND ${NODE} bundle.mjs ${out} WORKING_DIRECTORY ${BUNDLE}
    RESULT_VARIABLE status OUTPUT_VARIABLE text ERROR_VARIABLE text)
  if(NOT status EQUAL 0)
    fail("the page cannot be bundled" "${text}")
  endif()
endmacro()

set(failed FALSE)
set(names "")
if(NOT VIEWER STREQUAL OFF)
  if(NOT NPM OR NOT NODE)
    fail("npm is not found" "Install Node.js and npm")
  endif()
  if(NOT failed)
    install()
  endif()
  if(NOT failed)
    bundle()
  endif()
  if(NOT failed)
    file(GLOB_RECURSE names RELATIVE ${out} ${out}/*)
    list(SORT names)
  endif()
endif()

set(symbols "")
set(rows "")
set(number 0)
foreach(name IN LISTS names)
  string(APPEND symbols "VOXWELD_PAGE_FILE(${number}, \"${out}/${name}\")\n")
  string(APPEND rows "    {\"${name}\", VOXWELD_PAGE_BYTES(${number})},\n")
  math(EXPR number "${number} + 1")
endforeach()
if(names)
  set(table "  static const std::array<PageFile, ${number}> files{{\n${rows}  }};\n  return files;")
else()
  set(table "  return {};")
endif()
file(WRITE ${LIST} "// Made by bundle.cmake.
#include <array>

#include \"pipeline/view/page_files.h\"

#define VOXWELD_PAGE_FILE(number, path)                                            \\
  __asm__(\".section .rodata\\n.balign 16\\nvoxweld_page_\" #number \":\\n.incbin \\\"\" path \\
          \"\\\"\\nvoxweld_page_\" #number \"_end:\\n.byte 0\\n.previous\\n\");                  \\
  extern \"C\" const char voxweld_page_##number[], voxweld_page_##number##_end[];
#define VOXWELD_PAGE_BYTES(number)    \\
  std::string_view(voxweld_page_##number, \\
    static_cast<std::size_t>(voxweld_page_##number##_end - voxweld_page_##number))

${symbols}
namespace voxweld {

std::span<const PageFile> page_files() {
${table}
}

}  // namespace voxweld
")
