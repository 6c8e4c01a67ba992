#!/usr/bin/env python3
"""Every source has a test file of its own, or its reason in sources_without_tests.txt.

Usage: tests_mirror_sources.py ROOT

The test of core/map/map_file.cc is tests/core/map/map_file_test.cc. The list has a source and its reason on a line; a line
for a source that has a test, or that is not there, is wrong too, so that the list only shrinks.
"""

import pathlib
import sys

FOLDERS = ("core", "drivers", "locd", "mapbuilder", "simulator")


def faults(sources, tests, reasons):
    """Messages for sources, test files (both below the root) and the list's source → reason."""
    for source in sorted(sources):
        test = "tests/" + source.removesuffix(".cc") + "_test.cc"
        if test in tests and source in reasons:
            yield f"{source}: has {test}; take it out of the list"
        elif test not in tests and not reasons.get(source):
            yield f"{source}: neither {test} nor a reason in sources_without_tests.txt"
    for source in sorted(set(reasons) - set(sources)):
        yield f"{source}: is in the list, but not in the tree"


def selftest():
    tests = {"tests/core/a_test.cc", "tests/core/b_test.cc"}
    sources = {"core/a.cc", "core/b.cc", "core/c.cc", "core/d.cc"}
    found = list(faults(sources, tests, {"core/b.cc": "why", "core/c.cc": "why", "core/e.cc": "why"}))
    assert len(found) == 3, found
    assert not list(faults({"core/a.cc", "core/c.cc"}, tests, {"core/c.cc": "why"}))


def read_reasons(path):
    reasons = {}
    for line in path.read_text(encoding="utf-8").splitlines():
        if line and not line.startswith("#"):
            source, _, reason = line.partition(" ")
            reasons[source] = reason.strip()
    return reasons


def main():
    selftest()
    root = pathlib.Path(sys.argv[1])
    below = lambda folder, pattern: {str(path.relative_to(root)) for path in (root / folder).rglob(pattern)}
    sources = set().union(*(below(folder, "*.cc") for folder in FOLDERS))
    reasons = read_reasons(pathlib.Path(__file__).parent / "sources_without_tests.txt")
    found = list(faults(sources, below("tests", "*_test.cc"), reasons))
    print("\n".join(found) or f"{len(sources)} sources, {len(reasons)} of them without a test of their own")
    return 1 if found or not sources else 0


if __name__ == "__main__":
    sys.exit(main())
