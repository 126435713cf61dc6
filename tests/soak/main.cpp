#include <cstdio>
#include <exception>
#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "network.hpp"
#include "soak.hpp"

namespace {

void print(const concord::soak::Plan& plan, const concord::soak::Outcome& outcome, bool json) {
  for (const std::string& complaint : outcome.complaints) std::fprintf(stderr, "concord: %s\n", complaint.c_str());
  const nlohmann::json object = {{"seed", plan.seed},
                                 {"operations", plan.operations},
                                 {"kills", outcome.kills},
                                 {"acknowledged", outcome.acknowledged},
                                 {"refused", outcome.refused},
                                 {"refusals", outcome.refusals},
                                 {"lost", outcome.lost},
                                 {"half_applied", outcome.half_applied},
                                 {"equal_oracle", outcome.equal_oracle},
                                 {"seconds", outcome.seconds}};
  if (json) {
    std::puts(object.dump().c_str());
  } else {
    for (const auto& [key, value] : object.items()) std::printf("%-14s %s\n", key.c_str(), value.dump().c_str());
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("People edit all at once while processes are killed: nothing acknowledged is lost, nothing half done.");
  concord::soak::Plan plan;
  double loss_percent = 0;
  bool json = false;
  app.add_option("--kills", plan.kills, "kill -9 of a process, this often")->check(CLI::Range(0, 10'000));
  app.add_option("--operations", plan.operations, "requests of people")->check(CLI::Range(1, 100'000));
  app.add_option("--people", plan.authors, "who ask at once")->check(CLI::Range(1, 64));
  app.add_option("--loss", loss_percent, "of the packets that arrive anywhere, percent")->check(CLI::Range(0.0, 50.0));
  app.add_option("--seed", plan.seed, "of places, requests and moments");
  app.add_flag("--json", json, "one JSON object on standard output");
  CLI11_PARSE(app, argc, argv);
  plan.loss_per_mille = static_cast<int>(loss_percent * 10);
  try {
    if (const std::string refusal = concord::test::enter_private_network(); !refusal.empty()) {
      std::fprintf(stderr, "concord: a soak needs network namespaces, which are not permitted here: %s\n",
                   refusal.c_str());
      return 2;
    }
    concord::test::Network network;
    const concord::soak::Outcome outcome = concord::soak::run(plan, network);
    print(plan, outcome, json);
    return outcome.good() ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "concord: %s\n", error.what());
    return 1;
  }
}
