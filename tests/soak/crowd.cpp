#include "crowd.hpp"

#include <algorithm>
#include <cassert>
#include <stdexcept>

#include "station.hpp"

namespace concord::soak {
namespace {

constexpr std::int64_t kRepeat = 250'000;
constexpr std::int64_t kCheck = 20'000;

void publish(Bus& bus, const Request& request) {
  const std::int64_t now = bus.now();
  struct Say {
    Bus& bus;
    std::int64_t now;
    void operator()(const EditRequest& of) const { bus.publish("in/edit", encode(of)); }
    void operator()(const UndoRequest& of) const { bus.publish("in/undo", encode(of)); }
    void operator()(const ZoneRequest& of) const { bus.publish("in/zone", encode(of)); }
    void operator()(const WeightRequest& of) const { bus.publish("in/weight", encode(of)); }
    void operator()(const TransformRequest& of) const { bus.publish("in/transform", encode(of, now)); }
    void operator()(const LeaseRequest& of) const { bus.publish("in/lease", encode(of)); }
  };
  std::visit(Say{bus, now}, request);
}

/// Gathers the parts of one answer to a history request.
struct Page {
  std::string id;
  std::map<int, std::vector<Operation>> parts;
  int count = -1;
  bool whole() const { return count >= 0 && static_cast<int>(parts.size()) == count; }
};

}  // namespace

Crowd::Crowd(LcmBus& bus, Counters& counters, Answered answered) : bus_(bus), answered_(std::move(answered)) {
  listen<Answer>(bus_, counters, "soak", kAnswers, [this](const std::string&, const Answer& a) { on_answer(a); });
  bus_.every(kCheck, [this] {
    for (auto& [id, waiting] : waiting_) {
      if (bus_.now() >= waiting.repeat_at) say(waiting);
    }
  });
}

void Crowd::ask(const Request& request) {
  const auto [it, is_new] = waiting_.try_emplace(id_of(request), Waiting{request});
  assert(is_new);
  say(it->second);
}

bool Crowd::waits(const std::string& author) const {
  return std::ranges::any_of(waiting_, [&](const auto& entry) { return author_of(entry.second.request) == author; });
}

void Crowd::say(Waiting& waiting) {
  publish(bus_, waiting.request);
  waiting.repeat_at = bus_.now() + kRepeat;
}

void Crowd::on_answer(const Answer& answer) {
  const auto it = waiting_.find(answer.id);
  if (it == waiting_.end() || answer.code == name(Code::kBusy)) return;
  const Request request = it->second.request;
  waiting_.erase(it);
  answered_(request, answer);
}

std::vector<Operation> read_history(LcmBus& bus, Counters& counters, const std::vector<LcmBus*>& others) {
  Page page;
  listen<HistoryPart>(bus, counters, "soak", "out/history", [&page](const std::string&, const HistoryPart& part) {
    if (part.id != page.id) return;
    page.parts[part.part] = part.operations;
    page.count = part.parts;
  });
  std::vector<LcmBus*> buses = others;
  buses.push_back(&bus);
  std::vector<Operation> out;
  for (int number = 0;; ++number) {
    constexpr int kMost = 500;
    HistoryRequest request;
    request.id = "history-" + std::to_string(bus.now()) + "-" + std::to_string(number);
    request.after_revision = out.empty() ? 0 : out.back().revision;
    request.most = kMost;
    page = {request.id, {}, -1};
    std::int64_t ask_at = 0;
    const bool arrived = test::eventually(buses, [&] {
      if (bus.now() >= ask_at) {
        bus.publish("in/history_request", encode(request, bus.now()));
        ask_at = bus.now() + kRepeat;
      }
      return page.whole();
    });
    if (!arrived) throw std::runtime_error("the history did not arrive within a minute");
    std::size_t found = 0;
    for (const auto& [number_of_part, operations] : page.parts) {
      found += operations.size();
      out.insert(out.end(), operations.begin(), operations.end());
    }
    if (found < kMost) return out;
  }
}

}  // namespace concord::soak
