#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bus/messages.hpp"
#include "players.hpp"
#include "request.hpp"

namespace concord::soak {

/// One person's program: a socket of its own, copies of what it shows, and requests that it repeats until somebody
/// answers, as clients do: packets get lost, processes die.
class Client {
 public:
  using Answered = std::function<void(const Request&, const Answer&)>;

  /// `answered` hears the one answer that settles a request; BUSY does not, it is asked again.
  Client(const test::Host& host, std::string author, Answered answered);

  /// @pre idle().
  void ask(const Request& request);
  [[nodiscard]] bool idle() const { return !waiting_.has_value(); }

  [[nodiscard]] const std::string& author() const { return author_; }
  [[nodiscard]] const Observer& sees() const { return *observer_; }
  /// Forgets what it holds and joins late.
  void look_anew() { observer_ = std::make_unique<Observer>(host_); }
  [[nodiscard]] test::Station& station() { return station_; }
  [[nodiscard]] const test::Host& host() const { return host_; }
  [[nodiscard]] std::vector<LcmBus*> buses();

 private:
  void say();
  void on_answer(const Answer& answer);

  const test::Host& host_;
  std::string author_;
  Answered answered_;
  test::Station station_;
  std::unique_ptr<Observer> observer_;
  std::optional<Request> waiting_;
  std::int64_t repeat_at_ = 0;
};

/// Everything merge's history holds, in the order of its revisions. Asks again until all of it has arrived.
/// @throws std::runtime_error when it does not within a minute.
[[nodiscard]] std::vector<Operation> read_history(Client& client, const std::vector<LcmBus*>& buses);

}  // namespace concord::soak
