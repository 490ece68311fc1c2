#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the screenshots of docs/blender.md in a real Blender window: Debian trixie's Blender in a chroot, on a
# virtual screen with software OpenGL. Needs root, debootstrap, and 3 GB under build/.
# usage: make.sh [live [edit|sculpt|paint|film|times]...]   (after `make blender-extension`; live: Live Mirror's checks, its
#        times by size, and docs/blender/live.gif)
set -euo pipefail
cd "$(dirname "$0")/../.."

CHROOT=${INTRINSYM_CHROOT:-$PWD/build/blender-window}
MIRROR=${DEBIAN_MIRROR:-$(apt-get indextargets --format '$(ORIGIN) $(REPO_URI)' | awk '$1 == "Debian" {print $2; exit}')}
SCRIPT=${1:-window}
PACKAGES=(blender xvfb xauth imagemagick python3-numpy libgl1-mesa-dri libegl1 libegl-mesa0 libglx-mesa0)

# /proc and /dev are mounted in a mount namespace of its own: nothing stays mounted.
inside() {
    unshare -m --propagation private bash -c \
        'root=$1; shift; mount -t proc proc "$root/proc"; mount --rbind /dev "$root/dev"; exec chroot "$root" "$@"' \
        - "$CHROOT" "$@"
}

install_blender() {
    [ -x "$CHROOT/usr/bin/blender" ] && return
    command -v debootstrap >/dev/null || apt-get install -y -qq debootstrap
    debootstrap --variant=minbase trixie "$CHROOT" "$MIRROR"
    printf '#!/bin/sh\nexit 101\n' >"$CHROOT/usr/sbin/policy-rc.d"
    chmod +x "$CHROOT/usr/sbin/policy-rc.d"
    DEBIAN_FRONTEND=noninteractive inside apt-get install -y -qq --no-install-recommends "${PACKAGES[@]}"
}

install_blender
rm -rf "$CHROOT/session"
mkdir -p "$CHROOT/session/pictures"
cp out/blender/intrinsic_symmetry-*.zip examples/human.ply blender_addon/screenshots/*.py "$CHROOT/session/"
inside /usr/bin/env -i HOME=/session PATH=/usr/bin:/bin LANG=C.UTF-8 LIBGL_ALWAYS_SOFTWARE=1 \
    BLENDER_USER_RESOURCES=/session/user \
    timeout 600 xvfb-run -a -s "-screen 0 1280x960x24 +extension GLX" \
    blender --factory-startup --no-window-focus --window-geometry 0 0 1280 960 --enable-event-simulate \
    --python-exit-code 1 --python /session/$SCRIPT.py -- "${@:2}"
[ ! -e "$CHROOT/session/pictures/failed.txt" ] || { cat "$CHROOT/session/pictures/failed.txt" >&2; exit 1; }
mkdir -p docs/blender
if [ "$SCRIPT" = live ]; then
    if [ -e "$CHROOT/session/pictures/frame_00.png" ]; then
        inside convert -delay 8 -loop 0 '/session/pictures/frame_*.png' -crop 600x690+260+90 +repage -resize 480x \
            +dither -colors 48 -layers Optimize /session/live.gif
        cp "$CHROOT/session/live.gif" docs/blender/live.gif
    fi
    [ ! -e "$CHROOT/session/pictures/times.txt" ] || cat "$CHROOT/session/pictures/times.txt"
    exit
fi
for picture in "$CHROOT"/session/pictures/*.png; do
    inside convert "/session/pictures/$(basename "$picture")" -crop 1056x936+0+24 +repage +dither -colors 128 \
        -define png:compression-level=9 "/session/small.png"
    cp "$CHROOT/session/small.png" "docs/blender/$(basename "$picture")"
done
ls -l docs/blender
