#include "bus/wire_layout.hpp"

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
  /// What is over which limit; empty: nothing is.
  [[nodiscard]] const std::string& excess() const { return excess_; }

  std::optional<std::string_view> text(std::int64_t most) {
    const std::optional<std::int32_t> length = int32();
    if (!length || *length < 1) return std::nullopt;
    if (*length - 1 > most) {
      exceed("a text of " + std::to_string(*length - 1) + " bytes", most);
      return std::nullopt;
    }
    const auto size = static_cast<std::size_t>(*length);
    if (size > rest_.size() || rest_[size - 1] != 0) return std::nullopt;
    const std::string_view text(reinterpret_cast<const char*>(rest_.data()), size - 1);
    if (!is_utf8(text)) return std::nullopt;
    rest_ = rest_.subspan(size);
    return text;
  }

 private:
  bool one(const WireField& field) {
    switch (field.kind) {
      case WireField::Kind::kFixed: return skip(field.bytes);
      case WireField::Kind::kText: return text(field.bytes).has_value();
      case WireField::Kind::kCount: return one_count(field.bytes);
      case WireField::Kind::kArray: return skip(count_ * field.bytes);
      case WireField::Kind::kTexts: return repeat([&] { return text(field.bytes).has_value(); });
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
    if (*value > most) return exceed(std::to_string(*value) + " entries", most);
    count_ = *value;
    return true;
  }

  std::optional<std::int32_t> int32() {
    if (rest_.size() < 4) return std::nullopt;
    const std::uint32_t value = std::uint32_t{rest_[0]} << 24 | std::uint32_t{rest_[1]} << 16 |
                                std::uint32_t{rest_[2]} << 8 | std::uint32_t{rest_[3]};
    rest_ = rest_.subspan(4);
    return static_cast<std::int32_t>(value);
  }

  bool exceed(const std::string& what, std::int64_t most) {
    excess_ = what + " where at most " + std::to_string(most) + " are taken";
    return false;
  }

  std::span<const std::uint8_t> rest_;
  std::int64_t count_ = 0;
  std::string excess_;
};

constexpr std::int64_t kFingerprintBytes = 8;

}  // namespace

WireCheck check_layout(std::span<const std::uint8_t> bytes, std::span<const WireField> layout) {
  Walk walk(bytes);
  if (walk.skip(kFingerprintBytes) && walk.fields(layout) && walk.done()) return {};
  if (walk.excess().empty()) return {WireFit::kMalformed, {}};
  return {WireFit::kTooLarge, walk.excess()};
}

std::optional<std::string> text_at(std::span<const std::uint8_t> bytes, std::int64_t offset, std::int64_t most) {
  Walk walk(bytes);
  if (!walk.skip(kFingerprintBytes + offset)) return std::nullopt;
  const auto text = walk.text(most);
  return text ? std::optional<std::string>(*text) : std::nullopt;
}

}  // namespace concord
