#include "pipeline/report/page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace voxweld {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(Page, EscapesItsTexts) {
  const std::string html =
      page_html({"<a>", "b & c", "00ff", {{"d \"e\"", "f < g", "<i>h</i>\n"}}, "'j'"});
  EXPECT_THAT(html, HasSubstr("<title>&lt;a&gt;</title>"));
  EXPECT_THAT(html, HasSubstr("<p>b &amp; c</p>"));
  EXPECT_THAT(html, HasSubstr("<h2>d &quot;e&quot;</h2>"));
  EXPECT_THAT(html, HasSubstr("f &lt; g"));
  EXPECT_THAT(html, HasSubstr("<i>h</i>"));  // parts are as they will stand
  EXPECT_THAT(html, HasSubstr("<footer>&#39;j&#39;</footer>"));
}

TEST(Page, LeavesOutEmptySections) {
  const std::string html =
      page_html({"a", "", "", {{"Empty", "intro", ""}, {"Full", "", "x"}}, ""});
  EXPECT_THAT(html, Not(HasSubstr("Empty")));
  EXPECT_THAT(html, HasSubstr("<h2>Full</h2>"));
}

TEST(Page, IsKnownByItsBeginning) {
  const std::string html = page_html({"a", "", "00ff", {}, ""});
  EXPECT_EQ(key_of_page(html.substr(0, 512)), "00ff");
  EXPECT_EQ(key_of_page("<!DOCTYPE html><title>mine</title>"), "");
  EXPECT_EQ(key_of_page(""), "");
}

}  // namespace
}  // namespace voxweld
