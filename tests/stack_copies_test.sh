#!/usr/bin/env bash
# Tests that no function for one SIMD target copies a table of constants to the stack. GCC 12 copies the whole table on
# each call if it is declared in a function and read at a variable index. In the machine code, this is `rep movs`, or
# constants stored at adjacent places of the stack, one per register. Spilled constants are not adjacent.
#   stack_copies_test.sh BUILD LIBRARY...
# The test is skipped unless BUILD is "Release", the optimization that users get.
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
build=$1
shift
readonly skipped=77
if [ "$build" != Release ]; then
  printf 'skipped: %s is not the machine code that users run\n' "$build"
  exit $skipped
fi
if ! grep -q 'x86-64' <<< "$(objdump --file-headers "$1")"; then
  printf 'skipped: the instructions that are looked for are those of x86-64\n'
  exit $skipped
fi

# Highway names the namespaces of its targets N_AVX2 and so on. N_SCALAR is ordinary code.
for library in "$@"; do
  objdump --disassemble --demangle --no-show-raw-insn "$library"
done | awk '
  function number(hex,  sign, value, i) {
    sign = sub(/^-/, "", hex) ? -1 : 1
    sub(/^0x/, "", hex)
    value = 0
    for (i = 1; i <= length(hex); ++i) {
      value = 16 * value + index("0123456789abcdef", substr(hex, i, 1)) - 1
    }
    return sign * value
  }
  BEGIN {
    width["%x"] = 16
    width["%y"] = 32
    width["%z"] = 64
  }
  /^[0-9a-f]+ <.*>:$/ {
    name = $0
    sub(/^[0-9a-f]+ </, "", name)
    is_wide = name ~ /::N_(SSE2|SSSE3|SSE4|AVX2|AVX3[A-Z0-9_]*)::/
    seen[name ~ /::N_AVX2::/ ? "AVX2" : "other"] += is_wide
    split("", constant)  # registers that contain a constant
    next
  }
  !is_wide { next }
  /\trep movs/ { tables[name] }
  $2 ~ /^v?mov(dq[au]|ap[sd]|up[sd])/ {
    comma = match($3, /,[^,]*$/)
    from = substr($3, 1, comma - 1)
    to = substr($3, comma + 1)
    if (to ~ /^%[xyz]mm/) {
      if (from ~ /\(%rip\)$/) constant[to]
      else delete constant[to]
    } else if (to ~ /\(%r[sb]p\)$/ && from in constant) {
      place = number(substr(to, 1, index(to, "(") - 1))
      filled[name, width[substr(from, 1, 2)], substr(to, index(to, "(")), place]
      delete constant[from]
    }
    next
  }
  match($3, /%[xyz]mm[0-9]+$/) { delete constant[substr($3, RSTART)] }
  END {
    enough = 5  # adjacent places; up to three adjacent spilled constants were seen
    for (first in filled) {
      split(first, at, SUBSEP)
      for (count = 1; (at[1], at[2], at[3], at[4] + count * at[2]) in filled;) ++count
      if (count >= enough) tables[at[1]]
    }
    for (name in tables) {
      print "copies a table to the stack, each time it is called: " name
      failed = 1
    }
    printf "%d functions for AVX2 and %d for other targets were read\n", seen["AVX2"], seen["other"]
    if (seen["AVX2"] < 10) {
      print "there must be more for AVX2: has Highway renamed its namespaces?"
      failed = 1
    }
    exit failed
  }'
