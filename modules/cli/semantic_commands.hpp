#pragma once

#include "cli/command.hpp"

namespace concord {

/// label, labels.
void add_labels(Program& program);

}  // namespace concord
