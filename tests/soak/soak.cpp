#include "soak.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <stdexcept>

#include "building.hpp"
#include "client.hpp"
#include "oracle.hpp"
#include "script.hpp"

namespace concord::soak {
namespace {

struct Said {
  Request request;
  std::optional<Answer> answer;
};

/// Compares what people were told with what the history says, and applies the history to the oracle.
void judge(const std::map<std::string, Said>& said, const std::vector<Operation>& history, Oracle& oracle,
           Outcome& outcome) {
  std::map<std::string, const Operation*> kept;
  const auto complain = [&](std::int64_t& count, const std::string& words) {
    ++count;
    outcome.complaints.push_back(words);
  };
  for (const Operation& operation : history) {
    kept[operation.id] = &operation;
    const auto it = said.find(operation.id);
    if (it == said.end()) {
      complain(outcome.half_applied, operation.id + " was never asked");
      continue;
    }
    const auto& [request, answer] = it->second;
    if (answer && !answer->ok) complain(outcome.half_applied, operation.id + " was refused: " + answer->code);
    const Operation expected = oracle.apply(request);
    const bool same = expected.author == operation.author && expected.kind == operation.kind &&
                      expected.subject == operation.subject && expected.count == operation.count &&
                      expected.min == operation.min && expected.max == operation.max;
    if (!same || (answer && answer->ok && answer->revision != operation.revision)) {
      complain(outcome.half_applied, operation.id + " stands in the history otherwise than it was asked");
    }
  }
  for (const auto& [id, what] : said) {
    if (!what.answer || !what.answer->ok || !is_kept(what.request)) continue;
    if (!kept.contains(id)) complain(outcome.lost, id + " was acknowledged and is not in the history");
  }
}

/// Everybody and everything of one soak.
class Session {
 public:
  Session(const Plan& plan, test::Network& network)
      : plan_(plan),
        stack_(network, "resolution: " + std::to_string(kResolution) + "\n"),
        script_(plan.seed),
        assassin_(stack_, plan.kills, plan.operations, plan.seed) {
    test::Host& field = network.add("robots");
    std::vector<const test::Host*> hosts = {&stack_.host("ingest"), &stack_.host("merge"), &stack_.host("planner"),
                                            &field};
    for (int i = 1; i <= plan.authors; ++i) {
      hosts.push_back(&network.add("person" + std::to_string(i)));
      clients_.push_back(
          std::make_unique<Client>(*hosts.back(), "person " + std::to_string(i),
                                   [this](const Request& request, const Answer& answer) { note(request, answer); }));
    }
    for (const test::Host* host : hosts) {
      if (plan.loss_per_mille > 0) host->lose_arriving(plan.loss_per_mille);
    }
    stack_.start_all();
    robots_ = std::make_unique<Robots>(field, submaps(plan.seed));
  }

  /// Places the robots and waits until what they saw is the map: a move looks at it. Before its agents are known merge
  /// refuses to place them; that is asked until it is granted.
  void open() {
    Oracle oracle(kResolution, submaps(plan_.seed));
    for (const Request& request : script_.opening()) {
      const bool placed = test::eventually(buses(), [&] {
        const auto it = said_.find(id_of(request));
        const bool granted = it != said_.end() && it->second.answer->ok;
        if (!granted && clients_.front()->idle()) clients_.front()->ask(request);
        return granted;
      });
      if (!placed) throw std::runtime_error("a robot could not be placed\n" + stack_.logs());
      oracle.apply(request);
    }
    if (!becomes_equal(oracle)) throw std::runtime_error(outcome_.complaints.back() + "\n" + stack_.logs());
    wait_until_on_disk();
    outcome_.acknowledged = 0;
    outcome_.refused = 0;
    outcome_.refusals.clear();
  }

