#!/usr/bin/env bash
# Three requests to 'keepout serve' from a shell. Usage: serve_client.sh KEEPOUT MESH
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
coproc GUARD { exec "$1" serve "$2"; }

ask() {  # sends a line, prints the answer
  printf '%s\n' "$1" >&"${GUARD[1]}"
  IFS= read -r answer <&"${GUARD[0]}"
  printf '%s\n' "$answer"
}

ask '{"id":1,"do":"ping"}'
ask '{"id":2,"do":"step","tip":[0,0,60],"desired":[0,0,-0.5]}'
ask '{"id":3,"do":"step","tip":[0,0,60]}'
