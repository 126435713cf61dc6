#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include <stdlib.h>

#include "access/certificate.hpp"
#include "access/gate.hpp"
#include "access/token_store.hpp"
#include "server/static_files.hpp"
#include "store/database.hpp"

namespace concord::hmd {
namespace {

constexpr std::int64_t kNow = 1'700'000'000'000'000;

class Folder {
 public:
  Folder() {
    std::string pattern = "/tmp/concord-access-XXXXXX";
    EXPECT_NE(mkdtemp(pattern.data()), nullptr);
    path = pattern;
  }
  ~Folder() { std::filesystem::remove_all(path); }
  std::filesystem::path path;
};

TEST(Gate, ATicketOpensOnceAndForTenSeconds) {
  Gate gate(random_secret);
  const auto ticket = gate.issue({"ana", Role::kEdit}, kNow);
  ASSERT_TRUE(ticket);
  EXPECT_FALSE(gate.redeem(*ticket + "x", kNow));
  EXPECT_FALSE(gate.redeem("", kNow));
  ASSERT_TRUE(gate.redeem(*ticket, kNow + 9'999'999));
  EXPECT_FALSE(gate.redeem(*ticket, kNow + 9'999'999)) << "used";
  const auto late = gate.issue({"ana", Role::kEdit}, kNow);
  EXPECT_FALSE(gate.redeem(*late, kNow + 10'000'000));
}

TEST(Gate, TicketsAndAddressesAreBounded) {
  Gate gate(random_secret);
  for (std::size_t i = 0; i < Gate::kMaxTickets; ++i) ASSERT_TRUE(gate.issue({"ana", Role::kEdit}, kNow));
  EXPECT_FALSE(gate.issue({"ana", Role::kEdit}, kNow));
  EXPECT_TRUE(gate.issue({"ana", Role::kEdit}, kNow + 10'000'000)) << "old ones go";
  for (std::size_t i = 0; i < Gate::kMaxAddresses; ++i) ASSERT_TRUE(gate.may_try("10.0.0." + std::to_string(i), kNow));
  EXPECT_FALSE(gate.may_try("11.0.0.1", kNow));
  EXPECT_TRUE(gate.may_try("11.0.0.1", kNow + 60'000'000));
}

TEST(Gate, ANetworkTakesSoManyBytesAndWaits) {
  Gate gate(random_secret);
  constexpr std::size_t kModel = 64 << 20;
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(gate.may_take("2001:db8::1", kModel, kNow));
  EXPECT_FALSE(gate.may_take("2001:db8::2", kModel, kNow)) << "the same network";
  EXPECT_TRUE(gate.may_take("10.0.0.7", kModel, kNow));
  EXPECT_TRUE(gate.may_take("2001:db8::2", kModel, kNow + 5'000'000));
}

TEST(Gate, RequestsAndLinesOfTheLogAreBoundedByNetwork) {
  Gate gate([] { return std::string("secret"); });
  int asked = 0, noted = 0;
  for (int i = 0; i < 3000; ++i) {
    const std::string address = "2001:db8:0:1::" + std::to_string(i % 100);  // one network has them all
    asked += gate.may_ask(address, kNow) ? 1 : 0;
    noted += gate.may_be_noted(address, kNow) ? 1 : 0;
  }
  EXPECT_EQ(asked, 1000);
  EXPECT_EQ(noted, 100);
  EXPECT_TRUE(gate.may_ask("2001:db8:0:2::1", kNow)) << "others go on";
  EXPECT_TRUE(gate.may_ask("2001:db8:0:1::1", kNow + 1'000'000));
}

TEST(Gate, ManyDevicesOfOneIpv6NetworkComeInAtOnce) {
  Gate gate([] { return std::string("secret"); });
  for (int device = 0; device < 40; ++device) {
    const std::string address = "2001:db8:0:1::" + std::to_string(device);
    EXPECT_TRUE(gate.may_try(address, kNow) && gate.may_try(address, kNow)) << "a ticket, and with it in";
  }
  int tries = 0;
  for (int i = 0; i < 900; ++i) tries += gate.may_try("2001:db8:0:1::a" + std::to_string(i), kNow) ? 1 : 0;
  EXPECT_EQ(tries, 240 - 80) << "of all its addresses together";
  EXPECT_EQ(network_of("fe80::1%eth0"), network_of("fe80::2%eth1"));
}

TEST(Gate, AnAddressThatTriesTooOftenWaits) {
  Gate gate(random_secret);
  int tries = 0;
  while (gate.may_try("10.0.0.1", kNow)) ++tries;
  EXPECT_EQ(tries, 30);
  EXPECT_TRUE(gate.may_try("10.0.0.2", kNow));
  EXPECT_TRUE(gate.may_try("10.0.0.1", kNow + 1'000'000));
}

TEST(Origin, TheServerItselfAndThoseListed) {
  EXPECT_TRUE(origin_allowed("", "https", "lab:8443", {}));
  EXPECT_TRUE(origin_allowed("https://LAB:8443", "https", "lab:8443", {}));
  EXPECT_FALSE(origin_allowed("http://lab:8443", "https", "lab:8443", {}));
  EXPECT_FALSE(origin_allowed("https://lab:8443.evil.example", "https", "lab:8443", {}));
  EXPECT_FALSE(origin_allowed("null", "https", "lab:8443", {}));
  EXPECT_TRUE(origin_allowed("https://other.example", "https", "lab:8443", {"https://other.example"}));
}

TEST(Origin, OnlyThisMachinesOwnNamesAreLocal) {
  for (const char* host : {"localhost", "localhost:8443", "127.0.0.1:1", "[::1]:8443", "LOCALHOST"})
    EXPECT_TRUE(is_local_host(host)) << host;
  for (const char* host :
       {"", ":", ":80", "evil.example", "localhost.evil.example", "127.evil.example", "127.0.0.1.evil.example:80",
        "[::2]", "[::1", "[::1].evil.example", "[::1]:80.evil.example", "localhost:evil"}) {
    EXPECT_FALSE(is_local_host(host)) << host;
  }
  EXPECT_TRUE(is_loopback("127.0.0.1") && is_loopback("::1") && is_loopback("::ffff:127.0.0.1"));
  EXPECT_FALSE(is_loopback("10.0.0.1") || is_loopback("::ffff:10.0.0.1") || is_loopback(""));
}

TEST(TokenStore, TokensAreFoundByThemselvesOnlyAndNeverWritten) {
  const Folder folder;
  TokenStore store(folder.path / "bridge" / "tokens.db");
  const auto token = store.add("ana", Role::kRobot, kNow);
  ASSERT_TRUE(token) << token.error().message;
  const auto found = store.find(*token);
  ASSERT_TRUE(found && *found);
  EXPECT_EQ((*found)->name, "ana");
  EXPECT_EQ((*found)->role, Role::kRobot);
  EXPECT_FALSE(*store.find(*token + "x"));
  EXPECT_FALSE(*store.find("' OR 1=1 --"));
  EXPECT_EQ(store.add("ana", Role::kView, kNow).error().code, concord::Code::kExists);
  EXPECT_EQ(store.add("a/b", Role::kView, kNow).error().code, concord::Code::kBadName);
  ASSERT_EQ(store.list()->size(), 1u);
  for (const auto& file : std::filesystem::directory_iterator(folder.path / "bridge")) {
    std::ifstream in(file.path(), std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(in)), {});
    EXPECT_EQ(bytes.find(*token), std::string::npos) << file.path();
  }
  const Identity ana = **found;
  EXPECT_TRUE(*store.holds(ana));
  EXPECT_TRUE(store.remove("ana"));
  EXPECT_FALSE(*store.holds(ana));
  EXPECT_EQ(store.remove("ana").error().code, concord::Code::kNotFound);
  EXPECT_FALSE(*store.find(*token));
  const auto anew = store.add("ana", Role::kRobot, kNow);
  ASSERT_TRUE(anew);
  EXPECT_FALSE(*store.holds(ana)) << "the one that leaked, maybe";
  EXPECT_TRUE(*store.holds(**store.find(*anew)));
}

TEST(TokenStore, ATryWritesNothingAndWaitsForNobody) {
  const Folder folder;
  const std::filesystem::path file = folder.path / "bridge" / "tokens.db";
  TokenStore store(file);
  EXPECT_FALSE(*store.find("concord_guess")) << "nobody has made a token yet";
  EXPECT_FALSE(std::filesystem::exists(file));
  const std::string token = store.add("ana", Role::kRobot, kNow).value();
  const auto old = std::filesystem::last_write_time(file) - std::chrono::hours(1);
  std::filesystem::last_write_time(file, old);
  EXPECT_FALSE(*store.find("concord_guess"));
  EXPECT_EQ((**store.find(token)).name, "ana");
  EXPECT_EQ(std::filesystem::last_write_time(file), old);
  constexpr const char* kNoMigration[] = {""};  // its schema is there
  const Database writer(file, kNoMigration);
  const auto before = std::chrono::steady_clock::now();
  EXPECT_EQ(store.find(token).error().code, concord::Code::kBusy);
  EXPECT_LT(std::chrono::steady_clock::now() - before, std::chrono::seconds(1));
}

TEST(Secret, EachIsAnotherAndLong) {
  const std::string a = random_secret(), b = random_secret();
  EXPECT_EQ(a.size(), 43u);
  EXPECT_NE(a, b);
}

TEST(MadeCertificate, NamesAreCheckedBeforeTheyReachOpenSsl) {
  const auto made = make_certificate({"lab.example", "10.0.0.7", "::1"}, kNow / 1'000'000);
  ASSERT_TRUE(made) << made.error().message;
  EXPECT_TRUE(made->certificate.starts_with("-----BEGIN CERTIFICATE-----"));
  EXPECT_EQ(made->fingerprint.size(), 95u);
  EXPECT_FALSE(make_certificate({}, 0));
  EXPECT_FALSE(make_certificate({"lab,DNS:evil"}, 0));
  EXPECT_FALSE(make_certificate({"lab\nevil"}, 0));
}

TEST(StaticFiles, OnlyWhatWasThereAtTheStartIsServed) {
  const Folder folder;
  std::filesystem::create_directories(folder.path / "web" / "sub" / ".git");
  std::ofstream(folder.path / "secret.txt") << "secret";
  std::ofstream(folder.path / "web" / "index.html") << "page";
  std::ofstream(folder.path / "web" / "sub" / "a.js") << "script";
  std::ofstream(folder.path / "web" / "sub" / ".hidden") << "hidden";
  std::ofstream(folder.path / "web" / "sub" / ".git" / "config") << "hidden";
  StaticFiles files;
  ASSERT_TRUE(files.add(folder.path / "web", "/"));
  EXPECT_EQ(files.size(), 2u);
  ASSERT_NE(files.find("/"), nullptr);
  EXPECT_EQ(*files.find("/?a=b")->body, "page");
  EXPECT_EQ(files.find("/sub/a.js")->type, "text/javascript; charset=utf-8");
  for (const char* target : {"/../secret.txt", "/sub/../../secret.txt", "/%2e%2e/secret.txt", "//index.html", "/sub",
                             "/sub/", "", "index.html", "/sub/.hidden", "/sub/.git/config", "/sub/a.js/", "/sub\\a.js",
                             "/sub/a.js%00", "http://x/index.html"}) {
    EXPECT_EQ(files.find(target), nullptr) << target;
  }
  EXPECT_FALSE(files.add(folder.path / "none", "/"));
}

TEST(StaticFiles, ModelsAreFoundWhenTheyAreAskedForByAPlainNameAlone) {
  const Folder folder;
  std::filesystem::create_directories(folder.path / "gltf" / "sub");
  std::ofstream(folder.path / "secret.glb") << "secret";
  std::ofstream(folder.path / "gltf" / "secret.txt") << "secret";
  std::ofstream(folder.path / "gltf" / "sub" / "secret.glb") << "secret";
  StaticFiles files;
  EXPECT_EQ(files.find("/models/x/pallet.glb"), nullptr);
  files.serve_models("/models/x/", folder.path / "gltf");
  EXPECT_EQ(files.find("/models/x/pallet.glb"), nullptr);
  std::ofstream(folder.path / "gltf" / "pallet.glb") << "model";
  ASSERT_NE(files.find("/models/x/pallet.glb"), nullptr);
  EXPECT_EQ(files.find("/models/x/pallet.glb?1")->path, folder.path / "gltf" / "pallet.glb");
  EXPECT_EQ(files.find("/models/x/pallet.glb")->body, nullptr) << "it is read while it is sent";
  EXPECT_EQ(files.find("/models/x/pallet.glb")->type, "model/gltf-binary");
  std::filesystem::create_directory(folder.path / "gltf" / "folder.glb");
  EXPECT_EQ(files.find("/models/x/folder.glb"), nullptr);
  std::filesystem::resize_file(folder.path / "gltf" / "pallet.glb", StaticFiles::kMaxModelBytes);
  EXPECT_NE(files.find("/models/x/pallet.glb"), nullptr);
  std::filesystem::resize_file(folder.path / "gltf" / "pallet.glb", StaticFiles::kMaxModelBytes + 1);
  EXPECT_EQ(files.find("/models/x/pallet.glb"), nullptr) << "no model is that large";
  for (const char* target :
       {"/models/x/../secret.glb", "/models/x/sub/secret.glb", "/models/x/secret.txt", "/models/x/", "/models/x/.glb",
        "/models/pallet.glb", "/models/y/pallet.glb", "/models/x//pallet.glb", "/models/x/%2e%2e/secret.glb"}) {
    EXPECT_EQ(files.find(target), nullptr) << target;
  }
}

}  // namespace
}  // namespace concord::hmd