  void work() {
    const auto idle = [](const auto& client) { return client->idle(); };
    while (asked_ < plan_.operations || !std::ranges::all_of(clients_, idle) || !assassin_.done()) {
      ask_more();
      assassin_.act(now());
      for (LcmBus* bus : buses()) bus->spin_once(0);
      robots_->bus().spin_once(1);
    }
    outcome_.kills = assassin_.kills();
  }

  void compare() {
    Oracle oracle(kResolution, submaps(plan_.seed));
    judge(said_, read_history(*clients_.front(), buses()), oracle, outcome_);
    outcome_.equal_oracle = becomes_equal(oracle);
    for (const char* process : {"merge", "ingest", "planner"}) stack_.kill(process);
    stack_.start_all();
    for (const auto& client : clients_) client->look_anew();
    outcome_.equal_oracle = becomes_equal(oracle) && outcome_.equal_oracle;
    if (!outcome_.good()) outcome_.complaints.push_back(stack_.logs());
  }

  [[nodiscard]] Outcome& outcome() { return outcome_; }

 private:
  [[nodiscard]] std::int64_t now() const { return clients_.front()->station().bus().now(); }

  /// Ingest may lose what it received in the last seconds, for robots to send again; here the submaps stand still.
  void wait_until_on_disk() {
    const std::int64_t from = now();
    const auto done = std::make_shared<bool>(false);
    Client& client = *clients_.front();
    client.host().inside([&] {
      listen<ProcessStatus>(
          client.station().bus(), client.station().counters(), "soak", "out/status/ingest",
          [done = done.get(), from](const std::string&, const ProcessStatus& status) {
            const auto count = status.counters.find("agents_to_write");
            if (status.utime > from && count != status.counters.end() && count->second == 0) *done = true;
          },
          done);
    });
    if (!test::eventually(buses(), [&] { return *done; })) throw std::runtime_error("ingest did not write the submaps");
  }

  void note(const Request& request, const Answer& answer) {
    said_[id_of(request)] = {request, answer};
    if (!answer.ok) {
      ++outcome_.refused;
      ++outcome_.refusals[answer.code];
      return;
    }
    ++outcome_.acknowledged;
    script_.granted(request, answer.revision);
  }

  void ask_more() {
    for (const auto& client : clients_) {
      if (!client->idle() || asked_ == plan_.operations) continue;
      const Request request = script_.next(client->author());
      said_[id_of(request)] = {request, std::nullopt};
      client->ask(request);
      assassin_.on_request(++asked_, now());
    }
  }

  [[nodiscard]] std::vector<LcmBus*> buses() {
    std::vector<LcmBus*> all = {&robots_->bus()};
    for (const auto& client : clients_) {
      for (LcmBus* bus : client->buses()) all.push_back(bus);
    }
    return all;
  }

  /// Everybody ends with the same: the oracle's map, conflicts and zones, and one revision.
  [[nodiscard]] bool becomes_equal(const Oracle& oracle) {
    const MergedMap expected = oracle.map();
    const auto agrees = [&](const auto& client) {
      return client->sees().holds(expected, oracle.zones()) &&
             client->sees().revision() == clients_.front()->sees().revision();
    };
    if (test::eventually(buses(), [&] { return std::ranges::all_of(clients_, agrees); })) return true;
    for (const auto& client : clients_) {
      if (!agrees(client))
        outcome_.complaints.push_back(client->author() + ": " + client->sees().difference(expected, oracle.zones()));
    }
    return false;
  }

  Plan plan_;
  Outcome outcome_;
  test::Stack stack_;
  Script script_;
  Assassin assassin_;
  std::unique_ptr<Robots> robots_;
  std::vector<std::unique_ptr<Client>> clients_;
  std::map<std::string, Said> said_;  ///< by request id
  int asked_ = 0;
};

}  // namespace

Outcome run(const Plan& plan, test::Network& network) {
  const auto start = std::chrono::steady_clock::now();
  Session session(plan, network);
  session.open();
  session.work();
  session.compare();
  session.outcome().seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return session.outcome();
}

}  // namespace concord::soak
