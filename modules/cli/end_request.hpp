#pragma once

namespace concord {

/// Set by SIGINT and SIGTERM once `end_on_signals` was called; before that they end the program at once.
void end_on_signals();
[[nodiscard]] bool end_requested();

}  // namespace concord
