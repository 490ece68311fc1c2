#!/usr/bin/env bash
# Remakes docs/meshlab/*.png: the plugin in the real window of MeshLab, from a newer Debian in a folder, on a
# virtual screen. Needs root, `make meshlab-plugin` before, and about 1.5 GB.
# DEBIAN_MIRROR names the archive; without it the machine's own is taken. DEBIAN_SUITE: one with MeshLab 2025.07.
set -euo pipefail
cd "$(dirname "$0")/.."

SUITE=${DEBIAN_SUITE:-sid}
DEBIAN_MIRROR=${DEBIAN_MIRROR:-$(apt-get indextargets --format '$(ORIGIN) $(REPO_URI)' |
    awk '$1 == "Debian" && $2 !~ /security/ { print $2; exit }')}
ROOT=build/meshlab/chroot
OUT=docs/meshlab
PLUGIN=$(ls "$PWD"/out/meshlab/*/meshlab/libfilter_intrinsic_symmetry.so)
export DISPLAY=:87

# What MeshLab's own plugins link is recommended, not demanded, by its package.
PACKAGES=meshlab,libgl1-mesa-dri,fonts-dejavu-core,libgomp1,libmuparser2v5,libqhull-r8.0,lib3ds-1-3,libopenctm1

install_meshlab() {
    [ -x "$ROOT/usr/bin/meshlab" ] && return
    mmdebstrap --mode=root --variant=minbase --components=main --include="$PACKAGES" \
        --aptopt='Apt::Install-Recommends false' --aptopt="$(apt-config dump Acquire::Check-Valid-Until)" \
        --keyring=/usr/share/keyrings/debian-archive-keyring.gpg \
        "$SUITE" "$ROOT" "deb $DEBIAN_MIRROR $SUITE main"
}

cleanup() {
    [ -n "${MESHLAB:-}" ] && kill "$MESHLAB" 2>/dev/null
    [ -n "${SCREEN:-}" ] && kill "$SCREEN" 2>/dev/null
    sleep 1
    for folder in tmp/.X11-unix dev proc; do umount "$ROOT/$folder" 2>/dev/null || true; done
}

start() {
    local extra=$ROOT/root/.local/share/VCG/MeshLab_64bit_fp/MeshLabExtraPlugins/2025.07
    mkdir -p "$extra" "$OUT" "$ROOT/tmp/.X11-unix"
    cp "$PLUGIN" "$extra/"
    python3 scripts/meshlab_screenshots.py examples/human.ply "$ROOT/root/human.ply"
    Xvfb "$DISPLAY" -screen 0 1280x900x24 +extension GLX >build/meshlab/xvfb.log 2>&1 &
    SCREEN=$!
    sleep 2
    mount -t proc proc "$ROOT/proc"
    mount --bind /dev "$ROOT/dev"
    mount --bind /tmp/.X11-unix "$ROOT/tmp/.X11-unix"
    env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root DISPLAY="$DISPLAY" LANG=C.UTF-8 \
        LIBGL_ALWAYS_SOFTWARE=1 QT_X11_NO_MITSHM=1 chroot "$ROOT" /usr/bin/meshlab /root/human.ply \
        >build/meshlab/window.log 2>&1 &
    MESHLAB=$!
    local window=
    for _ in $(seq 60); do
        window=$(xdotool search --onlyvisible --name 'MeshLab 2025' 2>/dev/null | head -n 1) && break
        sleep 1
    done
    [ -n "$window" ] || { cat build/meshlab/window.log; exit 1; }
    sleep 6
    xdotool windowsize "$window" 1280 900
    sleep 2
}

shot() {
    sleep 2
    import -window root -strip "$OUT/$1.png"
}

click() {
    xdotool mousemove "$1" "$2"
    sleep 1
    xdotool click 1
    sleep 1
}

# Opens the dialog of the filter that the search box finds first.
open_filter() {
    click 1260 43
    xdotool type --delay 60 "$1"
    sleep 2
    [ -z "${2:-}" ] || shot "$2"
    xdotool key Down
    sleep 1
    xdotool key Return
    sleep 3
}

# Where Apply is in a dialog, and Close left of it; these places are of this screen size and these texts.
apply_and_close() {
    click "$1" "$2"
    sleep 6
    click "$3" "$2"
}

pictures() {
    click 403 43        # no wireframe
    xdotool key shift+h # no trackball
    open_filter symm search
    shot dialog
    apply_and_close 787 735 549
    shot computed
    open_filter "conditional face"
    xdotool mousemove 690 516 click --repeat 3 --delay 100 1
    xdotool type --delay 40 "x0 < -0.3"
    apply_and_close 777 728 502
    shot selected_before
    open_filter "symmetric faces"
    apply_and_close 757 713 551
    shot selected_after
    open_filter "flag asym"
    apply_and_close 813 718 570
    shot asymmetry
    convert "$OUT/selected_before.png" "$OUT/selected_after.png" -crop 838x790+0+70 +repage +append \
        -resize 1200x "$OUT/selected.png"
    rm "$OUT/selected_before.png" "$OUT/selected_after.png"
    mogrify -strip +dither -colors 256 "$OUT"/*.png
    grep "Applied filter" build/meshlab/window.log
    [ "$(grep -c "Applied filter" build/meshlab/window.log)" = 4 ]
}

trap cleanup EXIT
install_meshlab
start
pictures
