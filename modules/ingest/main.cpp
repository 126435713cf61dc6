#include "ingest/ingest_node.hpp"

int main(int argc, char** argv) {
  return concord::run_process("ingest", argc, argv, [](const concord::NodeContext& context) {
    return std::make_shared<concord::IngestNode>(context);
  });
}
