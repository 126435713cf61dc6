#include "network.hpp"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <fstream>
#include <stdexcept>
#include <thread>

#include <fcntl.h>
#include <sched.h>
#include <unistd.h>

namespace concord::test {
namespace {

constexpr const char* kOwnNamespace = "/proc/thread-self/ns/net";

std::string shell(const std::string& command) {
  FILE* pipe = popen(("{ " + command + "; } 2>&1").c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("cannot run " + command);
  std::string output;
  std::array<char, 4096> buffer;
  while (const std::size_t size = std::fread(buffer.data(), 1, buffer.size(), pipe)) output.append(buffer.data(), size);
  if (pclose(pipe) != 0) throw std::runtime_error(command + ": " + output);
  return output;
}

void write_file(const char* path, const std::string& text) {
  std::ofstream file(path);
  file << text << std::flush;
  if (!file) throw std::runtime_error(std::string("cannot write ") + path);
}

void become_root_of_user_namespace(uid_t user, gid_t group) {
  write_file("/proc/self/setgroups", "deny");
  write_file("/proc/self/uid_map", "0 " + std::to_string(user) + " 1");
  write_file("/proc/self/gid_map", "0 " + std::to_string(group) + " 1");
}

}  // namespace

std::string enter_private_network() {
  const uid_t user = geteuid();
  const gid_t group = getegid();
  try {
    if (unshare(CLONE_NEWNET) != 0) {
      if (unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0) return std::strerror(errno);
      become_root_of_user_namespace(user, group);
    }
    shell("ip link set lo up && ip route add 224.0.0.0/4 dev lo");
    return "";
  } catch (const std::exception& error) {
    return error.what();
  }
}

Host::Host(std::string name) : name_(std::move(name)) {
  // A namespace belongs to a thread: this one makes it and leaves it to us as an open file.
  std::thread([this] {
    if (unshare(CLONE_NEWNET) == 0) namespace_ = open(kOwnNamespace, O_RDONLY | O_CLOEXEC);
  }).join();
  if (namespace_ < 0) throw std::runtime_error("cannot make a network namespace for " + name_);
  run("ip link set lo up");
}

Host::~Host() { close(namespace_); }

void Host::inside(const std::function<void()>& body) const {
  const int outside = open(kOwnNamespace, O_RDONLY | O_CLOEXEC);
  if (outside < 0 || setns(namespace_, CLONE_NEWNET) != 0) throw std::runtime_error("cannot enter " + name_);
  std::exception_ptr thrown;
  try {
    body();
  } catch (...) {
    thrown = std::current_exception();
  }
  const bool back = setns(outside, CLONE_NEWNET) == 0;
  close(outside);
  if (thrown) std::rethrow_exception(thrown);
  if (!back) throw std::runtime_error("cannot leave " + name_);
}

std::string Host::run(const std::string& command) const {
  std::string output;
  inside([&] { output = shell(command); });
  return output;
}

std::string Host::path() const { return "/proc/" + std::to_string(getpid()) + "/fd/" + std::to_string(namespace_); }

void Host::lose_arriving(int per_mille) const {
  run("nft add table netdev loss");
  run("nft 'add chain netdev loss in { type filter hook ingress device eth0 priority -500; }'");
  run("nft 'add rule netdev loss in ip protocol udp numgen random mod 1000 < " + std::to_string(per_mille) +
      " counter drop'");
}

long Host::lost() const {
  const std::string rules = run("nft list table netdev loss");
  const std::string key = "counter packets ";
  const auto at = rules.find(key);
  if (at == std::string::npos) throw std::runtime_error("no counter on " + name_ + ": " + rules);
  return std::stol(rules.substr(at + key.size()));
}

Network::Network() {
  // Without a multicast router a snooping switch would wait for reports; a plain one floods.
  shell("ip link add switch type bridge mcast_snooping 0 forward_delay 0 && ip link set switch up");
}

Network::~Network() {
  // A namespace goes some time after its last user; its port would still be there for the next network.
  try {
    for (std::size_t number = 1; number <= hosts_.size(); ++number) shell("ip link del port" + std::to_string(number));
    shell("ip link del switch");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
  }
}

Host& Network::add(const std::string& name) {
  Host& host = *hosts_.emplace_back(std::make_unique<Host>(name));
  const std::string number = std::to_string(hosts_.size());
  shell("ip link add port" + number + " type veth peer name eth0 netns " + host.path());
  shell("ip link set port" + number + " master switch up");
  host.run("ip address add 10.0.0." + number + "/24 dev eth0 && ip link set eth0 up");
  host.run("ip route add 224.0.0.0/4 dev eth0");
  return host;
}

}  // namespace concord::test
