#include "must.hpp"
#include "semantic/labels/label_loading.hpp"
#include "semantic/labels/label_section.hpp"

using namespace concord;

/// A section of labels that can be read is what its corrections are written as, can be applied, and follows on itself.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto all = read_label_section({data, size});
  if (!all) return 0;
  Bytes again;
  Labels labels(0.05);
  BrickSet touched;
  for (const LabelCorrection& one : *all) {
    append_label_correction(again, one);
    labels.apply(one, touched);
  }
  fuzz::must(again == Bytes(data, data + size));
  if (all->empty()) return 0;
  const auto following = labels_to_load(*all, labels);
  fuzz::must(following && following->empty());
  return 0;
}
