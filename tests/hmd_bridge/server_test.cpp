// The server over real sockets with TLS: who gets in, and what no client can do to it.

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include "protocol/control.hpp"
#include "rig.hpp"
#include "tls_client.hpp"

namespace concord::hmd {
namespace {

HelloRequest hello_of(std::optional<std::string> ticket = {}) {
  HelloRequest hello;
  hello.version = kProtocol;
  hello.name = "ana";
  hello.device = "test";
  hello.ticket = std::move(ticket);
  return hello;
}

std::string get(const std::string& target, const std::string& host = "localhost") {
  return "GET " + target + " HTTP/1.1\r\nHost: " + host + "\r\n\r\n";
}

int status_of(const std::string& answer) { return answer.size() > 12 ? std::stoi(answer.substr(9, 3)) : 0; }
Json body_of(const std::string& answer) { return Json::parse(answer.substr(answer.find("\r\n\r\n") + 4)); }

/// What the answer to the request `id` is: OK or a code; "none" if none comes.
std::string outcome(TlsClient& client, std::int64_t id) {
  const auto text = client.read_text([id](const std::string& t) {
    const Json json = Json::parse(t);
    return json.contains("id") && json["id"] == id;
  });
  if (!text) return "none";
  const Json json = Json::parse(*text);
  return json.contains("error") ? json["error"]["code"].get<std::string>() : "OK";
}

class Served : public testing::Test {
 protected:
  /// The server serves on, whatever was done to it.
  void TearDown() override {
    TlsClient client(rig.port());
    ASSERT_EQ(client.upgrade("localhost"), 101);
    client.send_text(request_text(1, hello_of()));
    EXPECT_EQ(outcome(client, 1), "OK");
    client.send_text(request_text(2, AgentsRequest{}));
    EXPECT_EQ(outcome(client, 2), "OK");
  }
  std::string ticket_for(const std::string& token) {
    TlsClient client(rig.port());
    const std::string answer = client.http("POST /api/ticket HTTP/1.1\r\nHost: lab\r\nAuthorization: Bearer " + token +
                                           "\r\nContent-Length: 0\r\n\r\n");
    return status_of(answer) == 200 ? body_of(answer)["ticket"].get<std::string>() : std::to_string(status_of(answer));
  }

