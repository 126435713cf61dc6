#include "bus/counters.hpp"

#include <bit>

#include <spdlog/spdlog.h>

namespace concord {
namespace {

const std::string kRefused = "refused.";

}  // namespace

void Counters::refused(const std::string& what, const Error& error) {
  std::int64_t& count = slot(kRefused + what + "." + name(error.code));
  ++count;
  if (std::has_single_bit(static_cast<std::uint64_t>(count))) {
    spdlog::warn("refused on {}: {} ({}, {} times)", what, error.message, name(error.code), count);
  }
}

std::int64_t Counters::get(const std::string& name) const {
  const auto it = values_.find(name);
  return it != values_.end() ? it->second : 0;
}

std::int64_t& Counters::slot(const std::string& name) {
  const auto it = values_.find(name);
  if (it != values_.end()) return it->second;
  const bool may_be_pooled = name.starts_with(kRefused);
  return values_[may_be_pooled && values_.size() >= kMaxNames ? kRefused + "other" : name];
}

}  // namespace concord
