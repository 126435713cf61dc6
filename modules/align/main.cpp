#include "align/align_node.hpp"

int main(int argc, char** argv) {
  return concord::run_process("align", argc, argv, [](const concord::NodeContext& context) -> std::shared_ptr<void> {
    return std::make_shared<concord::AlignNode>(context, std::launch::async);
  });
}
