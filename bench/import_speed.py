#!/usr/bin/env python3
"""How fast mapbuilder import reads recordings, in MB of the file a second of processor time, and in what memory.

Usage: import_speed.py MAPBUILDER FOLDER      (FOLDER takes 2 GB for a while)
"""

import os
import pathlib
import random
import shutil
import sqlite3
import struct
import subprocess
import sys
import time

WIDTH, HEIGHT, IMAGES = 1224, 1024, 200
MAGIC = b"\x89MCAP0\r\n"
TYPE = "sensor_msgs/msg/Image"


def cdr_image(stamp_ns, encoding, step, data):
    """sensor_msgs/msg/Image as ROS 2 serializes it on a little-endian machine."""
    body = struct.pack("<iI", *divmod(stamp_ns, 10**9)) + struct.pack("<I", 4) + b"cam\0"
    body += struct.pack("<II", HEIGHT, WIDTH) + struct.pack("<I", len(encoding) + 1) + encoding.encode() + b"\0"
    body += b"\0"  # is_bigendian
    body += b"\0" * (-len(body) % 4) + struct.pack("<II", step, len(data))
    return b"\0\1\0\0" + body + data


def text(value):
    return struct.pack("<I", len(value)) + value.encode()


def record(op, content):
    return struct.pack("<BQ", op, len(content)) + content


def packed(records, compression):
    if not compression:
        return records
    command = {"lz4": ["lz4", "-c"], "zstd": ["zstd", "-c", "-1"]}[compression]
    return subprocess.run(command, input=records, check=True, capture_output=True).stdout


def write_mcap(path, messages, compression):
    with open(path, "wb") as file:
        file.write(MAGIC + record(1, text("ros2") + text("bench")))
        head = record(3, struct.pack("<H", 1) + text(TYPE) + text("ros2msg") + text(""))
        head += record(4, struct.pack("<HH", 1, 1) + text("/cam0/image_raw") + text("cdr") + text(""))
        for message in messages:
            records = head + record(5, struct.pack("<HIQQ", 1, 0, 0, 0) + message)
            head = b""
            body = packed(records, compression)
            file.write(record(6, struct.pack("<QQQI", 0, 0, len(records), 0) + text(compression) +
                              struct.pack("<Q", len(body)) + body))
        file.write(record(0x0F, bytes(4)) + record(2, bytes(20)) + MAGIC)


def write_sqlite(path, messages):
    with sqlite3.connect(path) as database:
        database.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT)")
        database.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)")
        database.execute("INSERT INTO topics VALUES (1, '/cam0/image_raw', ?, 'cdr')", (TYPE,))
        database.executemany("INSERT INTO messages(topic_id, timestamp, data) VALUES (1, 0, ?)", ((m,) for m in messages))
    database.close()


def messages(encoding, bytes_per_pixel):
    """Smooth images with noise in the lower bits, as cameras give them."""
    rng = random.Random(1)
    rows = [bytes((x * bytes_per_pixel // 8 + y // 4) % 200 + rng.randrange(8) for x in range(WIDTH * bytes_per_pixel))
            for y in range(64)]
    data = b"".join(rows[y % 64] for y in range(HEIGHT))
    for i in range(IMAGES):
        yield cdr_image(1_700_000_000_000_000_000 + i * 50_000_000, encoding, WIDTH * bytes_per_pixel, data)


def measure(mapbuilder, name, bag):
    capture = bag.with_name("capture")
    began = time.monotonic()
    process = subprocess.Popen([mapbuilder, "import", bag, "-o", capture], stdout=subprocess.DEVNULL,
                               stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    wall = time.monotonic() - began
    assert status == 0, name
    assert len(list((capture / "cam0").iterdir())) == IMAGES
    megabytes = bag.stat().st_size / 1e6
    processor = usage.ru_utime + usage.ru_stime
    print(f"| {name} | {megabytes:.0f} | {processor:.2f} | {megabytes / processor:.0f} | {IMAGES / processor:.0f} | {wall:.1f} | "
          f"{usage.ru_maxrss / 1e3:.0f} |", flush=True)
    shutil.rmtree(capture)
    bag.unlink()


def main():
    mapbuilder, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    print("| recording | MB | processor s | MB/s | images/s | s | memory MB |\n|---|---|---|---|---|---|---|")
    for encoding, size in (("mono8", 1), ("bgr8", 3), ("bayer_rggb8", 1)):
        write_sqlite(folder / "bag.db3", messages(encoding, size))
        measure(mapbuilder, f"sqlite3, {encoding}", folder / "bag.db3")
    for compression in ("", "lz4", "zstd"):
        write_mcap(folder / "bag.mcap", messages("mono8", 1), compression)
        measure(mapbuilder, f"MCAP, {compression or 'stored'}, mono8", folder / "bag.mcap")


if __name__ == "__main__":
    main()
