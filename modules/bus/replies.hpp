#pragma once

#include <cstdint>
#include <string>

#include "bus/messages.hpp"
#include "bus/process.hpp"

namespace concord {

/// What a process answers to who asked.
class Replies {
 public:
  explicit Replies(const NodeContext& context) : context_(context) {}

  [[nodiscard]] Answer granted(const std::string& id, std::int64_t revision, std::int64_t count,
                               const std::string& message) const {
    return {id, context_.process, true, "OK", message, revision, count};
  }
  void grant(const std::string& id, std::int64_t revision, std::int64_t count, const std::string& message) const {
    answer(context_.bus, granted(id, revision, count, message));
  }
  /// Counted by the channel that it was asked on.
  [[nodiscard]] Answer denied(const std::string& channel, const std::string& id, const Error& error) const {
    context_.counters.refused(channel, error);
    return {id, context_.process, false, name(error.code), error.message, 0, 0};
  }
  void deny(const std::string& channel, const std::string& id, const Error& error) const {
    answer(context_.bus, denied(channel, id, error));
  }

 private:
  NodeContext context_;
};

}  // namespace concord
