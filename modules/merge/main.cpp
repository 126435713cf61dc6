#include "bus/process.hpp"
#include "merge/merge_node.hpp"

int main(int argc, char** argv) {
  return concord::run_process("merge", argc, argv, [](const concord::NodeContext& context) {
    return std::make_shared<concord::MergeNode>(context);
  });
}
