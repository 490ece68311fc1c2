"""The mesh of the screenshots: the posed human, turned to y up, with a bump of 5 cm on a thigh.

usage: meshlab_screenshots.py IN.ply OUT.ply (binary, vertices of three floats)
"""

import math
import struct
import sys

TOP = (-0.104, -0.249, 0.094)
HEIGHT, WIDTH = 0.05, 0.06

data = bytearray(open(sys.argv[1], "rb").read())
header = data[: data.index(b"end_header\n")].decode()
count = int(next(line.split()[2] for line in header.splitlines() if line.startswith("element vertex")))
start = len(header) + len("end_header\n")
for vertex in range(count):
    x, y, z = struct.unpack_from("<3f", data, start + 12 * vertex)
    turned = (x, z, -y)
    bump = HEIGHT * math.exp(-math.dist(turned, TOP) ** 2 / WIDTH**2)
    struct.pack_into("<3f", data, start + 12 * vertex, turned[0], turned[1], turned[2] + bump)
open(sys.argv[2], "wb").write(data)
