"""Writes walker.obj and walker.pc2: a blob that walks along x, and swells and shrinks as it goes.

A motion for a collider (docs/scene-format.md#colliders-that-deform) is a surface and the places of its vertices, frame
by frame. This one has 31 frames, ten for each second, and needs nothing but Python.

    python3 assets/surfaces/make_walker.py
"""

import math
import pathlib
import struct

AROUND, RINGS, FRAMES, RATE = 20, 12, 31, 10
RADII = (0.36, 0.2, 0.26)  # metres


def rest_shape():
    """Returns the vertices and triangles of an ellipsoid whose poles lie on the x axis."""
    points = [(-RADII[0], 0.0, 0.0)]
    for ring in range(1, RINGS):
        along = math.pi * ring / RINGS
        for i in range(AROUND):
            turn = 2 * math.pi * i / AROUND
            points.append((-RADII[0] * math.cos(along), RADII[1] * math.sin(along) * math.cos(turn),
                           RADII[2] * math.sin(along) * math.sin(turn)))
    points.append((RADII[0], 0.0, 0.0))
    last = len(points) - 1
    at = lambda ring, i: 1 + ring * AROUND + i % AROUND
    triangles = []
    for i in range(AROUND):
        triangles.append((0, at(0, i + 1), at(0, i)))
        triangles.append((last, at(RINGS - 2, i), at(RINGS - 2, i + 1)))
        for ring in range(RINGS - 2):
            triangles.append((at(ring, i), at(ring, i + 1), at(ring + 1, i)))
            triangles.append((at(ring, i + 1), at(ring + 1, i + 1), at(ring + 1, i)))
    return points, triangles


def walked(point, time):
    """Returns where a vertex is: a wave runs along the blob twice a second, and its front goes ahead of its back."""
    x, y, z = point
    phase = 4 * math.pi * time - 5 * x
    swell = 1 + 0.18 * math.sin(phase)
    step = 0.45 * time + 0.06 * math.sin(4 * math.pi * time - 2 * x)
    return x + step - 0.9, y * swell + 0.24, z * swell + 0.08 * math.sin(2 * math.pi * time - 3 * x)


def main():
    folder = pathlib.Path(__file__).parent
    points, triangles = rest_shape()
    lines = [f"v {x:.6g} {y:.6g} {z:.6g}" for x, y, z in points]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in triangles]
    (folder / "walker.obj").write_text("\n".join(lines) + "\n")
    with open(folder / "walker.pc2", "wb") as file:
        file.write(struct.pack("<12siiffi", b"POINTCACHE2\0", 1, len(points), 0.0, 1.0, FRAMES))
        for frame in range(FRAMES):
            for point in points:
                file.write(struct.pack("<3f", *walked(point, frame / RATE)))


main()
