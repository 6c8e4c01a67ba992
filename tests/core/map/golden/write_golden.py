#!/usr/bin/env python3
"""Writes the golden map files from docs/map_format.md alone, with nothing of Waymark's: what they hold, any version reads.

Usage: write_golden.py FOLDER | --check FOLDER
"""

import math
import pathlib
import struct
import sys

# The first 8 bytes of each record.
HEADER = 0xF136E4A15B89C0FD
CAPTURE = 0x766B1129054A0D7E
SUBMAP = 0xCA6106D3376166C1
WORLD = 0xAE5C84C8583A5C58
MARKER = 0x227C946B1ACB05E4
CONSIDERED_MARKER = 0xA8AABF31AB4DA3F7
PARAMETERS = 0xE9816007B1F441B2
PARAMETER = 0xC47BA689475582ED
PARAMETER_COVARIANCE = 0xE72090920B1C210F


def crc32c(data):
    crc = 0xFFFFFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0x82F63B78 if crc & 1 else 0)
    return crc ^ 0xFFFFFFFF


assert crc32c(b"123456789") == 0xE3069283


def container(version, payload):
    head = b"WAYMARK\n" + struct.pack("<IQ", version, len(payload))
    return head + struct.pack("<I", crc32c(head + payload)) + payload


def header(captures, submaps, builder, rig):
    return struct.pack(">Qii32s16s", HEADER, captures, submaps, builder.encode(), rig.encode())


def capture(fingerprint):
    return struct.pack(">Q16s", CAPTURE, fingerprint.encode())


def submap(frame, markers, frame_sets, rms_px, rms_all_px):
    return struct.pack(">Qiiidd", SUBMAP, frame, markers, frame_sets, rms_px, rms_all_px)


def world(z_is_up):
    return struct.pack(">Q?", WORLD, z_is_up)


def marker(family, number, stated_size_m, size_m, position, xyzw, covariance, observations, rejected, rms_px, verified):
    return struct.pack(">Qii", MARKER, family, number) + struct.pack(
        ">2d3d4d36diid?", stated_size_m, size_m, *position, *xyzw, *covariance, observations, rejected, rms_px,
        verified)


def considered_marker(family, number, stated_size_m, size_m, position, xyzw, metric, modes, covariance, observations,
                      rejected, rms_px, verified):
    return struct.pack(">Qii", CONSIDERED_MARKER, family, number) + struct.pack(
        ">2d3d4d21d96f21fiid?", stated_size_m, size_m, *position, *xyzw, *metric, *modes, *covariance, observations,
        rejected, rms_px, verified)


def parameters(names_serials_cross, covariance):
    return (struct.pack(">Qi", PARAMETERS, len(names_serials_cross)) +
            b"".join(struct.pack(">Q48s64s16d", PARAMETER, name.encode(), serial.encode(), *cross)
                     for name, serial, cross in names_serials_cross) +
            b"".join(struct.pack(">Qd", PARAMETER_COVARIANCE, one) for one in covariance))


def triangle(variances, more=None):
    return [variances[i] if i == j else (more or {}).get((i, j), 0.0) for i in range(6) for j in range(i + 1)]


def modes(values):
    return [values.get((row, mode), 0.0) for row in range(6) for mode in range(16)]


def diagonal(values):
    return [values[i] if i == j else 0.0 for i in range(6) for j in range(6)]


TURNED = (0.0, 0.0, math.sqrt(0.5), math.sqrt(0.5))
UPRIGHT = (0.5, 0.5, 0.5, 0.5)
SURE = diagonal([1e-6, 2e-6, 3e-6, 4e-7, 5e-7, 6e-7])
TAG36H11, ARUCO_4X4_50 = 20, 0


def version_1():
    # z is up in the facility frame alone; a covariance of zeros is one that nobody knew.
    return container(1, header(1, 2, "0.0.9", "0123456789abcdef") + capture("00000000000000aa") +
                     submap(2, 2, 42, 0.25, 0.5) +
                     marker(TAG36H11, 3, 0.12, 0.1205, (1.5, -0.25, 0.125), UPRIGHT, SURE, 13, 1, 0.25, True) +
                     marker(TAG36H11, 586, 0.12, 0.12, (4.0, 2.0, 1.0), TURNED, [0.0] * 36, 0, 0, 0.0, False) +
                     submap(0, 1, 5, 0.125, 0.125) +
                     marker(ARUCO_4X4_50, 7, 0.2, 0.2, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), SURE, 4, 0, 0.125, True))


def version_2():
    return container(2, header(2, 2, "0.1.0", "") + capture("00000000000000aa") + capture("00000000000000bb") +
                     submap(1, 2, 42, 0.25, 0.5) + world(True) +
                     marker(TAG36H11, 3, 0.12, 0.1205, (1.5, -0.25, 0.125), UPRIGHT, SURE, 13, 1, 0.25, True) +
                     marker(TAG36H11, 586, 0.12, 0.12, (4.0, 2.0, 1.0), TURNED, [math.nan] * 36, 0, 0, 0.0, False) +
                     submap(0, 1, 5, 0.125, 0.125) + world(False) +
                     marker(ARUCO_4X4_50, 7, 0.2, 0.2, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), [0.0] * 36, 4, 0, 0.125, True))


def version_3():
    metric = triangle([1e-5, 2e-5, 3e-6, 4e-6, 5e-6, 6e-6], {(1, 0): 2.5e-7})
    within = triangle([2.0 ** -20] * 6)
    unknown = [math.nan] * 21
    return container(3, header(1, 2, "0.2.0", "0123456789abcdef") + capture("00000000000000aa") +
                     submap(0, 2, 42, 0.25, 0.5) + world(True) +
                     parameters([("cam0 focal length", "00417", [0.5e-3] + [0.0] * 15), ("size 0.12 m", "", [0.0] * 16)],
                                [1e-6, 2.5e-7, 4e-6]) +
                     considered_marker(TAG36H11, 3, 0.12, 0.1205, (1.5, -0.25, 0.125), UPRIGHT, metric,
                                       modes({(0, 0): 2.0 ** -10, (5, 15): 2.0 ** -11}), within, 13, 1, 0.25, True) +
                     considered_marker(TAG36H11, 586, 0.12, 0.12, (4.0, 2.0, 1.0), TURNED, unknown, modes({}), unknown,
                                       0, 0, 0.0, False) +
                     submap(0, 1, 5, 0.125, 0.125) + world(False) + parameters([], []) +
                     considered_marker(ARUCO_4X4_50, 7, 0.2, 0.2, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), unknown,
                                       modes({}), triangle([2.0 ** -20] * 6), 4, 0, 0.125, True))


def main():
    check = sys.argv[1] == "--check"
    folder = pathlib.Path(sys.argv[2 if check else 1])
    for name, content in (("version_1.map", version_1()), ("version_2.map", version_2()), ("version_3.map", version_3())):
        if not check:
            (folder / name).write_bytes(content)
        elif (folder / name).read_bytes() != content:
            print(f"{name}: not what docs/map_format.md says")
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
