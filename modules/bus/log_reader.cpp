#include "bus/log_reader.hpp"

#include <algorithm>
#include <array>

#include "bus/bus.hpp"

namespace concord {
namespace {

constexpr std::array<std::uint8_t, 4> kSyncWord = {0xED, 0xA1, 0xDA, 0x01};
constexpr std::size_t kHeaderBytes = 28;  // sync word, event number (8), utime (8), lengths of channel and data
constexpr std::uint32_t kMaxMessage = 1u << 28;

std::uint64_t big_endian(ByteSpan bytes) {
  std::uint64_t value = 0;
  for (const std::uint8_t byte : bytes) value = value << 8 | byte;
  return value;
}

}  // namespace

Result<LogReader> LogReader::open(const std::filesystem::path& file) {
  std::error_code error;
  const bool regular = std::filesystem::is_regular_file(file, error);
  const std::uintmax_t size = regular ? std::filesystem::file_size(file, error) : 0;
  LogReader reader(file, size);
  if (!regular || error || !reader.in_) return refuse(Code::kIo, file.string() + " cannot be read");
  return reader;
}

LogReader::LogReader(const std::filesystem::path& file, std::uintmax_t size)
    : name_(file.string()), in_(file, std::ios::binary), size_(size) {}

tl::unexpected<Error> LogReader::refuse_here(Code code, const std::string& what) const {
  return refuse(code, name_ + ": " + what + " at byte " + std::to_string(at_));
}

std::nullopt_t LogReader::cut_here() {
  cut_ = LogCut{events_, at_, size_ - at_};
  return std::nullopt;
}

bool LogReader::only_zeros_left() {
  in_.seekg(static_cast<std::streamoff>(at_));
  std::array<char, 1 << 14> part;
  for (std::uintmax_t left = size_ - at_; left > 0;) {
    const auto count = static_cast<std::streamsize>(std::min<std::uintmax_t>(left, part.size()));
    if (!in_.read(part.data(), count)) return false;
    if (std::any_of(part.begin(), part.begin() + count, [](char byte) { return byte != 0; })) return false;
    left -= static_cast<std::uintmax_t>(count);
  }
  return true;
}

Result<std::optional<LogEvent>> LogReader::next() {
  if (cut_ || at_ == size_) return std::nullopt;
  std::array<std::uint8_t, kHeaderBytes> header;
  const std::size_t held = std::min<std::uintmax_t>(size_ - at_, kHeaderBytes);
  if (!in_.read(reinterpret_cast<char*>(header.data()), static_cast<std::streamsize>(held))) {
    return refuse_here(Code::kIo, "cannot be read");
  }
  if (!std::equal(header.begin(), header.begin() + std::min(held, kSyncWord.size()), kSyncWord.begin())) {
    if (only_zeros_left()) return cut_here();
    return refuse_here(Code::kMalformed, "is no LCM log, or is damaged,");
  }
  if (held < kHeaderBytes) return cut_here();
  const auto field = [&](std::size_t offset, std::size_t size) {
    return big_endian(ByteSpan(header).subspan(offset, size));
  };
  const std::uint64_t channel_bytes = field(20, 4), data_bytes = field(24, 4);
  if (channel_bytes < 1 || channel_bytes > Bus::kMaxChannel) {
    return refuse_here(Code::kMalformed, "has a channel name that LCM could not carry");
  }
  if (data_bytes > kMaxMessage) return refuse_here(Code::kTooLarge, "has a message that LCM could not carry");
  if (channel_bytes + data_bytes > size_ - at_ - kHeaderBytes) return cut_here();

  LogEvent event{static_cast<std::int64_t>(field(12, 8)), std::string(channel_bytes, ' '), Bytes(data_bytes)};
  in_.read(event.channel.data(), static_cast<std::streamsize>(channel_bytes));
  in_.read(reinterpret_cast<char*>(event.bytes.data()), static_cast<std::streamsize>(data_bytes));
  if (!in_) return refuse_here(Code::kIo, "cannot be read");
  if (event.utime < 0) return refuse_here(Code::kMalformed, "has a time before 1970");
  at_ += kHeaderBytes + channel_bytes + data_bytes;
  ++events_;
  return event;
}

}  // namespace concord
