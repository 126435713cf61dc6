#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bus/log_reader.hpp"

namespace concord::test {

/// What a logger would have heard on `in/` of a short session: two robots in frames of their own that stream their
/// submaps, a scanner that sends clouds, a person who aligns them, pins voxels and asks for a path.
[[nodiscard]] std::vector<LogEvent> record_session();

/// Written by LCM's own code, as lcm-logger does.
void write_log(const std::filesystem::path& file, const std::vector<LogEvent>& events);

}  // namespace concord::test
