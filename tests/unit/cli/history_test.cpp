#include "cli/history.hpp"

#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include <gtest/gtest.h>

namespace concord {
namespace {

Operation operation(std::int64_t revision, const std::string& author = "ann") {
  Operation made;
  made.revision = revision;
  made.id = "edit-" + std::to_string(revision);
  made.author = author;
  made.utime = 1'800'000'000'000'000 + revision;
  made.count = 1;
  made.min = made.max = {1, 2, 3};
  return made;
}

/// A merge that holds `held_` operations, played on the client's own bus; the first part it ever sends is lost.
class History : public testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(site_) << "lcm_url: memq://\n";
    common_.site_file = site_;
    common_.timeout = 5.0;
    live_ = std::make_unique<Live>(common_);
    live_->hear<HistoryRequest>("in/history_request",
                                [this](const std::string&, const HistoryRequest& asked) { reply(asked); });
  }
  void TearDown() override { std::filesystem::remove(site_); }

  void reply(const HistoryRequest& asked) {
    ++asked_;
    HistoryPart whole;
    whole.id = asked.id;
    for (std::int64_t r = asked.after_revision + 1; r <= held_ && whole.operations.size() < std::size_t(asked.most);
         ++r) {
      whole.operations.push_back(operation(r));
    }
    for (const HistoryPart& part : in_parts(std::move(whole))) {
      if (std::exchange(lose_one_, false)) continue;
      live_->bus().publish("out/history", encode(part, live_->bus().now()));
    }
  }

  std::filesystem::path site_ =
      std::filesystem::path(testing::TempDir()) / ("history" + std::to_string(getpid()) + ".yaml");
  Common common_;
  std::unique_ptr<Live> live_;
  std::int64_t held_ = 2500;
  int asked_ = 0;
  bool lose_one_ = true;
};

TEST_F(History, ArrivesWholePageAfterPageAlthoughPartsAreLost) {
  const auto all = request_history(*live_, {}, 1'000'000);
  ASSERT_TRUE(all) << all.error().message;
  ASSERT_EQ(all->size(), 2500U);
  for (std::size_t i = 0; i < all->size(); ++i) ASSERT_EQ((*all)[i].revision, static_cast<std::int64_t>(i) + 1);
  EXPECT_EQ(asked_, 4) << "three pages, the first of them twice";
}

TEST_F(History, EndsAtTheMostThatIsAskedFor) {
  HistoryRequest request;
  request.after_revision = 100;
  const auto some = request_history(*live_, request, 1001);
  ASSERT_TRUE(some);
  EXPECT_EQ(some->size(), 1001U);
  EXPECT_EQ(some->front().revision, 101);
}

TEST_F(History, OfNothingIsEmpty) {
  held_ = 0;
  const auto none = request_history(*live_, {}, 10);
  ASSERT_TRUE(none);
  EXPECT_TRUE(none->empty());
}

TEST(HistoryText, CsvQuotesWhatRfc4180Says) {
  Operation zone = operation(7, "a\"b");
  zone.kind = Operation::Kind::kZoneAdd;
  zone.subject = "Pit, deep";
  EXPECT_EQ(to_csv({operation(6), zone}, 0.5),
            "revision,time,author,kind,subject,id,voxels,undone,min_x,min_y,min_z,max_x,max_y,max_z\r\n"
            "6,2027-01-15T08:00:00.000006Z,ann,add,,edit-6,1,false,0.5000,1.0000,1.5000,1.0000,1.5000,2.0000\r\n"
            "7,2027-01-15T08:00:00.000007Z,\"a\"\"b\",zone-add,\"Pit, deep\",edit-7,1,false,,,,,,\r\n");
}

TEST(HistoryText, TheTableSaysWhatWasUndone) {
  Operation undone = operation(6);
  undone.active = false;
  setenv("TZ", "UTC", 1);
  tzset();
  const std::string table = to_words(std::vector{undone}, 0.5);
  EXPECT_NE(table.find("6  2027-01-15 08:00:00  ann  add"), std::string::npos) << table;
  EXPECT_NE(table.find("0.50..1.00  1.00..1.50  1.50..2.00  undone  edit-6"), std::string::npos) << table;
  unsetenv("TZ");
  tzset();
  EXPECT_TRUE(to_json(std::vector{undone}, 0.5)["operations"][0]["undone"]);
}

}  // namespace
}  // namespace concord
