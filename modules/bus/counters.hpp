#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "core/error.hpp"

namespace concord {

/// What a process has counted since its start; published in its status once a second.
class Counters {
 public:
  /// A lab sees every refusal, but a hostile sender must not fill memory: beyond this many names further refusals count
  /// as "refused.other".
  static constexpr std::size_t kMaxNames = 200;

  void add(const std::string& name, std::int64_t amount = 1) { slot(name) += amount; }
  void set(const std::string& name, std::int64_t value) { slot(name) = value; }
  /// Counts as "refused.<what>.<CODE>" and logs the first of its kind and each power of two.
  void refused(const std::string& what, const Error& error);

  [[nodiscard]] std::int64_t get(const std::string& name) const;
  [[nodiscard]] const std::map<std::string, std::int64_t>& all() const { return values_; }

 private:
  std::int64_t& slot(const std::string& name);

  std::map<std::string, std::int64_t> values_;
};

}  // namespace concord
