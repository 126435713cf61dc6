#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>

#include "bus/bus.hpp"
#include "bus/messages.hpp"
#include "bus/process.hpp"

namespace concord::hmd {

/// Asks the stack for clients, any number of things at once, and hands each answer to who waits for it. Datagrams get
/// lost and processes are busy: what has no answer is said again with the same id, which the stack does once.
class Asker {
 public:
  static constexpr std::int64_t kAgain = 300'000;  ///< microseconds
  static constexpr std::int64_t kPatience = 10'000'000;
  static constexpr std::int64_t kLoadPatience = 120'000'000;

  using Done = std::function<void(const Answer&)>;
  struct Question {
    std::string channel;
    Bytes message;
    std::string id;  ///< the request's
    /// What must have come beside the answer: parts, a path. Empty: nothing.
    std::function<bool()> whole;
    /// Processes that must all answer; empty: whoever answers first.
    std::set<std::string> processes;
    std::int64_t patience = kPatience;
    std::int64_t again = kAgain;
  };

  explicit Asker(const NodeContext& context);
  Asker(const Asker&) = delete;
  Asker& operator=(const Asker&) = delete;

  /// Calls `done` once, later: with the answer (the refusal, if any process refuses), or one of code BUSY or TIMEOUT.
  void ask(Question question, Done done);
  /// Something has come for this request: looks whether it is whole now.
  void arrived(const std::string& id);

  /// An id for the request `number` of a client, the same each time, nobody else's.
  [[nodiscard]] std::string id_of(std::int64_t session, std::int64_t number) const;
  [[nodiscard]] bool is_ours(const std::string& id) const { return id.starts_with(prefix_); }
  [[nodiscard]] bool waits(const std::string& id) const { return waiting_.contains(id); }

 private:
  struct Waiting {
    Question question;
    Done done;
    std::int64_t until, due;
    std::map<std::string, Answer> answers;  ///< by process
  };

  void on_answer(const Answer& answer);
  void tick();
  /// The last word, if it has been said.
  [[nodiscard]] static const Answer* verdict(const Waiting& waiting);
  void finish(const std::string& id, const Answer& answer);

  Bus& bus_;
  std::string process_, prefix_;
  std::map<std::string, Waiting> waiting_;
};

}  // namespace concord::hmd
