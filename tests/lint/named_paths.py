#!/usr/bin/env python3
"""Every path of the tree that the documents name is there. Usage: named_paths.py ROOT

Looked at are README.md, CONTRIBUTING.md and docs/*.md (but faults.md, which names tests); a path is what begins with a folder of the tree, in a code span
or a link. Placeholders (<name>, {h,cc}, *, …) are left out.
"""

import pathlib
import re
import sys

FOLDERS = "bench|cmake|core|docs|drivers|examples|locd|mapbuilder|proto|scripts|simulator|systemd|tests"
PATH = re.compile(rf"(?:(?<=`)|(?<=\]\()(?:\.\./)?)((?:{FOLDERS})/[\w./+-]*)")


def missing(document, text, root):
    for path in sorted(set(PATH.findall(text))):
        path = path.rstrip(".")
        at = text.find(path) + len(path)
        if text[at:at + 1] in "<{*…":
            continue
        if not (root / path).exists():
            yield f"{document}: names {path}, which is not there"


def selftest(root):
    text = "See `core/base/no_such.h`, [this](docs/none.md), `core/<name>/x.h` and `core/base/error.h`."
    found = list(missing("page", text, root))
    assert found == ["page: names core/base/no_such.h, which is not there",
                     "page: names docs/none.md, which is not there"], found


def main():
    root = pathlib.Path(sys.argv[1])
    selftest(root)
    documents = [root / "README.md", root / "CONTRIBUTING.md",
                 *(page for page in sorted((root / "docs").glob("*.md")) if page.name != "faults.md")]
    found = [line for document in documents
             for line in missing(document.relative_to(root), document.read_text(encoding="utf-8"), root)]
    print("\n".join(found) or f"{len(documents)} documents name what is there")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
