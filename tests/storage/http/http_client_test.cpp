#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>

#include "storage/http/http_service.h"
#include "storage/support/error.h"
#include "tests/storage/http/http_server.h"
#include "tests/support/error_text.h"

namespace voxweld {
namespace {

using ::testing::AllOf;
using testing::error_text;
using ::testing::HasSubstr;
using testing::HttpServer;

std::string text_of(const HttpAnswer& answer) {
  return {reinterpret_cast<const char*>(answer.body.data()), answer.body.size()};
}

class HttpClient : public ::testing::Test {
 protected:
  HttpClient() {
    auto& server = server_.server();
    server.Get("/ten", [](const httplib::Request&, httplib::Response& answer) {
      answer.set_header("ETag", "\"v1\"");
      answer.set_content("0123456789", "text/plain");
    });
    // Without regard to ranges.
    server.Get("/whole", [](const httplib::Request& request, httplib::Response& answer) {
      const_cast<httplib::Request&>(request).ranges.clear();
      answer.set_content("0123456789", "text/plain");
    });
    server.Get("/moved", [](const httplib::Request&, httplib::Response& answer) {
      answer.set_redirect("/ten");
    });
    server.Get(R"(/status/(\d+))",
               [this](const httplib::Request& request, httplib::Response& answer) {
                 ++asked_;
                 answer.status = std::stoi(request.matches[1]);
               });
    // Busy twice, then not.
    server.Get("/busy", [this](const httplib::Request&, httplib::Response& answer) {
      if (++asked_ < 3)
        answer.status = 503;
      else
        answer.set_content("at last", "text/plain");
    });
    server_.start();
  }
  HttpAnswer get(const std::string& path) const { return send_http({.url = server_.url(path)}); }
  std::string refusal(const std::string& path, int tries = 1) const {
    return error_text<Error>([&] {
      HttpRequest request{.url = server_.url(path)};
      request.most_tries = tries;
      send_http(request);
    });
  }
  HttpServer server_;
  std::atomic<int> asked_ = 0;
};

TEST_F(HttpClient, GetsTheWholeAndRangesOfIt) {
  const HttpAnswer whole = get("/ten");
  EXPECT_EQ(whole.status, 200);
  EXPECT_EQ(text_of(whole), "0123456789");
  EXPECT_EQ(whole.size, 10U);
  EXPECT_EQ(whole.etag, "\"v1\"");
  const HttpAnswer part =
      send_http({.url = server_.url("/ten"), .range = HttpRequest::Range{3, 4}});
  EXPECT_EQ(part.status, 206);
  EXPECT_EQ(text_of(part), "3456");
  EXPECT_EQ(part.size, 10U);
  const HttpAnswer head =
      send_http({.url = server_.url("/ten"), .method = HttpRequest::Method::head});
  EXPECT_EQ(head.status, 200);
  EXPECT_TRUE(head.body.empty());
  EXPECT_EQ(head.size, 10U);
}

TEST_F(HttpClient, FollowsWhereThingsHaveMoved) {
  EXPECT_EQ(text_of(get("/moved")), "0123456789");
}

TEST_F(HttpClient, SaysWhatIsNotThere) {
  EXPECT_EQ(get("/nothing").status, 404);
  EXPECT_FALSE(get("/nothing").found());
  EXPECT_EQ(get("/status/410").status, 410);
}

TEST_F(HttpClient, TriesAgainWhatMayPass) {
  EXPECT_EQ(text_of(get("/busy")), "at last");
  EXPECT_EQ(asked_, 3);
  asked_ = 0;
  EXPECT_THAT(refusal("/status/500", 2),
              AllOf(HasSubstr("/status/500"), HasSubstr("status 500, also at try 2")));
  EXPECT_EQ(asked_, 2);
}

TEST_F(HttpClient, SaysAtOnceWhatDoesNotPass) {
  EXPECT_THAT(refusal("/status/403", 6), AllOf(HasSubstr("status 403"), HasSubstr("not public")));
  EXPECT_THAT(refusal("/status/400", 6), HasSubstr("status 400"));
  EXPECT_EQ(asked_, 2);
}

TEST_F(HttpClient, TakesNoMoreThanItIsAskedTo) {
  const auto bounded = [&](std::uint64_t most, const char* path) {
    return error_text<FormatError>([&] {
      send_http({.url = server_.url(path), .range = HttpRequest::Range{0, 4}, .most_bytes = most});
    });
  };
  EXPECT_EQ(bounded(10, "/whole"), "accepted");
  EXPECT_THAT(bounded(9, "/whole"), HasSubstr("more than 9 bytes came"));
}

TEST_F(HttpClient, NamesServersThatAreNotThere) {
  HttpRequest request{.url = "http://127.0.0.1:1/a.zarr"};
  request.most_tries = 2;
  const std::string message = error_text<StorageError>([&] { send_http(request); });
  EXPECT_THAT(message, AllOf(HasSubstr("http://127.0.0.1:1/a.zarr: cannot be read"),
                             HasSubstr("tried 2 times")));
  request.url = "http://[::1/a";
  EXPECT_THAT(error_text<InputError>([&] { send_http(request); }), HasSubstr("tried once"));
}

}  // namespace
}  // namespace voxweld
