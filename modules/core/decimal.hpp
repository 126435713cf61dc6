#pragma once

#include <string>

namespace concord {

/// The shortest text that reads back the same bits: 0.05 is "0.05", where std::to_string says "0.050000".
[[nodiscard]] std::string decimal(double value);

}  // namespace concord
