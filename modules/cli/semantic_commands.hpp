#pragma once

#include "cli/command.hpp"

namespace concord {

void add_label(Program& program);
void add_labels(Program& program);
void add_assets(Program& program);

}  // namespace concord
