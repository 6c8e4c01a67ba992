#!/usr/bin/env python3
"""Hands mapbuilder and locd what nobody should: files damaged, forged and thought out, and requests and
signals while locd runs; prints how each kind ended.

Usage: python3 bench/hostile_inputs MAPBUILDER LOCD [--cases FOLDER] [--share N] [--only WORD] [--verbose]

What may cost no more: 1 s + 1 µs a byte of processor time, and 50 MB + 20 bytes a byte of memory beyond that
of the same program on an input of a few bytes in which all is well.
  clear   refused: exit code 64 to 78 but 70, in one printable line of at most 500 bytes (and notes)
  taken   exit code 0, where that can be right
  crash   a signal, or exit code 70
  hang    still running after two minutes
  big     more memory
  slow    more processor time
  wrong   taken where it is to be refused or the other way round, or refused in another form
--cases: further files, each handed to what reads its ending. --share N: every Nth of the damaged inputs.
"""

import argparse
import pathlib
import sys
import tempfile

import by_hand
import mutated
import service
import stand as stands

COLUMNS = ["tried", "clear", "taken", "crash", "hang", "big", "slow", "wrong"]
LINE_BYTES = 500


def is_clear(errors):
    """One line that says what is wrong, beside notes, progress and findings; nothing that a terminal would obey."""
    text = errors.decode("utf-8", "replace")
    findings = [line for line in text.split("\n") if line.startswith("error [")]
    lines = [line for line in text.split("\n") if line.startswith(("locd: ", "mapbuilder: "))] or findings
    printable = all(c >= " " and c != "\x7f" and not "\u202a" <= c <= "\u202e" for line in text.split("\n") for c in line)
    program = max(len("locd: "), len("mapbuilder: "), len("error [intrinsics] "))
    return len(lines) == 1 and printable and all(len(line.encode()) <= LINE_BYTES + program for line in lines)


def verdicts(run, expected, size, baseline):
    """How it ended, and what it cost too much."""
    if run.code is None:
        yield "hang"
    elif run.code < 0 or run.code == 70 or b"internal" in run.errors:
        yield "crash"
    elif run.code == 0:
        yield "taken" if expected != "refused" else "wrong"
    else:
        yield "clear" if expected != "taken" and 64 <= run.code <= 78 and is_clear(run.errors) else "wrong"
    if (run.kilobytes - baseline.kilobytes) * 1024 > 50e6 + 20 * size:
        yield "big"
    if run.code is not None and run.seconds > 1 + 1e-6 * size:
        yield "slow"


class Table:
    def __init__(self, stand, only, verbose):
        self.stand, self.only, self.verbose = stand, only, verbose
        self.sum = dict.fromkeys(COLUMNS, 0)
        self.most = {"kilobytes": (0, ""), "seconds": (0.0, "")}
        print("| inputs | " + " | ".join(COLUMNS) + " |\n|---" * 1 + "|---" * len(COLUMNS) + "|")

    def add(self, label, cases):
        """`cases` give a name, what is right, the file (or None), and the arguments or a Run."""
        if self.only and self.only not in label:
            return
        row = dict.fromkeys(COLUMNS, 0)
        for name, expected, path, arguments in cases:
            size = stands.bytes_on_disk(path) if path else 0
            run = arguments if isinstance(arguments, stands.Run) else self.stand.run(arguments)
            found = list(verdicts(run, expected, size, self.baseline(run, arguments)))
            row["tried"] += 1
            for verdict in found:
                row[verdict] += 1
            for what, (most, _) in self.most.items():
                if getattr(run, what) > most:
                    self.most[what] = (getattr(run, what), f"{label}: {name}")
            if self.verbose or set(found) - {"clear", "taken"}:
                print(f"{label}: {name}: {' '.join(found)}: code {run.code}, {run.seconds:.2f} s, {run.kilobytes / 1e3:.0f} MB, "
                      f"{size} bytes: {run.errors[:600]!r}", file=sys.stderr, flush=True)
        for column in COLUMNS:
            self.sum[column] += row[column]
        print(f"| {label} | " + " | ".join(str(row[c]) for c in COLUMNS) + " |", flush=True)

    def baseline(self, run, arguments):
        """The same program on what is small and good."""
        if isinstance(arguments, stands.Run):
            return self.stand.baselines.get("service", run)
        kind = (str(arguments[0]), str(arguments[1]))
        good = self.stand.folder
        if kind not in self.stand.baselines:
            small = {"--config": self.stand.check(good / "locd.toml"), "--replay": self.stand.replay(good / "images"),
                     "info": self.stand.info(good / "good.map"), "import": self.stand.import_map(good / "map.json"),
                     "detect": self.stand.detect(good / "images")}
            self.stand.baselines[kind] = self.stand.run(small.get(kind[1], self.stand.info(good / "good.map")))
        return self.stand.baselines[kind]

    def end(self):
        print("| **sum** | " + " | ".join(f"**{self.sum[c]}**" for c in COLUMNS) + " |")
        kilobytes, seconds = self.most["kilobytes"], self.most["seconds"]
        print(f"\nmost memory {kilobytes[0] / 1e3:.0f} MB ({kilobytes[1]}), most processor time {seconds[0]:.1f} s ({seconds[1]})")
        return 1 if any(self.sum[c] for c in COLUMNS[3:]) else 0


