#!/usr/bin/env python3
"""Each option of a program's --help, and of its subcommands', is in its manual page, and none that it does not have; and
--help tells nothing of the library that reads the command line.

Usage: options_in_page.py PROGRAM PAGE
"""

import re
import subprocess
import sys

# How CLI11 writes what it checks and translates.
INTERNALS = r"->|ENUM|:value in|INT:INT|TEXT:|\} OR \{"


def help_of(program, *command):
    return subprocess.run([program, *command, "--help"], check=True, capture_output=True, text=True).stdout


def options_in(text):
    return set(re.findall(r"(?<![\w-])--[a-z][a-z-]*", text))


def options_listed(text):
    """Those that a help text lists, not those that its descriptions mention."""
    return {option for line in re.findall(r"^ +(-.*?)(?:  |$)", text, re.M) for option in options_in(line)}


def commands_in(text):
    _, _, listed = text.partition("\nSubcommands:\n")
    return re.findall(r"^  ([a-z]+)\b", listed, re.M)


def main():
    program, page = sys.argv[1:]
    with open(page, encoding="utf-8") as file:
        text = file.read().replace("\\-", "-")
    helps = [help_of(program)]
    commands = commands_in(helps[0])
    helps += [help_of(program, command) for command in commands]
    have = set().union(*map(options_listed, helps))
    said = options_in(text)
    faults = [f"{option}: not in {page}" for option in sorted(have - said)]
    faults += [f"{command}: not in {page}" for command in commands if not re.search(rf"\b{command}\b", text)]
    # Other programs' options stand in examples and see-also lines of none of the pages but that of the spy.
    faults += [f"{option}: in {page}, but no option" for option in sorted(said - have)]
    faults += [f"--help shows its library: {line.strip()}" for shown in helps for line in shown.splitlines()
               if re.search(INTERNALS, line)]
    print("\n".join(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
