// A report as one HTML file that needs nothing else: no script, nothing from the network.
#pragma once

#include <string>
#include <vector>

namespace voxweld {

// A part of the page under a heading; left out where `html` is empty. Texts are plain and are
// escaped, `html` is as it will stand.
struct PageSection {
  std::string title, intro, html;
};

struct Page {
  std::string title, lede;
  std::string key;  // what the page is made from; see report_key()
  std::vector<PageSection> sections;
  std::string footer;
};

std::string page_html(const Page& page);

// The key of a page whose beginning this is; empty where it is none of ours.
std::string key_of_page(const std::string& beginning);

}  // namespace voxweld
