#!/bin/sh
# try_readme.sh SOURCE BUILD TRIAL: see CMakeLists.txt.
set -eu
source=$1 build=$2 trial=$3
readme=$source/modules/agent/README.md

rm -rf "$trial"
mkdir -p "$trial/robot"
cmake --install "$build" --prefix "$trial/prefix" --component agent >"$trial/install.log"

block() { awk -v open="\`\`\`$1" '$0 == "```" { inside = 0 } inside { print } $0 == open { inside = 1 }' "$readme"; }
block cpp >"$trial/robot/robot.cpp"
{
  echo 'cmake_minimum_required(VERSION 3.25)'
  echo 'project(robot CXX)'
  echo 'add_executable(robot robot.cpp)'
  block cmake
} >"$trial/robot/CMakeLists.txt"

cmake -S "$trial/robot" -B "$trial/robot/build" -DCMAKE_PREFIX_PATH="$trial/prefix"
cmake --build "$trial/robot/build"
"$trial/robot/build/robot" memq:// >"$trial/sent"  # not into a pipe: its exit code counts
grep -qE '^[1-9][0-9]{3,} bytes sent$' "$trial/sent"
