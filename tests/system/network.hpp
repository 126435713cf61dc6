#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace concord::test {

/// Leaves the machine's network for a private one: as root, or in a user namespace. Before any thread is made.
/// Returns what the kernel said where that is not permitted; empty: we are alone.
[[nodiscard]] std::string enter_private_network();

/// A computer of the test's network: a network namespace that lives as long as this object and what runs in it.
class Host {
 public:
  explicit Host(std::string name);
  ~Host();
  Host(const Host&) = delete;
  Host& operator=(const Host&) = delete;

  /// Runs `body` in the calling thread on this host: sockets, threads and processes it makes stay there.
  void inside(const std::function<void()>& body) const;
  /// Runs a shell command here and returns what it printed. @throws std::runtime_error when it fails.
  std::string run(const std::string& command) const;

  [[nodiscard]] const std::string& name() const { return name_; }
  /// A path by which other programs find this namespace while the object lives.
  [[nodiscard]] std::string path() const;

  /// From now on this share of the UDP packets that arrive is lost, before they are put together again.
  void lose_arriving(int per_mille) const;
  [[nodiscard]] long lost() const;

 private:
  std::string name_;
  int namespace_ = -1;
};

/// Hosts on one Ethernet switch, with multicast routed to it.
class Network {
 public:
  Network();
  ~Network();
  Host& add(const std::string& name);

 private:
  std::vector<std::unique_ptr<Host>> hosts_;
};

}  // namespace concord::test
