// The viewer's server: what it answers, to whom, and to how many.
#include "pipeline/view/view_server.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <thread>

#include "pipeline/view/page_files.h"
#include "storage/support/error.h"
#include "tests/pipeline/cli/workplace.h"
#include "tests/pipeline/output/output_directory.h"

namespace voxweld::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::StartsWith;

void write_small_run(const fs::path& directory) {
  OutputDirectory output;
  output.tiles = cut_into_tiles(make_torus({.around = 12, .across = 8}, small_lattice()), 4);
  output.write(directory);
}

class View : public ::testing::Test {
 protected:
  void SetUp() override {
    if (page_files().empty()) GTEST_SKIP() << "built without the viewer's page";
    write_small_run(folder());
    write_bytes((place_.path() / "secret.txt").string(), "secret");
    server_.emplace(folder(), ServerOptions{});
  }
  fs::path folder() const { return place_.path() / "scan.mesh"; }
  httplib::Client client() const { return httplib::Client("127.0.0.1", server_->port()); }
  httplib::Result get(const std::string& path, const httplib::Headers& headers = {}) const {
    return client().Get(path, headers);
  }
  int status_of(const std::string& path, const httplib::Headers& headers = {}) const {
    const auto answer = get(path, headers);
    return answer ? answer->status : -1;
  }
  // Whatever a client would not send.
  std::string raw(const std::string& request) const;

  const TempDirectory place_;
  std::optional<ViewServer> server_;
};

std::string View::raw(const std::string& request) const {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(server_->port()));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  EXPECT_EQ(connect(socket, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  EXPECT_EQ(send(socket, request.data(), request.size(), MSG_NOSIGNAL),
            static_cast<ssize_t>(request.size()));
  std::string answer;
  char piece[4096];
  for (ssize_t n; (n = recv(socket, piece, sizeof piece, 0)) > 0;)
    answer.append(piece, static_cast<std::size_t>(n));
  close(socket);
  return answer;
}

TEST_F(View, HandsOutThePage) {
  EXPECT_EQ(server_->url(), fmt::format("http://127.0.0.1:{}/", server_->port()));
  const auto page = get("/");
  ASSERT_TRUE(page);
  EXPECT_EQ(page->status, 200);
  EXPECT_THAT(page->body, HasSubstr("viewer.js"));
  EXPECT_THAT(page->get_header_value("Content-Type"), StartsWith("text/html"));
  EXPECT_THAT(page->get_header_value("Content-Security-Policy"), HasSubstr("default-src 'self'"));
  EXPECT_EQ(page->get_header_value("Cache-Control"), "no-cache");
  for (const PageFile& file : page_files()) {
    const auto answer = get("/" + std::string(file.name));
    ASSERT_TRUE(answer) << file.name;
    EXPECT_EQ(answer->body, file.bytes) << file.name;
    EXPECT_EQ(answer->get_header_value("Content-Type"), content_type(file.name));
  }
  EXPECT_EQ(content_type("viewer.js"), "text/javascript; charset=utf-8");
  EXPECT_EQ(content_type("a.wasm"), "application/wasm") << "browsers compile no other";
}

TEST_F(View, HandsOutFilesOfTheRun) {
  for (const char* name :
       {"manifest.json", "tiles.jsonl", "tiles/0.drc", "tiles/0.glb", "mesh.drc"}) {
    const auto answer = get(std::string("/data/") + name);
    ASSERT_TRUE(answer) << name;
    EXPECT_EQ(answer->status, 200) << name;
    EXPECT_EQ(answer->body, read_bytes((folder() / name).string())) << name;
    EXPECT_EQ(answer->get_header_value("Content-Type"), content_type(name));
  }
  EXPECT_EQ(get("/data/tiles/0.glb")->get_header_value("Content-Type"), "model/gltf-binary");
}

TEST_F(View, NamesMayHaveAnyCharacters) {
  const std::string name = "a b+c%41 \xC3\xA9#?&.txt";
  write_bytes((folder() / name).string(), "odd");
  EXPECT_EQ(get("/data/a%20b%2Bc%2541%20%C3%A9%23%3F%26.txt")->body, "odd");
}

TEST_F(View, EmptyFilesAreEmpty) {
  write_bytes((folder() / "empty.obj").string(), "");
  const auto answer = get("/data/empty.obj");
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status, 200);
  EXPECT_EQ(answer->body, "");
}

