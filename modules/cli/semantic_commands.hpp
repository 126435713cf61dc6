#pragma once

#include "cli/command.hpp"

namespace concord {

void add_voxelize(Program& program);
void add_segment(Program& program);
void add_label(Program& program);
void add_labels(Program& program);
void add_assets(Program& program);
void add_things(Program& program);
void add_detect(Program& program);

}  // namespace concord
