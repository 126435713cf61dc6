#pragma once

#include <string>
#include <vector>

namespace concord {

/// Rows as aligned columns, two spaces apart, a line each. `sides` has 'l' or 'r' for each column: the side it is
/// aligned to. @pre every row has sides.size() cells.
[[nodiscard]] std::string format_table(const std::vector<std::vector<std::string>>& rows, const std::string& sides);

}  // namespace concord
