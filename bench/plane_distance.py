#!/usr/bin/env python3
"""How far the markers of a map that hang on one plane are from one.

Usage: plane_distance.py MAPBUILDER MAP [IDS_LEFT_OUT...]

Prints RMS and largest distance of the centres from the plane that fits them best (least squares).
"""

import math
import sys

from map_distances import read_map


def normal_of(points):
    """Direction of least scatter about the origin: power iteration on trace(S) I - S."""
    scatter = [[sum(p[i] * p[j] for p in points) for j in range(3)] for i in range(3)]
    trace = sum(scatter[i][i] for i in range(3))
    shifted = [[(trace if i == j else 0.0) - scatter[i][j] for j in range(3)] for i in range(3)]
    normal = [0.577, 0.577, 0.578]
    for _ in range(100000):
        turned = [sum(shifted[i][j] * normal[j] for j in range(3)) for i in range(3)]
        length = math.sqrt(sum(x * x for x in turned))
        turned = [x / length for x in turned]
        done = math.dist(turned, normal) < 1e-15
        normal = turned
        if done:
            break
    return normal


def main():
    markers = read_map(sys.argv[1], sys.argv[2])
    centres = [pose[0] for number, pose in sorted(markers.items()) if str(number) not in sys.argv[3:]]
    middle = [sum(c[i] for c in centres) / len(centres) for i in range(3)]
    points = [[c[i] - middle[i] for i in range(3)] for c in centres]
    normal = normal_of(points)
    off = [abs(sum(p[i] * normal[i] for i in range(3))) for p in points]
    rms = math.sqrt(sum(d * d for d in off) / len(off))
    print(f"{len(off)} markers from one plane: RMS {1e3 * rms:.2f} mm, largest {1e3 * max(off):.2f} mm")


if __name__ == "__main__":
    main()
