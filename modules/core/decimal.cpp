#include "core/decimal.hpp"

#include <charconv>

namespace concord {

std::string decimal(double value) {
  char digits[32];  // at most 24 are taken
  return {digits, std::to_chars(digits, digits + sizeof(digits), value).ptr};
}

}  // namespace concord
