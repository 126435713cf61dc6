#include "bus/site.hpp"
#include "must.hpp"

using namespace concord;

/// Any text is a site or a ConfigError; a site's effective values are a site file that says the same.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const Site site = parse_site(std::string(reinterpret_cast<const char*>(data), size), "/folder");
    const std::string effective = to_yaml(site);
    fuzz::must(to_yaml(parse_site(effective, "/elsewhere")) == effective);
  } catch (const ConfigError&) {
    return 0;
  }
  return 0;
}
