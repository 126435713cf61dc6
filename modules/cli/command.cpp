#include "cli/command.hpp"

#include <algorithm>
#include <cstdio>
#include <string_view>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace concord {
namespace {

int report(const Failure& failure, const Common& common) {
  if (common.json) {
    common.print({{"error", {{"code", failure.code}, {"message", failure.message}}}}, "");
  } else {
    std::fprintf(stderr, "concord: %s (%s)\n", failure.message.c_str(), failure.code.c_str());
  }
  return static_cast<int>(failure.exit);
}

}  // namespace

void Common::print(const nlohmann::json& object, const std::string& words) const {
  // What a file or a peer said may hold bytes that are no UTF-8.
  const std::string text = json ? object.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) : words;
  std::printf("%s%s", text.c_str(), text.empty() || text.back() == '\n' ? "" : "\n");
  std::fflush(stdout);
}

Program::Program() : app_("One client for a Concord stack and its map files", "concord") {
  app_.require_subcommand(1);
  app_.fallthrough();
  app_.add_flag("--json", common_.json, "one JSON object instead of words");
  app_.add_option("--site", common_.site_file, "the site's YAML file; defaults hold where it is silent")
      ->envname("CONCORD_SITE");
  app_.add_option("--timeout", common_.timeout, "seconds to wait for an answer")->check(CLI::Range(0.1, 3600.0));
}

CLI::App& Program::add(const std::string& name, const std::string& what, Run run) {
  CLI::App* command = app_.add_subcommand(name, what);
  command->callback([this, run = std::move(run)] { chosen_ = run; });
  return *command;
}

int Program::run(int argc, const char* const* argv) {
  try {
    app_.parse(argc, argv);
    (void)common_.site();  // commands that need nothing of it refuse a bad one too
    const Outcome outcome = chosen_(common_);
    return outcome ? static_cast<int>(*outcome) : report(outcome.error(), common_);
  } catch (const CLI::ParseError& e) {
    // What was parsed before the mistake is not in common_ yet.
    common_.json = std::find(argv, argv + argc, std::string_view("--json")) != argv + argc;
    if (e.get_exit_code() == 0) return app_.exit(e);  // help was asked for
    return report({Exit::kUnusable, "USAGE", e.what() + std::string("; see ") + app_.get_name() + " --help"}, common_);
  } catch (const ConfigError& e) {
    return report({Exit::kUnusable, "CONFIGURATION", e.what()}, common_);
  } catch (const std::exception& e) {  // what the system refuses: a temporary folder, memory
    return report({Exit::kUnusable, "FAILED", e.what()}, common_);
  }
}

}  // namespace concord
