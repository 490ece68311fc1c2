#!/usr/bin/env bash
# Builds the C library and the command line and puts them into a wheel that runs on every Linux since 2018 (glibc 2.28, such as RHEL 8, which
# is also what Blender asks for): out/wheels/intrinsym-VERSION-py3-none-manylinux_2_28_MACHINE.whl
# usage: make_wheel.sh PYTHON   (a Python with what python/requirements-test.txt names)
#
# The code is what cargo compiles for this machine. Only the last step differs: zig's linker brings the symbols of an
# old glibc, OpenMesh is linked in, and auditwheel refuses the wheel if it needs anything newer than its tag says.
# What goes into a wheel, for whatever system, is python/setup.py's to say.
set -euo pipefail
cd "$(dirname "$0")/.."

PYTHON=$1
GLIBC=2.28
MACHINE=$(uname -m)
BUILD=build/wheel
STAGE=python/src/intrinsym/lib
PROGRAMS=python/bin
ZIG=("$PYTHON" -m ziglang cc -target "$MACHINE-linux-gnu.$GLIBC")
export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-target}
export PATH="$(dirname "$PYTHON"):$PATH"

# The part of OpenMesh that the library uses, as an archive: Debian has only a shared library, users have none.
build_openmesh() {
    [ -f "$BUILD/openmesh.a" ] && return
    local source objects=()
    for source in Mesh/{ArrayKernel,BaseKernel,PolyConnectivity} System/omstream Utils/BaseProperty; do
        objects+=("$BUILD/$(basename "$source").o")
        c++ -std=c++17 -O2 -DNDEBUG -fPIC -w -I "$1/src" -c "$1/src/OpenMesh/Core/$source.cc" -o "${objects[-1]}"
    done
    ar rcs "$BUILD/openmesh.a" "${objects[@]}"
}

# A file of the compiler, such as libstdc++.so.
compilers() {
    realpath "$(c++ -print-file-name="$1")"
}

link_library() {
    local archive=$CARGO_TARGET_DIR/release/libintrinsym.a
    echo '{ global: isym_*; local: *; };' >"$BUILD/exports.map"
    "${ZIG[@]}" -shared -o "$STAGE/libintrinsym.so" \
        -Wl,-soname,libintrinsym.so -Wl,--version-script="$BUILD/exports.map" -Wl,-z,defs -Wl,--gc-sections \
        -Wl,--strip-all -Wl,--whole-archive "$archive" -Wl,--no-whole-archive "$BUILD/old_libstdcxx.o" \
        "$BUILD/openmesh.a" "$(compilers libstdc++.so)" "$(compilers libgcc_s.so.1)" -lm -lpthread -ldl -lc
}

# What cargo calls in the place of the linker: OpenMesh is linked in, C++ is the system's. This machine's C++ asks for a newer
# glibc than ours does; the user's has its own.
write_linker() {
    cat >"$BUILD/linker" <<END
#!/usr/bin/env bash
arguments=()
for argument in "\$@"; do
    case \$argument in
    -lOpenMeshCore) arguments+=("$PWD/$BUILD/openmesh.a" "$PWD/$BUILD/old_libstdcxx.o") ;;
    -lstdc++) arguments+=("$(compilers libstdc++.so)") ;;
    -lgcc_s) arguments+=("$(compilers libgcc_s.so.1)") ;;
    *) arguments+=("\$argument") ;;
    esac
done
exec ${ZIG[*]} -Wl,--allow-shlib-undefined "\${arguments[@]}"
END
    chmod +x "$BUILD/linker"
}

link_program() {
    write_linker
    cargo rustc --release --locked -p intrinsym-cli --bin intrinsym -- -C "linker=$PWD/$BUILD/linker"
    mkdir -p "$PROGRAMS"
    strip -o "$PROGRAMS/intrinsym" "$CARGO_TARGET_DIR/release/intrinsym"
}

stage() {
    rm -rf "$STAGE" "$PROGRAMS"
    mkdir -p "$STAGE" "$BUILD"
    cp LICENSE LICENSE-APACHE LICENSE-MIT models/MODEL_CARD.md "$STAGE/"
    install -m 644 "$1/LICENSE" "$STAGE/LICENSE-OpenMesh"
    build_openmesh "$1"
    c++ -std=c++17 -O2 -fPIC -c python/old_libstdcxx.cpp -o "$BUILD/old_libstdcxx.o"
    link_library
    link_program
}

# auditwheel gives the wheel its tag, or says which symbols are too new for it.
pack() {
    rm -rf "$BUILD/dist" out/wheels/intrinsym-*.whl
    "$PYTHON" -m pip wheel --quiet --no-deps --no-build-isolation --wheel-dir "$BUILD/dist" ./python
    auditwheel repair --plat "manylinux_${GLIBC/./_}_$MACHINE" --only-plat --wheel-dir out/wheels \
        "$BUILD"/dist/*.whl
}

# A checkout is to load the library of the last build, not one that was left here.
unstage() {
    rm -rf "$STAGE" "$PROGRAMS" python/build python/src/intrinsym.egg-info
}

[ "$(uname -s)" = Linux ] || { echo "make_wheel: wheels are made on Linux only" >&2; exit 1; }
trap unstage EXIT
cargo build --release --locked --lib
stage "$(scripts/get_openmesh.sh)"
pack
ls -l out/wheels/intrinsym-*.whl
