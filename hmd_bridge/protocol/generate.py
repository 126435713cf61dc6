#!/usr/bin/env python3
"""Makes the types, readers and writers of hmd.v1.toml: C++ (messages.hpp, messages.cpp) and TypeScript (messages.ts).

generate.py --cpp FOLDER     both C++ files
generate.py --ts FILE        the TypeScript file
generate.py --golden FILE    examples of every message, good and bad, which the tests of both sides read
Standard library only.
"""

import argparse
import pathlib

from cpp import cpp_header, cpp_source
from examples import golden
from schema import HERE, Schema
from typescript import ts_source


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cpp", type=pathlib.Path)
    parser.add_argument("--ts", type=pathlib.Path)
    parser.add_argument("--golden", type=pathlib.Path)
    arguments = parser.parse_args()
    schema = Schema(HERE / "hmd.v1.toml")
    if arguments.cpp:
        arguments.cpp.mkdir(parents=True, exist_ok=True)
        (arguments.cpp / "messages.hpp").write_text(cpp_header(schema))
        (arguments.cpp / "messages.cpp").write_text(cpp_source(schema))
    if arguments.ts:
        arguments.ts.parent.mkdir(parents=True, exist_ok=True)
        arguments.ts.write_text(ts_source(schema))
    if arguments.golden:
        arguments.golden.write_text(golden(schema))


if __name__ == "__main__":
    main()