TEST_F(View, PartsAreSaidToBeParts) {
  const std::string whole = get("/data/tiles/0.drc")->body;
  const auto part = get("/data/tiles/0.drc", {{"Range", "bytes=2-5"}});
  ASSERT_TRUE(part);
  EXPECT_EQ(part->status, 206);
  EXPECT_EQ(part->body, whole.substr(2, 4));
  EXPECT_EQ(status_of("/data/tiles/0.drc", {{"Range", "bytes=x"}}), 416);
}

TEST_F(View, SaysWhatIsMissing) {
  for (const char* path : {"/none", "/data/", "/data/none", "/data/tiles", "/data", "/api",
                           "/api/none", "/draco", "/draco/none", "//", "/index.html/x"})
    EXPECT_EQ(status_of(path), 404) << path;
}

TEST_F(View, NeverLeavesTheFolder) {
  ASSERT_TRUE(fs::exists(folder() / "../secret.txt"));
  fs::create_symlink("../secret.txt", folder() / "link.txt");
  fs::create_directory_symlink("..", folder() / "up");
  const std::string secret = (place_.path() / "secret.txt").string();
  for (const std::string& path :
       {std::string("/data/../secret.txt"), std::string("/data/%2e%2e/secret.txt"),
        std::string("/data/%2E%2E%2Fsecret.txt"), std::string("/data/..%2fsecret.txt"),
        std::string("/data/tiles/../../secret.txt"), std::string("/data/..%5csecret.txt"),
        std::string("/data/%252e%252e/secret.txt"), "/data/" + secret, "/data//" + secret,
        "/data/%2f" + secret.substr(1), std::string("/data/link.txt"),
        std::string("/data/up/secret.txt"), std::string("/data/manifest.json%00.txt"),
        std::string("/../secret.txt"), std::string("/data/....//secret.txt"),
        std::string("/data/%c0%ae%c0%ae/secret.txt")}) {
    const std::string answer = raw("GET " + path + " HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n");
    EXPECT_THAT(answer, HasSubstr(" 404 ")) << path;
    EXPECT_THAT(answer, ::testing::Not(HasSubstr("\r\n\r\nsecret"))) << path;
  }
}

TEST_F(View, LongPathsAreRefused) {
  EXPECT_THAT(raw("GET /data/" + std::string(8000, 'a') + " HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n"),
              HasSubstr(" 404 "));
  EXPECT_THAT(raw("GET /data/" + std::string(20000, 'a') + " HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n"),
              HasSubstr(" 414 "));
  EXPECT_EQ(status_of("/"), 200);
}

TEST_F(View, OnlyReads) {
  const std::string before = read_bytes((folder() / "manifest.json").string());
  auto asks = client();
  const auto refused = [](const httplib::Result& answer) {
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->status, 405);
    EXPECT_EQ(answer->get_header_value("Allow"), "GET, HEAD");
  };
  refused(asks.Post("/data/manifest.json", "x", "text/plain"));
  refused(asks.Put("/data/manifest.json", "x", "text/plain"));
  refused(asks.Delete("/data/manifest.json"));
  refused(asks.Patch("/", "x", "text/plain"));
  refused(asks.Options("/"));
  EXPECT_EQ(read_bytes((folder() / "manifest.json").string()), before);
}

TEST_F(View, HeadHasNoBody) {
  for (const char* path : {"/", "/api/scene", "/data/tiles/0.drc"}) {
    const auto whole = get(path);
    const auto head = client().Head(path);
    ASSERT_TRUE(whole && head) << path;
    EXPECT_EQ(head->status, 200) << path;
    EXPECT_EQ(head->body, "") << path;
    EXPECT_EQ(head->get_header_value("Content-Length"), std::to_string(whole->body.size())) << path;
  }
  EXPECT_EQ(client().Head("/data/none")->status, 404);
}

