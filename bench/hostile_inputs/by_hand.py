"""Inputs thought out: each with what is right, "refused" or "taken"; None where either is."""

import os
import pathlib
import struct
import zlib

import mutated
import stand as good

MEBI = 1 << 20


def fill(path, *pieces):
    """Writes pieces, each (bytes, how often), without holding the whole."""
    path = pathlib.Path(path)
    if os.path.lexists(path):
        path.unlink()
    with open(path, "wb") as file:
        for piece, times in pieces:
            block = max(1, min(times, MEBI // max(1, len(piece))))
            whole, rest = divmod(times, block)
            for _ in range(whole):
                file.write(piece * block)
            file.write(piece * rest)
    return path


def sparse(path, size, head=b""):
    fill(path, (head, 1))
    os.truncate(path, size)
    return path


def yaml(stand):
    bomb = [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9) if i else 'x'}]\n".encode() for i in range(200)]
    camera = good.RIG.split("\n", 1)[1].encode()
    big = lambda side: good.RIG.replace("[64, 48]", f"[{side}, {side}]").encode()
    inputs = [
        ("laughs 9^12", [(b"".join(bomb[:13]) + good.RIG.encode(), 1)], None),
        ("laughs 9^200", [(b"".join(bomb) + good.RIG.encode(), 1)], None),
        ("cam0 of laughs", [(b"".join(bomb[:13]) + b"cam0: *a12\n", 1)], "refused"),
        ("alias of itself", [(b"cam0: &a [*a]\n", 1)], "refused"),
        ("map of itself", [(b"cam0: &a {camera_model: *a}\n", 1)], "refused"),
        ("[ 1e6", [(b"cam0: ", 1), (b"[", 10**6)], "refused"),
        ("{ 1e6", [(b"cam0: ", 1), (b"{a: ", 10**6)], "refused"),
        ("- 1e6", [(b"- ", 10**6)], "refused"),
        ("? 1e5", [(b"? ", 10**5)], "refused"),
        ("5,000 cameras", [(f"cam{i}:\n".encode() + camera, 1) for i in range(5000)], "refused"),
        ("key of 140,000 bytes", [(good.RIG.encode(), 1), (b"  ? ", 1), (b"k", 140_000), (b"\n  : 1\n", 1)], "taken"),
        ("10,000 keys", [(good.RIG.encode(), 1)] + [(f"  k{i}: 1\n".encode(), 1) for i in range(10_000)], "taken"),
        ("60,000 keys", [(good.RIG.encode(), 1)] + [(f"  k{i}: 1\n".encode(), 1) for i in range(60_000)], "refused"),
        ("190 kB of 0,", [(good.RIG.encode() + b"  x: [", 1), (b"0,", 95_000), (b"0]\n", 1)], "taken"),
        ("1 MB of 0,", [(good.RIG.encode() + b"  x: [", 1), (b"0,", MEBI // 2), (b"0]\n", 1)], "refused"),
        ("2 MB", [(b"# ", MEBI), (b"\n" + good.RIG.encode(), 1)], "refused"),
        ("100000 px", [(big(100000), 1)], "refused"),
        ("15000 px", [(big(15000), 1)], "refused"),
        ("65535 px", [(big(65535), 1)], "refused"),
    ]
    for name, pieces, expected in inputs:
        path = fill(stand.folder / "hostile.yaml", *pieces)
        yield name, expected, path, stand.check_with("camchain", path)


def toml(stand):
    inputs = []
    for depth in (17, 200, 10**4, 60_000, 10**6):
        inputs += [(f"a.a {depth}", [(b"a.", depth), (b"a = 1\n", 1)]),
                   (f"[a.a {depth}", [(b"[a", 1), (b".a", depth), (b"]\n", 1)]),
                   (f"x = [[ {depth}", [(b"x = ", 1), (b"[", depth), (b"]", depth), (b"\n", 1)]),
                   (f"x = {{a= {depth}", [(b"x = ", 1), (b"{a = ", depth), (b"1", 1), (b"}", depth), (b"\n", 1)])]
    inputs += [("keys of 15 parts", [(f"k{i}.a.a.a.a.a.a.a.a.a.a.a.a.a.a=0\n".encode(), 1) for i in range(28_000)]),
               ("lists of 0", [(b"x = [", 1), (b"0,", MEBI // 2 - 10), (b"]\n", 1)]),
               ("80,000 keys", [(f"k{i} = 1\n".encode(), 1) for i in range(80_000)]),
               ("one key of 130 kB", [(b"k", 131_500), (b" = 1\n", 1)]),
               ("string of 1 MB", [(b'k = "', 1), (b"s", MEBI - 10), (b'"\n', 1)]),
               ("2 MB of comments", [(b"#\n", MEBI)]),
               ("NUL", [(b"\0", 100)]),
               ("sparse", None)]
    for name, pieces in inputs:
        for file in ("locd.toml", "markers.toml"):
            path = stand.folder / "hostile.toml"
            if pieces is None:
                sparse(path, 8 * 10**6)
            else:
                fill(path, *pieces)
            if file == "locd.toml":
                yield f"{file}: {name}", "refused", path, stand.check(path)
            else:
                capture = stand.make_capture("hostile_capture")
                path.replace(capture / file)
                yield f"{file}: {name}", "refused", capture / file, stand.replay(capture)


def json(stand):
    marker = b'{"id": 7, "family": "tag36h11", "size_m": 0.2, "position_m": [1, 2, 0], "sigma_m": 0.01, ' \
             b'"sigma_deg": 1, "quaternion_xyzw": [0, 0, 0, 1]}'
    open_list = (b'{"schema": 1, "submaps": [{"frame": "facility", "markers": [', 1)
    inputs = [("50 MB of {\"a\":", [(b'{"a":', 10 * MEBI)]), ("32 MB of [", [(b"[", 32 * MEBI)]),
              ("200 MB of [", [(b"[", 200 * MEBI)]), ("200 MB of 0,", [(b"[", 1), (b"0,", 100 * MEBI), (b"0]", 1)]),
              ("100 MB of {},", [open_list, (b"{},", 33 * MEBI), (b"{}]}]}", 1)]),
              ("200 MB of a string", [(b'{"schema": "', 1), (b"s", 200 * MEBI), (b'"}', 1)]),
              ("10^6 markers of one id", [open_list, (marker + b",", 10**6), (marker + b"]}]}", 1)]),
              ("257 MB", [(b" ", 257 * MEBI)]), ("empty", [(b"", 1)]), ("NUL", [(b"\0", 1000)])]
    for name, pieces in inputs:
        path = fill(stand.folder / "hostile.json", *pieces)
        yield f"map: {name}", "refused", path, stand.import_map(path)
        path.unlink()
    for name, pieces in [("16 MB of [", [(b"[", 16 * MEBI)]), ("1 MB of [", [(b"[", MEBI - 1)]),
                         ("1 MB of 0,", [(b"[", 1), (b"0,", MEBI // 2 - 2), (b"0]", 1)])]:
        path = fill(stand.folder / "quarantine.json", *pieces)
        yield f"quarantine: {name}", "refused", path, stand.localize(path)
        path.unlink()


def tables(stand):
    row = b"1000000000,cam0,3,20,15,40,15,40,35,20,35\n"
    head = good.CSV_HEADER.encode()

    def rows(count):
        for i in range(count):
            yield f"{10**9 + i // 20 * 10**8},cam0,{3 + i % 2 + i % 20 // 2 * 2},{20 + i % 7},15,40,15,40,35,20,35\n".encode()

    def big_table(path, count):
        with open(path, "wb") as file:
            file.write(head)
            file.writelines(rows(count))
    inputs = [("200 MB of commas", [(b",", 200 * 10**6)]), ("200 MB in a line", [(head, 1), (b"1", 200 * 10**6)]),
              ("65 columns", [(head[:-1] + b",x" * 54 + b"\n", 1)]), ("2e6 empty lines", [(head, 1), (b"\n", 2 * 10**6)]),
              ("1e6 rows of one instant", [(head, 1), (row, 10**6)]), ("NUL", [(head, 1), (b"\0", 10**6)]),
              ("quotes", [(head, 1), (b'"', 10**6)])]
    for name, pieces in inputs:
        capture = stand.make_capture("hostile_capture")
        path = fill(capture / "detections.csv", *pieces)
        yield name, None if "empty" in name else "refused", path, stand.replay(capture)
    capture = stand.make_capture("hostile_capture")
    path = capture / "detections.csv"
    with open(path, "wb") as file:
        file.write(head)
        file.writelines(f"{i},cam0,3,1,1,2,1,2,2,1,2\n".encode() for i in range(10**6))
    yield "1e6 shortest rows", None, path, stand.replay(capture)
    for count in (10**5, 10**6):
        capture = stand.make_capture("hostile_capture")
        path = capture / "detections.csv"
        big_table(path, count)
        yield f"{count} good rows", None, path, stand.replay(capture)
    capture = stand.make_capture("hostile_capture")
    yield "sparse, 3 GB", "refused", sparse(capture / "detections.csv", 3 * 10**9, head), stand.replay(capture)
    yield "sparse, 8 TB", "refused", sparse(capture / "detections.csv", 8 * 10**12, head), stand.replay(capture)


def trajectories(stand):
    """markers.tum of a ground truth."""
    truth = stand.folder / "truth"
    truth.mkdir(exist_ok=True)
    path = truth / "markers.tum"
    inputs = [("100 MB of fields in a line", [(b"1 ", 50 * 10**6)]), ("100 MB of blanks", [(b" ", 100 * 10**6)]),
              ("100 MB in a field", [(b"1", 100 * 10**6)]), ("3e6 lines of one marker", [(b"3 0 0 0 0 0 0 1\n", 3 * 10**6)]),
              ("3e7 empty lines", [(b"\n", 3 * 10**7)]), ("NUL", [(b"\0", 10**6)]), ("norm 0", [(b"3 0 0 0 0 0 0 0\n", 1)])]
    for name, pieces in inputs:
        fill(path, *pieces)
        yield name, None if "blanks" in name or "empty" in name else "refused", path, stand.evaluate(truth)
    yield "sparse, 1 GB", "refused", sparse(path, 10**9), stand.evaluate(truth)
    path.unlink()


def special_files(stand):
    """In place of a file that is read."""
    def put(path, how):
        path.unlink(missing_ok=True)
        if how == "pipe":
            os.mkfifo(path)
        elif how == "folder":
            path.mkdir()
        elif how == "loop":
            path.symlink_to(path.name)
        elif how == "nowhere":
            path.symlink_to("nothing-there")
        else:
            path.symlink_to(how)
    for file in ("detections.csv", "rig.yaml", "markers.toml", "capture.toml"):
        for how in ("pipe", "folder", "loop", "/dev/zero", "/dev/tty0"):
            capture = stand.make_capture("hostile_capture")
            put(capture / file, how)
            yield f"{file}: {how}", "refused", None, stand.replay(capture)
    for how in ("pipe", "folder", "loop", "nowhere", "/dev/zero"):
        path = stand.folder / "special"
        if path.is_dir() and not path.is_symlink():
            path.rmdir()
        put(path, how)
        for arguments in (stand.info(path), stand.import_map(path), stand.check(path),
                          stand.check_with("camchain", path), stand.check_with("path", path)):
            yield f"{pathlib.Path(arguments[0]).name} {arguments[1]}: {how}", "refused", None, arguments
    for name in ("a\nb", "\x1b[31mred", "\u202ereversed"):
        capture = stand.make_capture("hostile_capture" + name)
        fill(capture / "detections.csv", (b"no table\n", 1))
        yield f"named {name!r}", "refused", None, stand.replay(capture)
        keys = fill(stand.folder / "keys.toml", (f"{name!r}".replace("'", '"').encode() + b" = 1\n", 1))
        yield f"key {name!r}", "refused", keys, stand.check(keys)


def images(stand):
    small = good.pgm(64, 48)
    bomb = mutated.png(7000, 7000, 16, 6)
    text = mutated.chunk(b"zTXt", b"k\0\0" + zlib.compress(bytes(64 * MEBI), 9))
    inputs = [("png 7000 px, 16 bit RGBA", "png", bomb), ("png header of 65535 px", "png", mutated.png(65535, 65535, rows=1)),
              ("png of 2^31 px", "png", mutated.png(2**31 - 1, 2**31 - 1, rows=0)),
              ("png without rows", "png", mutated.png(64, 48, rows=0)),
              ("png with 64 MB of text", "png", mutated.png(64, 48, extra=text)),
              ("png with 1,000 texts of 1 MB", "png", mutated.png(64, 48, extra=1000 * mutated.chunk(
                  b"zTXt", b"k\0\0" + zlib.compress(bytes(MEBI), 9)))),
              ("png of other size", "png", mutated.png(65, 48)),
              ("jpeg of 21 scans", "jpg", mutated.jpeg(64, 48, 20)), ("jpeg of 400 scans", "jpg", mutated.jpeg(64, 48, 400)),
              ("jpeg of 1e5 scans", "jpg", mutated.jpeg(64, 48, 100_000)), ("jpeg of 65500 px", "jpg", mutated.jpeg(65500, 65500)[:4096]),
              ("jpeg of other size", "jpg", mutated.jpeg(72, 48)),
              ("pgm of 10^9 px", "pgm", b"P5\n1000000000 1000000000\n255\n"), ("pgm, numbers of 10^6 digits", "pgm", b"P5\n" + b"9" * 10**6),
              ("pgm, comment of 10 MB", "pgm", b"P5\n#" + b"c" * 10 * MEBI), ("empty", "png", b""),
              ("bmp", "png", b"BM" + bytes(100)), ("text", "jpg", b"no image\n")]
    for name, ending, content in inputs:
        for read in (stand.replay, stand.detect):
            capture = stand.make_capture("hostile_images", {f"100000000.{ending}": content})
            yield f"{pathlib.Path(read(capture)[0]).name}: {name}", "refused", capture / "cam0", read(capture)
    for name, make, expected in [
            ("sparse of 2 GB", lambda path: sparse(path, 2 * 10**9), "refused"), ("pipe", os.mkfifo, "refused"),
            ("folder", os.mkdir, "refused"), ("link to itself", lambda path: path.symlink_to(path.name), "refused")]:
        for read in (stand.replay, stand.detect):
            capture = stand.make_capture("hostile_images", {})
            make(capture / "cam0" / "100000000.jpg")
            yield f"{pathlib.Path(read(capture)[0]).name}: {name}", expected, capture / "cam0", read(capture)
    for name, content in [("all empty", b""), ("all damaged", small[:1000])]:
        for read in (stand.replay, stand.detect):
            capture = stand.make_capture("hostile_images", {f"{10**8 * (i + 1)}.pgm": content for i in range(20_000)})
            yield f"{pathlib.Path(read(capture)[0]).name}: 20,000, {name}", "refused", capture / "cam0", read(capture)


def configurations(stand):
    """locd.toml with one value replaced."""
    values = ["nan", "inf", "-inf", "1e308", "-1e308", "9223372036854775807", "-9223372036854775808", "-1",
              "1979-05-27T07:32:00Z", '"text"', "[]", "{}", "true"]
    for key, own in [("deadline_ms", "25"), ("time_budget_ms", "100"), ("ok_sigma_m", "0.02"), ("v_max_mps", "3.0"),
                     ("max_bytes", "1000000"), ("startup_wait_s", "5.0"), ("every_nth", "2"), ("min_cameras", "1")]:
        for value in values:
            text = good.CONFIG.replace(f"{key} = {own}", f"{key} = {value}")
            path = fill(stand.folder / "hostile.toml", (text.encode(), 1))
            yield f"{key} = {value}", None if value in ("9223372036854775807", "1e308", "-1", "inf") else "refused", path, stand.check(path)
    for url in ["udpm://239.255.76.67:7667?ttl=0&ttl=5", "udpm://239.255.76.67:99999", "udpm://999.1.1.1:7667",
                "udpm://10.0.0.1:7667", "file:///nonexistent", "udpm://239.255.76.67:0", "udpm://239.255.76.67:7667?ttl=-1",
                "udpm://239.255.76.67:7667?ttl=0&foo=1", "", "\\u0000", "udpm://239.255.76.67:7667?ttl=256",
                "memq://\\n[lcm]", "u" * 10_000]:
        path = fill(stand.folder / "hostile.toml", (good.CONFIG.replace("memq://", url).encode(), 1))
        yield f"url {url[:50]}", "refused", path, stand.check(path)
    for prefix in ["\\u0000", "a\\nb", "", "x" * 1000, "\\u001b[2J"]:
        path = fill(stand.folder / "hostile.toml", (good.CONFIG.replace('"WAYMARK"', f'"{prefix}"').encode(), 1))
        yield f"prefix {prefix[:20]}", "refused", path, stand.check(path)


def maps(stand):
    """What is no whole map in its place."""
    whole = (stand.folder / "good.map").read_bytes()
    inputs = [("half", [(whole[:len(whole) // 2], 1)]), ("header only", [(whole[:24], 1)]), ("empty", [(b"", 1)]),
              ("doubled", [(whole, 2)]), ("256 MB more", [(whole, 1), (b"\0", 256 * MEBI)]),
              ("another kind", [(b"P5\n64 48\n255\n", 1)]), ("newer", [(whole[:8] + struct.pack("<I", 9) + whole[12:], 1)])]
    for name, pieces in inputs:
        path = fill(stand.folder / "hostile.map", *pieces)
        yield f"locd: {name}", "refused", path, stand.check_with("path", path)
        yield f"mapbuilder: {name}", "refused", path, stand.info(path)


GROUPS = [("YAML: laughs, aliases, depth, sizes, keys", yaml), ("TOML: depth, dotted keys, headers, length", toml),
          ("JSON: depth, width, twins; quarantine.json", json), ("detections.csv: lines, rows, sparse", tables),
          ("TUM: lines, fields, sparse", trajectories),
          ("special files, links, names in place of what is read", special_files),
          ("images: bombs, scans, sizes, sparse, thousands", images),
          ("locd.toml: NaN, ∞, 2⁶³, dates, urls, prefixes", configurations), ("maps: half, doubled, huge, newer", maps)]
