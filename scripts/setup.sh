#!/usr/bin/env bash
# Makes sure that everything the build needs is there; installs it on Debian and Ubuntu, and says plainly
# what is missing on any other system. Does nothing, quickly, where all is installed.
# usage: setup.sh [nextest|mutants|python|blender|meshlab|release]
set -euo pipefail
cd "$(dirname "$0")/.."

NEXTEST_VERSION=0.9.143
MUTANTS_VERSION=27.1.0
PACKAGES=(ca-certificates g++ libopenmesh-dev make pkg-config)

fail() {
    printf 'setup: %s\n' "$@" >&2
    exit 1
}

as_root() {
    if [ "$(id -u)" = 0 ]; then
        "$@"
    elif command -v sudo >/dev/null; then
        sudo "$@"
    else
        fail "root is needed for: $*" "run that as root, then try again"
    fi
}

is_installed() {
    [ "$(dpkg-query -W -f '${db:Status-Status}' "$1" 2>/dev/null)" = installed ]
}

install_packages() {
    local missing=() package
    for package in "$@"; do
        is_installed "$package" || missing+=("$package")
    done
    [ ${#missing[@]} = 0 ] && return
    echo "setup: installing ${missing[*]}"
    as_root env DEBIAN_FRONTEND=noninteractive apt-get update -qq
    as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}"
}

# On a system without apt: name each thing that is missing, do not guess how it is installed.
check_tools() {
    local missing=()
    command -v c++ >/dev/null || missing+=("a C++17 compiler (c++)")
    if [ -z "${OPENMESH_DIR:-}" ]; then
        command -v pkg-config >/dev/null || missing+=("pkg-config")
        pkg-config --atleast-version=8.0 openmesh 2>/dev/null ||
            missing+=("OpenMesh 8 or later, known to pkg-config (or OPENMESH_DIR set to its folder)")
    fi
    [ ${#missing[@]} = 0 ] || fail "this is no Debian or Ubuntu; please install:" "${missing[@]/#/  - }"
}

rust_wanted() {
    sed -n 's/^rust-version = "\(.*\)"/\1/p' Cargo.toml
}

rust_is_new_enough() {
    local found
    found=$(rustc --version 2>/dev/null | cut -d ' ' -f 2) || return 1
    [ "$(printf '%s\n' "$(rust_wanted)" "$found" | sort -V | head -n 1)" = "$(rust_wanted)" ]
}

check_rust() {
    if command -v cargo >/dev/null && rust_is_new_enough; then return; fi
    if ! command -v rustup >/dev/null && apt-cache show rustup >/dev/null 2>&1; then
        install_packages rustup
    fi
    if command -v rustup >/dev/null; then
        echo "setup: installing the stable Rust toolchain"
        rustup toolchain install stable --profile minimal --component clippy --component rustfmt
        rustup default stable
        if rust_is_new_enough; then return; fi
    fi
    fail "Rust $(rust_wanted) or later is needed, found: $(rustc --version 2>/dev/null || echo none)" \
        "install it with rustup (see rustup.rs), open a new shell, and try again"
}

check_lints() {
    cargo fmt --version >/dev/null 2>&1 && cargo clippy --version >/dev/null 2>&1 && return
    command -v rustup >/dev/null || fail "rustfmt and clippy of Rust $(rust_wanted) or later are needed"
    rustup component add clippy rustfmt
}

check_nextest() {
    cargo nextest --version >/dev/null 2>&1 && return
    echo "setup: installing cargo-nextest $NEXTEST_VERSION"
    cargo install cargo-nextest --locked --version "$NEXTEST_VERSION"
}

check_mutants() {
    cargo mutants --version >/dev/null 2>&1 && return
    echo "setup: installing cargo-mutants $MUTANTS_VERSION"
    # Unoptimised: most of its time goes into what it starts.
    CARGO_PROFILE_DEV_DEBUG=0 cargo install cargo-mutants --locked --debug --version "$MUTANTS_VERSION"
}

check_python() {
    python3 -c 'import ensurepip, venv' 2>/dev/null && return
    command -v apt-get >/dev/null || fail "Python 3.9 or later with its module venv is needed"
    install_packages python3 python3-venv
}

# Blender 4.5 as a Python module, for the tests of the extension: Python 3.11, and the libraries that it links.
BLENDER_PACKAGES=(libgl1 libice6 libsm6 libx11-6 libxext6 libxfixes3 libxi6 libxkbcommon0 libxrender1)

check_blender() {
    if command -v apt-get >/dev/null; then install_packages "${BLENDER_PACKAGES[@]}"; fi
    "${BLENDER_PYTHON:-python3.11}" -c 'import ensurepip, venv' 2>/dev/null && return
    fail "Python 3.11 with its module venv is needed for the tests of the Blender extension" \
        "(Blender 4.5 runs in no other); BLENDER_PYTHON may name it"
}

# What MeshLab's headers include.
MESHLAB_PACKAGES=(libeigen3-dev libglew-dev libqt5opengl5-dev qtbase5-dev)

check_meshlab() {
    check_python
    if command -v apt-get >/dev/null; then
        install_packages cmake xz-utils "${MESHLAB_PACKAGES[@]}"
    else
        echo "setup: the MeshLab plugin needs CMake, Qt 5.15, Eigen 3 and GLEW, with their headers"
    fi
}

# Compilers, and what runs their files here: Windows' by Wine, Arm's by qemu.
RELEASE_PACKAGES=(binutils cmake g++-mingw-w64-x86-64-posix git libc6-arm64-cross lintian man-db qemu-user-static wine64)
RELEASE_TARGETS=(x86_64-unknown-linux-gnu aarch64-unknown-linux-gnu x86_64-pc-windows-gnu aarch64-apple-darwin
    x86_64-apple-darwin)

# What cannot be had is named by `make release`, which goes on with the other targets.
check_release() {
    check_python
    local package target
    for package in "${RELEASE_PACKAGES[@]}"; do
        command -v apt-get >/dev/null || break
        install_packages "$package" || echo "setup: $package cannot be had"
    done
    for target in "${RELEASE_TARGETS[@]}"; do
        [ -d "$(rustc --print sysroot)/lib/rustlib/$target/lib" ] && continue
        rustup target add "$target" || echo "setup: Rust's library for $target cannot be had"
    done
}

if [ "${1:-}" = nextest ]; then PACKAGES+=(cmake); fi
if command -v apt-get >/dev/null; then install_packages "${PACKAGES[@]}"; else check_tools; fi
check_rust
if [ "${1:-}" = nextest ]; then
    check_lints
    check_nextest
fi
if [ "${1:-}" = mutants ]; then
    check_nextest
    check_mutants
fi
if [ "${1:-}" = python ]; then check_python; fi
if [ "${1:-}" = blender ]; then
    check_python
    check_blender
fi
if [ "${1:-}" = meshlab ]; then check_meshlab; fi
if [ "${1:-}" = release ]; then check_release; fi
