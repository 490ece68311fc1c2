#!/usr/bin/env bash
# Builds the C library and puts it into a wheel, out/wheels/intrinsym-VERSION-py3-none-PLATFORM.whl, together with
# the OpenMesh library that it needs: users have no package of it.
# usage: make_wheel.sh PYTHON   (a Python with what python/requirements-test.txt names)
# INTRINSYM_LIBRARY names a library that is built already.
set -euo pipefail
cd "$(dirname "$0")/.."

PYTHON=$1
STAGE=python/src/intrinsym/lib
export PATH="$(dirname "$PYTHON"):$PATH"

build_library() {
    [ -n "${INTRINSYM_LIBRARY:-}" ] && return
    cargo build --release --locked --lib
    INTRINSYM_LIBRARY=${CARGO_TARGET_DIR:-target}/release/libintrinsym.so
}

# The file that the loader takes for the OpenMesh library; nothing where OpenMesh was linked statically.
openmesh_file() {
    ldd "$INTRINSYM_LIBRARY" | awk '$1 ~ /^libOpenMeshCore/ { print $3 }'
}

# Debug information is three quarters of the library. Each library finds its neighbours in its own folder.
stage() {
    rm -rf "$STAGE"
    mkdir -p "$STAGE"
    local file
    for file in "$INTRINSYM_LIBRARY" $(openmesh_file); do
        strip --strip-unneeded -o "$STAGE/$(basename "$file")" "$file"
        patchelf --set-rpath '$ORIGIN' "$STAGE/$(basename "$file")"
    done
    cp LICENSE LICENSE-APACHE LICENSE-MIT "$STAGE/"
    cp models/MODEL_CARD.md "$STAGE/"
    cp /usr/share/doc/libopenmesh-dev/copyright "$STAGE/LICENSE-OpenMesh" 2>/dev/null ||
        [ -z "$(openmesh_file)" ] || { echo "make_wheel: the licence of OpenMesh is missing" >&2; exit 1; }
}

# The newest glibc symbol decides on which systems the wheel runs.
platform_tag() {
    local newest
    newest=$(objdump -T "$STAGE"/*.so* | grep -o 'GLIBC_2\.[0-9]*' | sort -Vu | tail -n 1)
    echo "manylinux_${newest#GLIBC_}_$(uname -m)" | tr . _
}

# A checkout is to load the library of the last build, not one that was left here.
unstage() {
    rm -rf "$STAGE" python/build python/src/intrinsym.egg-info
}

trap unstage EXIT
build_library
stage
rm -f out/wheels/intrinsym-*.whl
INTRINSYM_WHEEL_PLATFORM=$(platform_tag) "$PYTHON" -m pip wheel --quiet --no-deps --no-build-isolation \
    --wheel-dir out/wheels ./python
ls -l out/wheels/intrinsym-*.whl
