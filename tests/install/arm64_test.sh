#!/usr/bin/env bash
# Compiles keepout for arm64, and checks on an emulated processor that its steps are bitwise those of x86-64.
# arm64_test.sh SOURCE BUILD
# SPDX-License-Identifier: BSD-3-Clause
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"
source=$1 build=$2
for needed in aarch64-linux-gnu-g++ qemu-aarch64-static /usr/lib/aarch64-linux-gnu/libhwy.so; do
  command -v "$needed" || [ -e "$needed" ] || { echo "skipped: $needed is missing, see docs/embedding.md"; exit 77; }
done
cmake -S "$source" --preset arm64 -B "$build"
cmake --build "$build" --target same_steps_test
output=$(qemu-aarch64-static "$build/tests/same_steps_test")
printf '%s\n' "$output"
grep -q "OK.*SameSteps.OfTips" <<< "$output" || fail "the steps of tips were not compared"
