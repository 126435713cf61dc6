#include "cli/replay_expected.hpp"

#include <fstream>

namespace concord {
namespace {

std::map<std::string, nlohmann::json> digests_in(const nlohmann::json& object, bool only_map) {
  std::map<std::string, nlohmann::json> digests;
  for (const char* key : {"digest", "map_digest"}) {
    if (object.contains(key)) digests[key] = object[key];
  }
  if (!object.contains("results") || !object["results"].is_object()) return digests;
  for (const auto& [key, value] : object["results"].items()) {
    if (!only_map || key == "map") digests["results." + key] = value;
  }
  return digests;
}

}  // namespace

Result<Expected> Expected::read(const std::filesystem::path& file, bool live) {
  std::ifstream in(file);
  const auto object = in ? nlohmann::json::parse(in, nullptr, false) : nlohmann::json();
  if (!object.is_object()) return refuse(Code::kIo, file.string() + " holds no JSON object");
  Expected expected(live);
  expected.digests_ = digests_in(object, live);
  if (expected.digests_.empty()) {
    return refuse(Code::kEmpty, file.string() + " says nothing of what a replay leads to; write it with --json");
  }
  return expected;
}

std::vector<std::string> Expected::differences(const nlohmann::json& result) const {
  const auto found = digests_in(result, live_);
  std::vector<std::string> lines;
  for (const auto& [key, want] : digests_) {
    const auto have = found.find(key);
    const nlohmann::json value = have != found.end() ? have->second : nlohmann::json();
    if (value != want) lines.push_back(key + " is " + value.dump() + ", expected " + want.dump());
  }
  return lines;
}

}  // namespace concord
