#include "client.hpp"

#include <cassert>
#include <map>
#include <stdexcept>

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

Client::Client(const test::Host& host, std::string author, Answered answered)
    : host_(host),
      author_(std::move(author)),
      answered_(std::move(answered)),
      station_(host),
      observer_(std::make_unique<Observer>(host)) {
  host.inside([this] {
    listen<Answer>(station_.bus(), station_.counters(), "soak", kAnswers,
                   [this](const std::string&, const Answer& answer) { on_answer(answer); });
  });
  station_.bus().every(kCheck, [this] {
    if (waiting_ && station_.bus().now() >= repeat_at_) say();
  });
}

void Client::ask(const Request& request) {
  assert(idle());
  waiting_ = request;
  say();
}

std::vector<LcmBus*> Client::buses() {
  std::vector<LcmBus*> all = observer_->buses();
  all.push_back(&station_.bus());
  return all;
}

void Client::say() {
  publish(station_.bus(), *waiting_);
  repeat_at_ = station_.bus().now() + kRepeat;
}

void Client::on_answer(const Answer& answer) {
  if (!waiting_ || answer.id != id_of(*waiting_) || answer.code == name(Code::kBusy)) return;
  const Request request = *std::exchange(waiting_, std::nullopt);
  answered_(request, answer);
}

std::vector<Operation> read_history(Client& client, const std::vector<LcmBus*>& buses) {
  LcmBus& bus = client.station().bus();
  const auto page = std::make_shared<Page>();
  client.host().inside([&] {
    listen<HistoryPart>(
        bus, client.station().counters(), "soak", "out/history",
        [page = page.get()](const std::string&, const HistoryPart& part) {
          if (part.id != page->id) return;
          page->parts[part.part] = part.operations;
          page->count = part.parts;
        },
        page);
  });
  std::vector<Operation> out;
  for (int number = 0;; ++number) {
    constexpr int kMost = 500;
    HistoryRequest request;
    request.id = "history-" + std::to_string(bus.now()) + "-" + std::to_string(number);
    request.after_revision = out.empty() ? 0 : out.back().revision;
    request.most = kMost;
    *page = {request.id, {}, -1};
    std::int64_t ask_at = 0;
    const bool arrived = test::eventually(buses, [&] {
      if (bus.now() >= ask_at) {
        bus.publish("in/history_request", encode(request, bus.now()));
        ask_at = bus.now() + kRepeat;
      }
      return page->whole();
    });
    if (!arrived) throw std::runtime_error("the history did not arrive within a minute");
    std::size_t found = 0;
    for (const auto& [number_of_part, operations] : page->parts) {
      found += operations.size();
      out.insert(out.end(), operations.begin(), operations.end());
    }
    if (found < kMost) return out;
  }
}

}  // namespace concord::soak
