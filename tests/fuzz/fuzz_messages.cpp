#include "../unit/bus/message_samples.hpp"
#include "must.hpp"

using namespace concord;

/// The first byte chooses a message type, the rest follows its fingerprint. What can be read can be written and read.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1) return 0;
  const auto& samples = test::message_samples();
  const test::MessageSample& sample = samples[data[0] % samples.size()];
  Bytes bytes(sample.bytes.begin(), sample.bytes.begin() + 8);
  bytes.insert(bytes.end(), data + 1, data + size);
  const auto read = sample.reread(bytes);
  if (read) fuzz::must(sample.reread(*read).has_value());
  return 0;
}

/// Starts from good messages.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed);
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  const auto& samples = test::message_samples();
  if (seed % 50 == 0) {
    const std::size_t chosen = seed / 50 % samples.size();
    const Bytes& bytes = samples[chosen].bytes;
    if (bytes.size() - 7 <= most) {
      data[0] = static_cast<std::uint8_t>(chosen);
      std::copy(bytes.begin() + 8, bytes.end(), data + 1);
      size = bytes.size() - 7;
    }
  }
  return LLVMFuzzerMutate(data, size, most);
}
