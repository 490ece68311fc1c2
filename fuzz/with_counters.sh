#!/usr/bin/env bash
# Cargo's RUSTC_WRAPPER: compiles our own crates with libFuzzer's coverage counters, and the others as ever.
set -euo pipefail
FLAGS=()
if [[ " $* " =~ \ --crate-name\ (intrinsym|intrinsym_fuzz|read_[a-z]+|arrays|detector|c_calls)\  ]]; then
    FLAGS=(-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4
        -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table
        -Cllvm-args=-sanitizer-coverage-trace-compares --cfg fuzzing)
fi
exec "$@" "${FLAGS[@]}"
