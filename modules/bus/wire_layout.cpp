#include "bus/wire_layout.hpp"

#include <optional>
#include <string_view>

#include "core/text.hpp"

namespace concord {
namespace {

/// Walks a message; stops at the first thing that is not so.
class Walk {
 public:
  explicit Walk(std::span<const std::uint8_t> bytes) : rest_(bytes) {}

  bool fields(std::span<const WireField> layout) {
    for (const WireField& field : layout) {
      if (!one(field)) return false;
    }
    return true;
  }
  bool skip(std::int64_t bytes) {
    if (bytes > static_cast<std::int64_t>(rest_.size())) return false;
    rest_ = rest_.subspan(static_cast<std::size_t>(bytes));
    return true;
  }
  [[nodiscard]] bool done() const { return rest_.empty(); }
  [[nodiscard]] bool too_large() const { return too_large_; }

 private:
  bool one(const WireField& field) {
    switch (field.kind) {
      case WireField::Kind::kFixed: return skip(field.bytes);
      case WireField::Kind::kText: return one_text(field.bytes);
      case WireField::Kind::kCount: return one_count(field.bytes);
      case WireField::Kind::kArray: return skip(count_ * field.bytes);
      case WireField::Kind::kTexts: return repeat([&] { return one_text(field.bytes); });
      case WireField::Kind::kRecord: return one_record(field.record);
      case WireField::Kind::kRecords: return repeat([&] { return one_record(field.record); });
    }
    return false;
  }

  template <class Each>
  bool repeat(Each each) {
    for (std::int64_t i = 0, times = count_; i < times; ++i) {
      if (!each()) return false;
    }
    return true;
  }

  /// What follows a record repeats the count before it, not one within.
  bool one_record(std::span<const WireField> record) {
    const std::int64_t outer = count_;
    const bool fine = fields(record);
    count_ = outer;
    return fine;
  }

  bool one_count(std::int64_t most) {
    const std::optional<std::int32_t> value = int32();
    if (!value || *value < 0) return false;
    if (*value > most) return fail_too_large();
    count_ = *value;
    return true;
  }

  bool one_text(std::int64_t most) {
    const std::optional<std::int32_t> length = int32();
    if (!length || *length < 1) return false;
    if (*length - 1 > most) return fail_too_large();
    const auto size = static_cast<std::size_t>(*length);
    if (size > rest_.size() || rest_[size - 1] != 0) return false;
    if (!is_utf8({reinterpret_cast<const char*>(rest_.data()), size - 1})) return false;
    return skip(*length);
  }

  std::optional<std::int32_t> int32() {
    if (rest_.size() < 4) return std::nullopt;
    const std::uint32_t value = std::uint32_t{rest_[0]} << 24 | std::uint32_t{rest_[1]} << 16 |
                                std::uint32_t{rest_[2]} << 8 | std::uint32_t{rest_[3]};
    rest_ = rest_.subspan(4);
    return static_cast<std::int32_t>(value);
  }

  bool fail_too_large() {
    too_large_ = true;
    return false;
  }

  std::span<const std::uint8_t> rest_;
  std::int64_t count_ = 0;
  bool too_large_ = false;
};

constexpr std::int64_t kFingerprintBytes = 8;

}  // namespace

WireFit fits(std::span<const std::uint8_t> bytes, std::span<const WireField> layout) {
  Walk walk(bytes);
  if (walk.skip(kFingerprintBytes) && walk.fields(layout) && walk.done()) return WireFit::kFits;
  return walk.too_large() ? WireFit::kTooLarge : WireFit::kMalformed;
}

}  // namespace concord