TEST_F(View, KnowsWhatABrowserHas) {
  for (const char* path : {"/", "/data/tiles/0.drc"}) {
    const std::string tag = get(path)->get_header_value("ETag");
    ASSERT_NE(tag, "") << path;
    const auto known = get(path, {{"If-None-Match", tag}});
    EXPECT_EQ(known->status, 304) << path;
    EXPECT_EQ(known->body, "") << path;
    EXPECT_EQ(status_of(path, {{"If-None-Match", "\"another\""}}), 200) << path;
  }
  const std::string before = get("/data/tiles/0.drc")->get_header_value("ETag");
  write_bytes((folder() / "tiles/0.drc").string(), "changed");
  EXPECT_EQ(get("/data/tiles/0.drc", {{"If-None-Match", before}})->body, "changed");
}

// A page of a stranger may call the server by a name of its own that leads to this machine.
TEST_F(View, AnswersOnlyThoseWhoKnowItsName) {
  const std::string port = ":" + std::to_string(server_->port());
  for (const std::string& host : {"127.0.0.1" + port, "localhost" + port,
                                  std::string("[::1]") + port, std::string("localhost")})
    EXPECT_EQ(status_of("/data/manifest.json", {{"Host", host}}), 200) << host;
  for (const std::string& host :
       {"stranger.example" + port, std::string("127.0.0.1.stranger.example"), std::string("[::2]"),
        std::string("[")}) {
    EXPECT_EQ(status_of("/data/manifest.json", {{"Host", host}}), 403) << host;
    EXPECT_EQ(status_of("/", {{"Host", host}}), 403) << host;
  }
}

TEST_F(View, AnswersManyAtOnce) {
  const std::string bytes(3'000'000, 'x');
  write_bytes((folder() / "large.ply").string(), bytes);
  std::atomic<int> good{0};
  std::vector<std::thread> threads;
  threads.reserve(200);
  for (int i = 0; i < 200; ++i)
    threads.emplace_back([&, i] {
      auto asks = client();
      asks.set_read_timeout(60);
      const auto answer = asks.Get(i % 2 == 0 ? "/data/large.ply" : "/api/scene");
      good += answer && answer->status == 200 && (i % 2 == 1 || answer->body == bytes);
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(good, 200);
}

TEST_F(View, EndsWhileAnswering) {
  write_bytes((folder() / "large.ply").string(), "");
  fs::resize_file(folder() / "large.ply", std::uint64_t{1} << 40);  // no disk holds it
  std::atomic<bool> begun = false, whole = true;
  std::thread reader([&] {
    const auto answer = client().Get("/data/large.ply", [&](const char*, std::size_t) {
      begun = true;
      return true;
    });
    whole = static_cast<bool>(answer);
  });
  while (!begun) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  server_.reset();
  reader.join();
  EXPECT_FALSE(whole);
}

TEST_F(View, TakesNoPortThatIsTaken) {
  try {
    ViewServer second(folder(), {.port = server_->port()});
    FAIL() << "two servers listen on one port";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(),
                HasSubstr("cannot listen on 127.0.0.1, port " + std::to_string(server_->port())));
    EXPECT_THAT(error.what(), HasSubstr("--port"));
  }
  EXPECT_THROW(ViewServer(folder(), {.host = "192.0.2.1"}), InputError) << "of no machine";
}

TEST(ViewHost, LoopbackIsOfThisMachine) {
  for (const char* host : {"localhost", "127.0.0.1", "127.8.9.10", "::1"})
    EXPECT_TRUE(is_loopback(host)) << host;
  for (const char* host : {"0.0.0.0", "::", "10.0.0.1", "example.org", "128.0.0.1",
                           "127.evil.example", "127.0.0.1.evil.example", ""})
    EXPECT_FALSE(is_loopback(host)) << host;
}

}  // namespace
}  // namespace voxweld::testing
