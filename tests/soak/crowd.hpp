#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "bus/lcm_bus.hpp"
#include "bus/messages.hpp"
#include "request.hpp"

namespace concord::soak {

/// People who ask and repeat what they asked until somebody answers, as clients do: packets get lost, processes die.
class Crowd {
 public:
  using Answered = std::function<void(const Request&, const Answer&)>;

  /// `answered` hears the one answer that settles a request; BUSY does not, it is asked again.
  Crowd(LcmBus& bus, Counters& counters, Answered answered);

  /// @pre nobody waits for an answer to a request of this id.
  void ask(const Request& request);
  [[nodiscard]] bool waits(const std::string& author) const;
  [[nodiscard]] bool idle() const { return waiting_.empty(); }

 private:
  struct Waiting {
    Request request;
    std::int64_t repeat_at = 0;
  };

  void say(Waiting& waiting);
  void on_answer(const Answer& answer);

  LcmBus& bus_;
  Answered answered_;
  std::map<std::string, Waiting> waiting_;  ///< by request id
};

/// Everything merge's history holds, in the order of its revisions. Asks again until all of it has arrived.
/// @throws std::runtime_error when it does not within a minute.
[[nodiscard]] std::vector<Operation> read_history(LcmBus& bus, Counters& counters, const std::vector<LcmBus*>& others);

}  // namespace concord::soak
