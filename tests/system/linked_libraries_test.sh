#!/usr/bin/env bash
# What only some runs need is in modules, and no program links it: linked_libraries_test.sh PROGRAMS
# (docs/decisions/0023-modules.md)
set -euo pipefail
programs=$1
for program in pangaea pangaea-agent pangaea-server; do
  libraries=$(ldd "$programs/$program")
  grep -q libstdc++ <<<"$libraries" || { echo "$program: its libraries cannot be listed"; exit 1; }
  if grep -E 'libopencv_(imgcodecs|videoio)|libgdal|libavcodec' <<<"$libraries"; then
    echo "$program links these, which belong into a module"
    exit 1
  fi
done
