#include "store/site_resolution.hpp"

#include <stdexcept>

namespace concord {

double kept_resolution(Database& database, double resolution) {
  Statement read = database.prepare("SELECT resolution FROM site");
  const Result<bool> row = read.step();
  if (!row) throw std::runtime_error(row.error().message);
  if (*row) return read.real(0);
  read.reset();
  const auto written = database.prepare("INSERT INTO site VALUES (?)").run(resolution);
  if (!written) throw std::runtime_error(written.error().message);
  return resolution;
}

}  // namespace concord
