#include "bus/recent_answers.hpp"

#include <xxhash.h>

namespace concord {

bool RecentAnswers::repeat(const std::string& id, const std::string& process, std::uint64_t content,
                           std::int64_t asked) const {
  const auto it = by_id_.find(id);
  if (it == by_id_.end()) return false;
  const Given& given = it->second;
  const bool is_same = given.content == content;
  if (!given.answer.ok && (!is_same || given.asked != asked || bus_.now() - given.utime >= kRefusalHolds)) return false;
  if (is_same) {
    answer(bus_, given.answer);
  } else {
    answer(bus_, {id, process, false, name(Code::kExists), "another request had this id; ids must be unique", 0, 0});
  }
  return true;
}

void RecentAnswers::give(const Answer& value, std::uint64_t content, std::int64_t asked) {
  answer(bus_, value);
  if (value.code == name(Code::kBusy)) return;
  if (!by_id_.contains(value.id)) order_.push_back(value.id);
  by_id_[value.id] = {value, content, asked, bus_.now()};
  if (order_.size() <= kKept) return;
  by_id_.erase(order_.front());
  order_.pop_front();
}

std::uint64_t content_of(const Bytes& message) { return XXH3_64bits(message.data(), message.size()); }

}  // namespace concord
