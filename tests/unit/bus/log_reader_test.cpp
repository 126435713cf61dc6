#include "bus/log_reader.hpp"

#include <gtest/gtest.h>

#include <lcm/lcm-cpp.hpp>

namespace concord::test {
namespace {

class LogReaderTest : public testing::Test {
 protected:
  void SetUp() override {
    file_ = std::filesystem::path(testing::TempDir()) /
            ("log_reader_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::remove(file_);
  }
  void TearDown() override { std::filesystem::remove(file_); }

  /// Written by LCM's own code.
  Bytes stock_log() {
    {
      lcm::LogFile log(file_.string(), "w");
      Bytes data = {1, 2, 3};
      for (const char* channel : {"in/a", "out/map/bricks"}) {
        lcm::LogEvent event{};
        event.timestamp = 1'700'000'000'000'000 + static_cast<std::int64_t>(data.size());
        event.channel = channel;
        event.datalen = static_cast<std::int32_t>(data.size());
        event.data = data.data();
        log.writeEvent(&event);
        data.push_back(9);
      }
    }
    std::ifstream in(file_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  struct Read {
    int events = 0;  ///< before the end
    std::string refusal;
    std::optional<LogCut> cut;
  };
  Read read(const Bytes& bytes) {
    std::ofstream(file_, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    auto reader = LogReader::open(file_);
    if (!reader) return {0, name(reader.error().code), {}};
    for (int events = 0;; ++events) {
      const auto event = reader->next();
      if (!event) return {events, name(event.error().code), {}};
      if (!*event) return {events, "", reader->cut()};
    }
  }

  std::filesystem::path file_;
};

TEST_F(LogReaderTest, reads_what_lcm_writes) {
  (void)stock_log();
  auto reader = LogReader::open(file_);
  ASSERT_TRUE(reader);
  auto event = reader->next();
  ASSERT_TRUE(event && *event);
  EXPECT_EQ((*event)->utime, 1'700'000'000'000'003);
  EXPECT_EQ((*event)->channel, "in/a");
  EXPECT_EQ((*event)->bytes, (Bytes{1, 2, 3}));
  event = reader->next();
  ASSERT_TRUE(event && *event);
  EXPECT_EQ((*event)->channel, "out/map/bricks");
  EXPECT_EQ((*event)->bytes, (Bytes{1, 2, 3, 9}));
  event = reader->next();
  ASSERT_TRUE(event);
  EXPECT_FALSE(*event);
}

TEST_F(LogReaderTest, a_log_cut_anywhere_gives_its_whole_events_and_the_place) {
  const Bytes whole = stock_log();
  const std::size_t first = 28 + 4 + 3;
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const Read ended = read(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)));
    EXPECT_EQ(ended.events, size >= first ? 1 : 0) << size;
    EXPECT_EQ(ended.refusal, "") << size;
    ASSERT_EQ(ended.cut.has_value(), size != 0 && size != first) << size;
    if (!ended.cut) continue;
    EXPECT_EQ(ended.cut->whole_events, ended.events) << size;
    EXPECT_EQ(ended.cut->byte, size >= first ? first : 0) << size;
    EXPECT_EQ(ended.cut->bytes_lost, size - ended.cut->byte) << size;
  }
}

TEST_F(LogReaderTest, zeros_to_the_end_are_a_cut_and_anything_else_is_damage) {
  Bytes bytes = stock_log();
  const std::size_t whole = bytes.size();
  bytes.resize(whole + 100'000, 0);
  const Read ended = read(bytes);
  EXPECT_EQ(ended.events, 2);
  ASSERT_TRUE(ended.cut);
  EXPECT_EQ(ended.cut->byte, whole);
  bytes.back() = 1;
  EXPECT_EQ(read(bytes).refusal, "MALFORMED");
  bytes.resize(whole);
  bytes.push_back('x');
  EXPECT_EQ(read(bytes).refusal, "MALFORMED");
}

TEST_F(LogReaderTest, damaged_headers_are_refused_before_memory_is_taken) {
  const Bytes whole = stock_log();
  const auto damaged = [&](std::size_t at, std::uint8_t value) {
    Bytes bytes = whole;
    bytes[at] = value;
    return read(bytes).refusal;
  };
  EXPECT_EQ(damaged(0, 0), "MALFORMED");      // sync word
  EXPECT_EQ(damaged(12, 0xFF), "MALFORMED");  // a time before 1970
  EXPECT_EQ(damaged(20, 0xFF), "MALFORMED");  // length of the channel
  EXPECT_EQ(damaged(23, 0), "MALFORMED");
  EXPECT_EQ(damaged(24, 0xFF), "TOO_LARGE");  // length of the data
  EXPECT_EQ(damaged(24, 0x0F), "");           // 240 MiB, which the file does not hold: cut there
}

TEST_F(LogReaderTest, files_that_are_no_log_are_refused) {
  EXPECT_EQ(name(LogReader::open(file_).error().code), std::string("IO"));
  EXPECT_EQ(name(LogReader::open(testing::TempDir()).error().code), std::string("IO"));
  EXPECT_EQ(read(Bytes(1000, 'x')).refusal, "MALFORMED");
  EXPECT_EQ(read({'x'}).refusal, "MALFORMED");
}

}  // namespace
}  // namespace concord::test
