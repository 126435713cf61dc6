#include "soak.hpp"

#include <chrono>
#include <memory>
#include <optional>
#include <stdexcept>

#include "building.hpp"
#include "crowd.hpp"
#include "oracle.hpp"
#include "players.hpp"
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
        people_(network.add("people")),
        field_(network.add("robots")),
        station_(people_),
        crowd_(make_crowd()),
        script_(plan.seed),
        assassin_(stack_, plan.kills, plan.operations, plan.seed) {
    for (const test::Host* host : {&stack_.host("ingest"), &stack_.host("merge"), &stack_.host("planner"),
                                   static_cast<const test::Host*>(&people_), static_cast<const test::Host*>(&field_)}) {
      if (plan.loss_per_mille > 0) host->lose_arriving(plan.loss_per_mille);
    }
    stack_.start_all();
    robots_ = std::make_unique<Robots>(field_, submaps(plan.seed));
    observer_ = std::make_unique<Observer>(people_);
  }

  /// Places the robots and waits until what they saw is the map: a move looks at it. Before its agents are known merge
  /// refuses to place them; that is asked until it is granted.
  void open() {
    Oracle oracle(kResolution, submaps(plan_.seed));
    for (const Request& request : script_.opening()) {
      const bool placed = test::eventually(buses(), [&] {
        const auto it = said_.find(id_of(request));
        const bool granted = it != said_.end() && it->second.answer->ok;
        if (!granted && crowd_->idle()) crowd_->ask(request);
        return granted;
      });
      if (!placed) throw std::runtime_error("a robot could not be placed\n" + stack_.logs());
      oracle.apply(request);
    }
    if (!becomes_equal(oracle)) throw std::runtime_error(outcome_.complaints.back() + "\n" + stack_.logs());
    wait_until_on_disk();
    outcome_.refused = 0;
    outcome_.refusals.clear();
  }

  void work() {
    while (asked_ < plan_.operations || !crowd_->idle() || !assassin_.done()) {
      ask_more();
      assassin_.act(station_.bus().now());
      for (LcmBus* bus : buses()) bus->spin_once(0);
      station_.bus().spin_once(1);
    }
    outcome_.kills = assassin_.kills();
  }

  void compare() {
    Oracle oracle(kResolution, submaps(plan_.seed));
    std::vector<Operation> history;
    people_.inside([&] { history = read_history(station_.bus(), station_.counters(), buses()); });
    judge(said_, history, oracle, outcome_);
    outcome_.equal_oracle = becomes_equal(oracle);
    for (const char* process : {"merge", "ingest", "planner"}) stack_.kill(process);
    stack_.start_all();
    observer_ = std::make_unique<Observer>(people_);
    outcome_.equal_oracle = becomes_equal(oracle) && outcome_.equal_oracle;
    if (!outcome_.good()) outcome_.complaints.push_back(stack_.logs());
  }

  [[nodiscard]] Outcome& outcome() { return outcome_; }

 private:
  /// Ingest may lose what it received in the last seconds, for robots to send again; here the submaps stand still.
  void wait_until_on_disk() {
    const auto from = station_.bus().now();
    const auto done = std::make_shared<bool>(false);
    people_.inside([&] {
      listen<ProcessStatus>(
          station_.bus(), station_.counters(), "soak", "out/status/ingest",
          [done, from](const std::string&, const ProcessStatus& status) {
            const auto count = status.counters.find("agents_to_write");
            if (status.utime > from && count != status.counters.end() && count->second == 0) *done = true;
          },
          done);
    });
    if (!test::eventually(buses(), [&] { return *done; })) throw std::runtime_error("ingest did not write the submaps");
  }

  std::unique_ptr<Crowd> make_crowd() {
    std::unique_ptr<Crowd> crowd;
    people_.inside([&] {
      crowd = std::make_unique<Crowd>(station_.bus(), station_.counters(),
                                      [this](const Request& request, const Answer& answer) { note(request, answer); });
    });
    return crowd;
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
    for (int i = 1; i <= plan_.authors && asked_ < plan_.operations; ++i) {
      const std::string author = "person " + std::to_string(i);
      if (crowd_->waits(author)) continue;
      const Request request = script_.next(author);
      said_[id_of(request)] = {request, std::nullopt};
      crowd_->ask(request);
      assassin_.on_request(++asked_, station_.bus().now());
    }
  }

  [[nodiscard]] std::vector<LcmBus*> buses() {
    std::vector<LcmBus*> all = observer_->buses();
    all.push_back(&robots_->bus());
    all.push_back(&station_.bus());
    return all;
  }

  [[nodiscard]] bool becomes_equal(const Oracle& oracle) {
    const MergedMap expected = oracle.map();
    const bool equal = test::eventually(buses(), [&] { return observer_->holds(expected, oracle.zones()); });
    if (!equal) outcome_.complaints.push_back(observer_->difference(expected, oracle.zones()));
    return equal;
  }

  Plan plan_;
  Outcome outcome_;
  test::Stack stack_;
  test::Host& people_;
  test::Host& field_;
  test::Station station_;
  std::unique_ptr<Crowd> crowd_;
  Script script_;
  Assassin assassin_;
  std::unique_ptr<Robots> robots_;
  std::unique_ptr<Observer> observer_;
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
