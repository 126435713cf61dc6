#include "bus/process.hpp"
#include "semantic/semantic_node.hpp"

int main(int argc, char** argv) {
  return concord::run_process("semantic", argc, argv, [](const concord::NodeContext& context) {
    return std::make_shared<concord::SemanticNode>(context, std::launch::async);
  });
}
