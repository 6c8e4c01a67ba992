#!/usr/bin/env python3
"""No call of std::filesystem that throws: files vanish, links lead in circles, folders forbid.

Every call that asks or changes the disk takes an error_code as its last argument, and folders are walked by walk_folder,
for a range-for over a directory_iterator throws on its way.

Usage: filesystem_calls.py ROOT [--selftest]
"""

import pathlib
import re
import sys

ASKS = (
    "absolute|canonical|weakly_canonical|relative|proximate|copy|copy_file|copy_symlink|create_directory|create_directories|"
    "create_hard_link|create_symlink|create_directory_symlink|current_path|equivalent|exists|file_size|hard_link_count|"
    "is_block_file|is_character_file|is_directory|is_empty|is_fifo|is_other|is_regular_file|is_socket|is_symlink|"
    "last_write_time|permissions|read_symlink|remove|remove_all|rename|resize_file|space|status|symlink_status|"
    "temp_directory_path|directory_iterator|recursive_directory_iterator"
)
CALL = re.compile(rf"\b(?:std::filesystem|fs)::({ASKS})(?:\s+\w+)?\(")
# Of what has been asked already: no path, no disk.
OF_A_STATUS = re.compile(r"^(\w*[sS]tatus|\w*ymlink_status\(.*|status\(.*|.*\.(status|symlink_status)\(\w+\))$", re.DOTALL)
AN_ERROR_CODE = re.compile(r"^\w+$")
WALK = re.compile(r"for \([^;{}]*?:\s*(?:std::filesystem|fs)::(?:recursive_)?directory_iterator")


def arguments(text, begin):
    """The arguments of a call whose parenthesis opens just before `begin`."""
    depth, found, start = 1, [], begin
    for at in range(begin, len(text)):
        c = text[at]
        if c in "([{":
            depth += 1
        elif c in ")]}":
            depth -= 1
            if depth == 0:
                last = text[start:at].strip()
                return found + ([last] if last else [])
        elif c == "," and depth == 1:
            found.append(text[start:at].strip())
            start = at + 1
    return found


def without_comments(text):
    return re.sub(r"//[^\n]*", "", text)


def violations(files):
    for path, raw in sorted(files.items()):
        text = without_comments(raw)
        for call in CALL.finditer(text):
            given = arguments(text, call.end())
            line = text.count("\n", 0, call.start()) + 1
            if len(given) == 1 and OF_A_STATUS.match(given[0]):
                continue
            if len(given) >= 2 and AN_ERROR_CODE.match(given[-1]):
                continue
            if call.group(1).endswith("directory_iterator") and not given:
                continue  # the end
            yield f"{path}:{line}: {call.group(1)} may throw: give it an error_code"
        for walk in WALK.finditer(text):
            line = text.count("\n", 0, walk.start()) + 1
            yield f"{path}:{line}: a range-for over a folder throws on its way: walk_folder does not"


def selftest():
    bad = {
        "a.cc": "return fs::exists(path);\n",
        "b.cc": "auto p = std::filesystem::weakly_canonical(path / name);\n",
        "c.cc": "for (const auto& entry : fs::directory_iterator(folder, ignored)) {\n",
        "d.cc": "fs::rename(a, b / c(d));\n",
    }
    good = {
        "a.cc": "return fs::exists(path, ignored) || fs::exists(status);\n",
        "b.cc": "for (fs::directory_iterator it(folder, error), end; !error; it.increment(error)) {\n",
        "c.cc": "// fs::exists(path) throws\nwalk_folder<fs::directory_iterator>(folder, visit);\n",
    }
    found = list(violations(bad))
    assert len(found) == len(bad), found
    assert not list(violations(good)), list(violations(good))


def main():
    selftest()
    root = pathlib.Path(sys.argv[1])
    files = {
        str(path.relative_to(root)): path.read_text(encoding="utf-8")
        for top in ("core", "drivers", "locd", "mapbuilder", "simulator")
        for path in (root / top).rglob("*")
        if path.suffix in (".h", ".cc")
    }
    found = list(violations(files))
    print("\n".join(found) or f"{len(files)} files ask the disk without throwing")
    return 1 if found or not files else 0


if __name__ == "__main__":
    sys.exit(main())
