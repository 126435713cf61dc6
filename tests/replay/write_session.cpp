#include "session.hpp"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  concord::test::write_log(argv[1], concord::test::record_session());
}
