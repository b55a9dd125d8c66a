#!/usr/bin/env bash
# Runs scripts/demo on two short simulated flights and a folder that is no dataset:
#   demo_test.sh SOURCE_FOLDER PROGRAM_FOLDER
# The flights must end in a table and a picture, the folder in a clear message and an exit code that says so.
set -euo pipefail
source_folder=$1
programs=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0

expect() {  # expect WHAT COMMAND ...
  local what=$1
  shift
  if "$@"; then echo "ok: $what"; else echo "FAILED: $what"; failures=$((failures + 1)); fi
}
has() { grep -qE "$2" "$1"; }

"$programs/pangaea" simulate --out "$work/hall" --sessions 2 --seconds 2 --seed 3 >/dev/null 2>&1
mkdir "$work/no_dataset"
export PANGAEA_BIN=$programs OUT=$work/out RATE=max

code=0
"$source_folder/scripts/demo" "$work/hall/session_1" "$work/hall/session_2" >"$work/good.log" 2>&1 || code=$?
expect "the demo succeeds" [ "$code" -eq 0 ]
for name in session_1 session_2; do
  expect "the table has all frames of $name" has "$work/good.log" "^$name +40 +40 +100.0 %"
  expect "$name left a trajectory" [ -s "$work/out/run/$name.tum" ]
  expect "$name left a report" [ -s "$work/out/run/$name.json" ]
done
expect "the atlas is summed up" has "$work/good.log" "^atlas of site demo: 2 maps"
expect "there is a picture" has "$work/out/run/atlas.svg" "ground truth"

code=0
"$source_folder/scripts/demo" "$work/hall/session_1" "$work/no_dataset" >"$work/bad.log" 2>&1 || code=$?
expect "a failing agent fails the demo" [ "$code" -eq 1 ]
expect "the agent is named" has "$work/bad.log" "the agent no_dataset failed"
expect "its log is shown" has "$work/bad.log" "not a dataset of a known layout"
expect "the other agent is summed up" has "$work/bad.log" "^session_1 +40"

code=0
"$source_folder/scripts/demo" "$work/nowhere" >"$work/none.log" 2>&1 || code=$?
expect "a missing folder is wrong usage" [ "$code" -eq 2 ]

[ "$failures" -eq 0 ] || { cat "$work"/*.log; exit 1; }
