// The files of the viewer's page, which the build puts into the program (bundle.cmake).
#pragma once

#include <span>
#include <string_view>

namespace voxweld {

struct PageFile {
  std::string_view name;  // as a browser asks for it, without the leading slash
  std::string_view bytes;
};

// Empty where the program was built without the page.
std::span<const PageFile> page_files();

// InputError saying how to get the page, where there is none.
void require_page();

// Of a file or a part of the page, by its ending.
std::string_view content_type(std::string_view name);

}  // namespace voxweld
