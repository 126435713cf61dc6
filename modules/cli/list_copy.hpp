#pragma once

#include <string>
#include <vector>

#include "bus/list_stream.hpp"
#include "cli/live.hpp"

namespace concord {

/// A copy of one list stream of the running stack. Must live as long as `live` handles messages.
template <class T>
class ListCopy {
 public:
  /// @param process the one that says it
  ListCopy(Live& live, const std::string& process, const std::string& list)
      : process_(process), list_(list), receiver_(live.bus(), live.counters(), list, [](const std::vector<T>&) {}) {
    live.hear<ListDigest>(ListChannels(list).digest, [this](const std::string&, const ListDigest&) { heard_ = true; });
  }

  /// The list, whole. Fails with kNoAnswer when nobody speaks, with kIncomplete when it did not arrive whole in time.
  [[nodiscard]] tl::expected<std::vector<T>, Failure> wait_synced(Live& live) {
    if (live.wait(live.timeout(), [this] { return receiver_.synced(); })) return receiver_.items();
    if (!heard_) return live.no_answer(process_);
    return fail(Exit::kIncomplete, "INCOMPLETE", list_ + " has not arrived whole; give a longer --timeout");
  }

 private:
  std::string process_, list_;
  bool heard_ = false;
  ListReceiver<T> receiver_;
};

}  // namespace concord
