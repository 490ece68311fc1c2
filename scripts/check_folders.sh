#!/usr/bin/env bash
# Compiles the folders of src/ each without those after it: an import against the order is an error.
set -euo pipefail
cd "$(dirname "$0")/.."

# The order is that of src/lib.rs; `base`, the first, is never left out.
mapfile -t left_out < <(sed -n 's/^#\[cfg(not(without = "\([a-z]*\)"))\]$/\1/p' src/lib.rs | awk '!seen[$0]++')
declared=$(grep -cE '^(pub )?mod [a-z]+;$' src/lib.rs)
if [ $((${#left_out[@]} + 1)) -ne "$declared" ]; then
  echo "src/lib.rs has $declared folders, of which ${#left_out[@]} can be left out: all but the first must be" >&2
  exit 1
fi

while [ ${#left_out[@]} -gt 0 ]; do
  flags=()
  for folder in "${left_out[@]}"; do flags+=(--cfg "without=\"$folder\""); done
  # What only a later folder uses is no mistake here.
  if ! cargo clippy --quiet --release --locked -p intrinsym --lib -- "${flags[@]}" --cap-lints allow; then
    echo "a folder of src/ imports from ${left_out[0]} or after it, which comes later: see the order in src/lib.rs" >&2
    exit 1
  fi
  left_out=("${left_out[@]:1}")
done
echo "each folder of src/ compiles without those after it"