def damaged_texts(stand, share):
    """(file, how many, how it is read): a capture's file is replaced in a capture."""
    def in_capture(name):
        def read(content):
            capture = stand.make_capture("hostile_capture", **{name.split(".")[0]: content})
            return capture / name, stand.replay(capture)
        return read

    def file_for(read):
        def place(content):
            path = stand.folder / "hostile"
            path.write_bytes(content)
            return path, read(path)
        return place

    def survey(path):
        return stand.build(stand.make_capture("surveyed"), "--survey", path)
    readers = {"locd.toml": file_for(stand.check), "rig.yaml": file_for(lambda p: stand.check_with("camchain", p)),
               "markers.toml": in_capture("markers.toml"), "capture.toml": in_capture("capture.toml"),
               "survey.toml": file_for(survey), "detections.csv": in_capture("detections.csv"),
               "map.json": file_for(stand.import_map)}

    def cases(names, count):
        for name in names:
            rng = mutated.generator(name)
            for i in range(count):
                content = mutated.damaged(stand.text(name), rng)
                if i % share == 0:
                    path, arguments = readers[name](content)
                    yield f"{name} {i}", None, path, arguments
    return cases


def damaged_images(stand, share):
    rng = mutated.generator("images")
    seeds = {"png": mutated.png(64, 48), "jpg": mutated.jpeg(64, 48), "pgm": stands.pgm(64, 48)}
    seeds_by_kind = [(ending, seed) for ending, seed in seeds.items()] + [("jpg", mutated.jpeg(64, 48, 5)),
                                                                         ("png", mutated.png(64, 48, 16, 6))]
    for i in range(540):
        ending, seed = seeds_by_kind[i % len(seeds_by_kind)]
        content = mutated.damaged(seed, rng)
        if ending == "png" and i % 2:
            content = mutated.with_checksums(content)
        if i % share == 0:
            capture = stand.make_capture("hostile_images", {f"100000000.{ending}": content})
            yield f"{ending} {i}", None, capture / "cam0", (stand.replay if i % 4 else stand.detect)(capture)


def forged_maps(stand, share):
    rng = mutated.generator("maps")
    whole = (stand.folder / "good.map").read_bytes()
    for i in range(440):
        content = mutated.forged_map(whole, rng)
        if i % share == 0:
            path = stand.folder / "hostile.map"
            path.write_bytes(content)
            yield f"map {i}", None, path, stand.check_with("path", path) if i % 2 else stand.info(path)


def further_files(stand, folder):
    for path in sorted(pathlib.Path(folder).resolve().iterdir()):
        kind = path.suffix[1:]
        if kind in ("toml", "yaml", "json"):
            readers = {"toml": stand.check, "yaml": lambda p: stand.check_with("camchain", p), "json": stand.import_map}
            yield path.name, "refused", path, readers[kind](path)
        elif kind in ("png", "jpg"):
            for read in (stand.replay, stand.detect):
                capture = stand.make_capture("hostile_images", {f"100000000.{kind}": path.read_bytes()})
                yield path.name, "refused", capture / "cam0", read(capture)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("mapbuilder", type=lambda p: pathlib.Path(p).resolve())
    parser.add_argument("locd", type=lambda p: pathlib.Path(p).resolve())
    parser.add_argument("--cases")
    parser.add_argument("--share", type=int, default=1)
    parser.add_argument("--only", default="")
    parser.add_argument("--verbose", action="store_true")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        stand = stands.Stand(folder, arguments.mapbuilder, arguments.locd)
        table = Table(stand, arguments.only, arguments.verbose)
        texts = damaged_texts(stand, arguments.share)
        table.add("maps forged with right checksum", forged_maps(stand, arguments.share))
        table.add("damaged locd.toml, rig.yaml, markers.toml, capture.toml, survey.toml",
                  texts(["locd.toml", "rig.yaml", "markers.toml", "capture.toml", "survey.toml"], 140))
        table.add("damaged detections.csv, map JSON", texts(["detections.csv", "map.json"], 175))
        table.add("damaged PNG, JPEG, PGM", damaged_images(stand, arguments.share))
        for label, cases in by_hand.GROUPS:
            table.add(label, cases(stand))
        if arguments.cases:
            table.add("files of --cases", further_files(stand, arguments.cases))
        for label, cases in service.GROUPS:
            table.add(label, cases(stand))
        return table.end()


if __name__ == "__main__":
    sys.exit(main())
