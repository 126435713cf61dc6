#include "bridge/asker.hpp"

#include <algorithm>
#include <vector>

namespace concord::hmd {
namespace {

constexpr std::int64_t kTick = 50'000;

bool is_busy(const Answer& answer) { return !answer.ok && answer.code == name(concord::Code::kBusy); }

}  // namespace

Asker::Asker(const NodeContext& context)
    : bus_(context.bus), process_(context.process), prefix_("hmd-" + std::to_string(context.boot_id) + "-") {
  listen<Answer>(bus_, context.counters, process_, kAnswers,
                 [this](const std::string&, const Answer& answer) { on_answer(answer); });
  bus_.every(kTick, [this] { tick(); });
}

std::string Asker::id_of(std::int64_t session, std::int64_t number) const {
  return prefix_ + std::to_string(session) + "-" + std::to_string(number);
}

void Asker::ask(Question question, Done done) {
  const std::int64_t now = bus_.now();
  const std::string id = question.id;
  bus_.publish(question.channel, question.message);
  const std::int64_t again = question.again, patience = question.patience;
  waiting_.insert_or_assign(id, Waiting{std::move(question), std::move(done), now + patience, now + again, {}});
}

const Answer* Asker::verdict(const Waiting& waiting) {
  for (const auto& [process, answer] : waiting.answers) {
    if (!answer.ok && !is_busy(answer)) return &answer;
  }
  const Question& question = waiting.question;
  const auto said = [&](const std::string& process) {
    const auto it = waiting.answers.find(process);
    return it != waiting.answers.end() && it->second.ok;
  };
  if (!std::all_of(question.processes.begin(), question.processes.end(), said)) return nullptr;
  const auto good =
      std::find_if(waiting.answers.begin(), waiting.answers.end(), [](const auto& entry) { return entry.second.ok; });
  if (good == waiting.answers.end() || (question.whole && !question.whole())) return nullptr;
  return &good->second;
}

void Asker::on_answer(const Answer& answer) {
  const auto it = waiting_.find(answer.id);
  if (it == waiting_.end()) return;
  it->second.answers[answer.process] = answer;
  arrived(answer.id);
}

void Asker::arrived(const std::string& id) {
  const auto it = waiting_.find(id);
  if (it == waiting_.end()) return;
  if (const Answer* answer = verdict(it->second)) finish(id, *answer);
}

void Asker::finish(const std::string& id, const Answer& answer) {
  const Answer last = answer;
  const auto node = waiting_.extract(id);
  node.mapped().done(last);
}

void Asker::tick() {
  const std::int64_t now = bus_.now();
  std::vector<std::string> over;
  for (auto& [id, waiting] : waiting_) {
    if (now >= waiting.until) {
      over.push_back(id);
    } else if (now >= waiting.due) {
      bus_.publish(waiting.question.channel, waiting.question.message);
      waiting.due = now + waiting.question.again;
    }
  }
  for (const std::string& id : over) {
    Answer last{
        id, process_, false, "TIMEOUT", "the process that does this did not answer; is the whole stack running?", 0, 0};
    for (const auto& [process, answer] : waiting_.at(id).answers) {
      if (is_busy(answer)) last = answer;
    }
    finish(id, last);
  }
}

}  // namespace concord::hmd