  Rig rig{{.header_seconds = 1, .idle_seconds = 2, .close_seconds = 1, .local_role = Role::kEdit, .others = {}}};
};

TEST(GivenListener, IsServedBesideItsOwn) {
  const int listener = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(address);
  ASSERT_EQ(bind(listener, reinterpret_cast<sockaddr*>(&address), size), 0);
  ASSERT_EQ(::listen(listener, 8), 0);
  ASSERT_EQ(getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size), 0);
  const Rig rig({.others = {}, .listener = listener});
  for (const std::uint16_t port : {ntohs(address.sin_port), rig.port()}) {
    TlsClient client(port);
    EXPECT_EQ(status_of(client.http(get("/"))), 200);
  }
}

TEST_F(Served, FilesOfTheClientAndNothingElse) {
  TlsClient client(rig.port());
  EXPECT_EQ(status_of(client.http(get("/"))), 200);
  const std::string info = client.http(get("/api/info"));
  EXPECT_EQ(body_of(info)["protocol"], "hmd.v1");
  EXPECT_FALSE(body_of(info)["ticket_needed"].get<bool>());
  EXPECT_TRUE(body_of(client.http(get("/api/info", "lab.example")))["ticket_needed"].get<bool>());
  for (const char* target : {"/../secret.txt", "/..%2fsecret.txt", "/web/../../secret.txt", "/tokens.db", "/cert.pem",
                             "/%00", "//etc/passwd"}) {
    const std::string answer = client.http(get(target));
    EXPECT_EQ(status_of(answer), 404) << target;
    EXPECT_EQ(answer.find("secret\n"), std::string::npos);
  }
  EXPECT_EQ(status_of(client.http("DELETE / HTTP/1.1\r\nHost: localhost\r\n\r\n")), 405);
}

TEST_F(Served, FromElsewhereNobodyGetsInWithoutATokenAndATicketIsUsedOnce) {
  TlsClient nobody(rig.port());
  ASSERT_EQ(nobody.upgrade("lab"), 101);
  nobody.send_text(request_text(1, hello_of()));
  EXPECT_EQ(outcome(nobody, 1), "BAD_TOKEN");
  nobody.read();
  EXPECT_TRUE(!nobody.read(3) && nobody.closed());
  EXPECT_EQ(nobody.close_code(), 1008);

  EXPECT_EQ(ticket_for("concord_wrong"), "401");
  const std::string token = rig.tokens().add("bert", Role::kView, 1).value();
  const std::string ticket = ticket_for(token);
  ASSERT_EQ(ticket.size(), 43u);
  TlsClient bert(rig.port());
  ASSERT_EQ(bert.upgrade("lab"), 101);
  bert.send_text(request_text(1, hello_of(ticket)));
  EXPECT_EQ(outcome(bert, 1), "OK");
  bert.send_text(request_text(2, ResetRequest{"robot1"}));
  EXPECT_EQ(outcome(bert, 2), "DENIED");
  TlsClient replay(rig.port());
  ASSERT_EQ(replay.upgrade("lab"), 101);
  replay.send_text(request_text(1, hello_of(ticket)));
  EXPECT_EQ(outcome(replay, 1), "BAD_TOKEN");
}

TEST_F(Served, TriesOfTokensAreLimited) {
  int refused = 0;
  for (int i = 0; i < 40; ++i) refused += ticket_for("concord_guess" + std::to_string(i)) == "429" ? 1 : 0;
  EXPECT_GT(refused, 0);
}

TEST_F(Served, PagesFromElsewhereAreRefused) {
  EXPECT_EQ(TlsClient(rig.port()).upgrade("localhost", "https://evil.example"), 403);
  EXPECT_EQ(TlsClient(rig.port()).upgrade("localhost", "null"), 403);
  EXPECT_EQ(TlsClient(rig.port()).upgrade("localhost:1", "https://localhost:1"), 101);
  EXPECT_EQ(TlsClient(rig.port()).upgrade("localhost", "", "other.v1"), 400);
  // One that the site file lists may connect; it is not local for that.
  TlsClient listed(rig.port());
  ASSERT_EQ(listed.upgrade("localhost", "https://lab.example"), 101);
  listed.send_text(request_text(1, hello_of()));
  EXPECT_EQ(outcome(listed, 1), "BAD_TOKEN");
  // A name that was made to resolve to this machine: its page passes for its own origin, but is not local.
  TlsClient rebound(rig.port());
  ASSERT_EQ(rebound.upgrade("evil.example", "https://evil.example"), 101);
  rebound.send_text(request_text(1, hello_of()));
  EXPECT_EQ(outcome(rebound, 1), "BAD_TOKEN");
}

TEST_F(Served, WhatIsTooLargeIsRefused) {
  TlsClient header(rig.port());
  EXPECT_NE(status_of(header.http("GET / HTTP/1.1\r\nHost: localhost\r\nX: " + std::string(20'000, 'x') + "\r\n\r\n")),
            200);
  TlsClient body(rig.port());
  EXPECT_NE(status_of(body.http("POST /api/ticket HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1000000\r\n\r\n")),
            200);
  TlsClient text(rig.port());
  ASSERT_EQ(text.upgrade("localhost"), 101);
  text.send_text(request_text(1, hello_of()));
  EXPECT_EQ(outcome(text, 1), "OK");
  text.send_text("{\"id\":2," + std::string(5 << 20, ' ') + "}");
  while (text.read(3)) {
  }
  EXPECT_TRUE(text.closed());
  TlsClient binary(rig.port());
  ASSERT_EQ(binary.upgrade("localhost"), 101);
  binary.send_text(request_text(1, hello_of()));
  EXPECT_EQ(outcome(binary, 1), "OK");
  // A payload that claims to inflate to 4 GiB.
  Bytes bomb(24 + 100, 0);
  bomb[0] = 65;
  bomb[1] = 1;
  bomb[4] = 2;
  for (int i = 12; i < 16; ++i) bomb[static_cast<std::size_t>(i)] = 0xFF;
  binary.send_binary(bomb);
  EXPECT_EQ(outcome(binary, 2), "TOO_LARGE");
}

TEST_F(Served, MalformedMessagesAreToldAndAFloodOfThemEnds) {
  TlsClient client(rig.port());
  ASSERT_EQ(client.upgrade("localhost"), 101);
  client.send_text(request_text(1, hello_of()));
  EXPECT_EQ(outcome(client, 1), "OK");
  client.send_text("{");
  ASSERT_TRUE(client.read_text([](const std::string& t) { return t.find("\"bad\"") != std::string::npos; }));
  client.send_text(R"({"id":2,"request":"agents","body":{"x":1}})");
  EXPECT_EQ(outcome(client, 2), "BAD_MESSAGE");
  client.send_binary(Bytes{1, 2, 3});
  client.send_text(request_text(3, AgentsRequest{}));
  EXPECT_EQ(outcome(client, 3), "OK");
  for (int i = 0; i < 300 && client.send_text("[[[["); ++i) {
  }
  while (client.read(3)) {
  }
  EXPECT_TRUE(client.closed());
}

TEST_F(Served, AFloodOfRequestsEnds) {
  TlsClient client(rig.port());
  ASSERT_EQ(client.upgrade("localhost"), 101);
  client.send_text(request_text(1, hello_of()));
  for (int i = 2; i < 2000 && client.send_text(request_text(i, AgentsRequest{})); ++i) {
  }
  while (client.read(3)) {
  }
  EXPECT_TRUE(client.closed());
}

TEST_F(Served, WhoSendsSlowlyIsCutOff) {
  TlsClient loris(rig.port());
  ASSERT_TRUE(loris.send_raw("GET / HTTP/1.1\r\nHost: lo"));
  EXPECT_TRUE(loris.http("").empty()) << "the header's time is over";
  TlsClient silent(rig.port());
  ASSERT_EQ(silent.upgrade("localhost"), 101);
  while (silent.read(8)) {
  }
  EXPECT_EQ(silent.close_code(), 1008) << "no hello within 5 s";
}

class Models : public Served {
 protected:
  void SetUp() override { make("large", kBytes); }
  void make(const std::string& name, std::size_t bytes) {
    const auto file = rig.folder() / "models" / (name + ".glb");
    std::ofstream out(file);
    out.close();
    std::filesystem::resize_file(file, bytes);
  }
  static constexpr std::size_t kBytes = 60 << 20;
  static constexpr int kWindow = 64 << 10;
};

TEST_F(Models, WhoTakesSlowlyWhatIsLargeIsServedToTheEnd) {
  TlsClient slow(rig.port(), kWindow);
  ASSERT_TRUE(slow.http_begin(get("/models/large.glb")).ends_with("200"));
  const auto start = std::chrono::steady_clock::now();
  const std::size_t got = slow.read_slowly(kBytes, kBytes / 2.5);
  EXPECT_GE(got, kBytes);
  EXPECT_GT(std::chrono::steady_clock::now() - start, std::chrono::seconds(2)) << "longer than any of it may take";
}

TEST_F(Models, WhoStopsTakingIsCutOff) {
  TlsClient stuck(rig.port(), kWindow);
  ASSERT_TRUE(stuck.http_begin(get("/models/large.glb")).ends_with("200"));
  // Another is served meanwhile, for longer than anybody may stand still.
  TlsClient slow(rig.port(), kWindow);
  ASSERT_TRUE(slow.http_begin(get("/models/large.glb")).ends_with("200"));
  EXPECT_GE(slow.read_slowly(kBytes, kBytes / 2.5), kBytes);
  EXPECT_LT(stuck.read_slowly(kBytes, 1e12), kBytes) << "there is no more than what was under way";
}

TEST_F(Models, BytesForOneNetworkAreBounded) {
  std::vector<std::unique_ptr<TlsClient>> clients;
  std::vector<std::string> said;
  for (int i = 0; i < 6; ++i) {
    clients.push_back(std::make_unique<TlsClient>(rig.port(), kWindow));
    said.push_back(clients.back()->http_begin(get("/models/large.glb")));
  }
  EXPECT_TRUE(said.front().ends_with("200"));
  EXPECT_TRUE(said.back().ends_with("429")) << "6 x 60 MB at once: " << said.back();
}

TEST_F(Served, WhoIsRefusedAtTheDoorIsALineOfTheAudit) {
  std::ostringstream log;
  const auto sink = std::make_shared<spdlog::sinks::ostream_sink_mt>(log);
  spdlog::default_logger()->sinks().push_back(sink);
  EXPECT_EQ(ticket_for("concord_wrong"), "401");
  EXPECT_EQ(TlsClient(rig.port()).upgrade("localhost", "https://evil.example"), 403);
  for (int i = 0; i < 40; ++i) (void)ticket_for("concord_guess");
  std::string lines;
  rig.in_server([&](BridgeNode&, Bus&) {
    spdlog::default_logger()->sinks().pop_back();
    lines = log.str();
  });
  EXPECT_NE(lines.find("audit: refused from=127.0.0.1 request=ticket outcome=401"), std::string::npos) << lines;
  EXPECT_NE(lines.find("audit: refused from=127.0.0.1 request=connection outcome=403"), std::string::npos) << lines;
  EXPECT_NE(lines.find("audit: refused from=127.0.0.1 request=ticket outcome=429"), std::string::npos) << lines;
}

TEST_F(Served, OneWhoReadsNothingHoldsNobodyUp) {
  TlsClient stalled(rig.port());
  ASSERT_EQ(stalled.upgrade("localhost"), 101);
  stalled.send_text(request_text(1, hello_of()));
  EXPECT_EQ(outcome(stalled, 1), "OK");
  rig.in_server([](BridgeNode& node, Bus&) {
    ASSERT_EQ(node.hub().sessions().size(), 1u);
    Outbox& outbox = node.hub().sessions().begin()->second.outbox;
    const auto text = std::make_shared<const std::string>(event_text(BadEvent{std::string(300, 'x')}));
    for (int i = 0; i < 20'000; ++i) {
      outbox.lossless(text);
      ASSERT_LE(outbox.waiting_bytes(), Outbox::kMostBytes);
    }
    EXPECT_TRUE(outbox.overflowed());
  });
  rig.wait_for([](BridgeNode& node) { return node.hub().connected() == 0; });  // it is cut off, with no help of its own
  TlsClient other(rig.port());
  ASSERT_EQ(other.upgrade("localhost"), 101);
  other.send_text(request_text(1, hello_of()));
  EXPECT_EQ(outcome(other, 1), "OK");
  for (int i = 2; i < 60; ++i) {
    other.send_text(request_text(i, AgentsRequest{}));
    EXPECT_EQ(outcome(other, i), "OK");
  }
}

}  // namespace
}  // namespace concord::hmd
