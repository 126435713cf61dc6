#include "stack.hpp"

#include <fstream>
#include <sstream>
#include <stdexcept>

#include "station.hpp"

namespace concord::test {
namespace {

const std::filesystem::path kPrograms = CONCORD_PROGRAMS;

std::filesystem::path make_folder() {
  std::string name = (std::filesystem::temp_directory_path() / "concord-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make " + name);
  return name;
}

std::string last_lines(const std::filesystem::path& file, std::size_t bytes) {
  std::ifstream in(file);
  std::stringstream text;
  text << in.rdbuf();
  const std::string all = text.str();
  return all.size() <= bytes ? all : all.substr(all.size() - bytes);
}

}  // namespace

Stack::Stack(Network& network, const std::string& settings) : folder_(make_folder()) {
  std::ofstream(folder_ / "site.yaml") << "lcm_url: " << kUrl << "\nbeyond_host: true\nstate: state\n" << settings;
  for (const char* process : {"ingest", "merge", "align", "planner", "semantic"})
    hosts_[process] = &network.add(process);
}

Stack::~Stack() {
  running_.clear();
  std::filesystem::remove_all(folder_);
}

void Stack::start(const std::string& process) {
  const std::vector<std::string> command = {kPrograms / ("concord-" + process), "--site", folder_ / "site.yaml"};
  running_.emplace(process, Process(host(process), command, folder_ / (process + ".log")));
}

void Stack::start_all() {
  for (const auto& [process, host] : hosts_) start(process);
}

void Stack::kill(const std::string& process) { running_.erase(process); }

void Stack::interrupt_all() {
  std::string failed;
  for (auto& [name, process] : running_) {
    const int code = process.interrupt();
    if (code != 0) failed += name + " ended with " + std::to_string(code) + "\n";
  }
  running_.clear();
  if (!failed.empty()) throw std::runtime_error(failed);
}

std::string Stack::concord(const Host& from, const std::string& arguments) const {
  return from.run((kPrograms / "concord").string() + " --site " + (folder_ / "site.yaml").string() + " " + arguments);
}

Process Stack::start_concord(const Host& from, std::vector<std::string> arguments) const {
  arguments.insert(arguments.begin(), {kPrograms / "concord", "--site", folder_ / "site.yaml"});
  return {from, arguments, folder_ / "concord.log"};
}

std::string Stack::logs() const {
  std::string all;
  for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
    if (entry.path().extension() != ".log") continue;
    all += "--- " + entry.path().filename().string() + "\n" + last_lines(entry.path(), 4000);
  }
  return all;
}

}  // namespace concord::test
