#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "access/gate.hpp"
#include "core/error.hpp"

namespace concord::hmd {

/// A text that nobody can guess: 256 random bits, 43 of A-Z a-z 0-9 - _. @throws std::runtime_error without randomness.
[[nodiscard]] std::string random_secret();

/// Tokens of a site: STATE/bridge/tokens.db, by their SHA-256 only. Each call opens the file anew and closes it: the
/// bridge reads while `concord token` writes.
class TokenStore {
 public:
  static constexpr std::size_t kMost = 1000;

  explicit TokenStore(std::filesystem::path file) : file_(std::move(file)) {}

  struct Entry {
    std::string name;
    Role role;
    std::int64_t created;  ///< microseconds since 1970
  };
  /// Makes a token and answers it: the only time that anybody sees it. Refused: a name that is taken (kExists) or none
  /// (kBadName), too many (kTooLarge), a file that is in use (kBusy) or cannot be used (kIo); so the others.
  [[nodiscard]] Result<std::string> add(const std::string& name, Role role, std::int64_t now);
  /// Refused: no such token (kNotFound).
  [[nodiscard]] Result<void> remove(const std::string& name);
  /// By name.
  [[nodiscard]] Result<std::vector<Entry>> list();
  /// Whose token it is; nobody's if it is none. Refused at once (kBusy) while somebody writes them.
  [[nodiscard]] Result<std::optional<Identity>> find(const std::string& token);
  /// Whether that is still so: the very token, not another of its name. Refused as `find`.
  [[nodiscard]] Result<bool> holds(const Identity& who);

 private:
  [[nodiscard]] Result<std::optional<Identity>> look_up(const std::string& hash);

  std::filesystem::path file_;
};

}  // namespace concord::hmd
