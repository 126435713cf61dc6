#pragma once

#include <cstdint>
#include <vector>

namespace concord {

/// What a search is to look at next: a heap with four children a node. The least key first, then the least id.
class OpenList {
 public:
  struct Entry {
    std::uint64_t key;
    std::uint32_t id;
    bool operator<(const Entry& other) const { return key != other.key ? key < other.key : id < other.id; }
  };

  [[nodiscard]] bool empty() const { return heap_.empty(); }
  [[nodiscard]] const Entry& top() const { return heap_.front(); }
  void clear() { heap_.clear(); }

  void push(Entry entry) {
    std::size_t i = heap_.size();
    heap_.push_back(entry);
    while (i > 0) {
      const std::size_t above = (i - 1) / 4;
      if (!(entry < heap_[above])) break;
      heap_[i] = heap_[above];
      i = above;
    }
    heap_[i] = entry;
  }

  void pop() {
    const Entry last = heap_.back();
    heap_.pop_back();
    const std::size_t size = heap_.size();
    if (size == 0) return;
    std::size_t i = 0;
    for (std::size_t child = 1; child < size; child = 4 * i + 1) {
      const std::size_t end = child + 4 < size ? child + 4 : size;
      std::size_t least = child;
      for (++child; child < end; ++child) {
        if (heap_[child] < heap_[least]) least = child;
      }
      if (!(heap_[least] < last)) break;
      heap_[i] = heap_[least];
      i = least;
    }
    heap_[i] = last;
  }

 private:
  std::vector<Entry> heap_;
};

}  // namespace concord
