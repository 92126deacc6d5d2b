# SPDX-License-Identifier: Apache-2.0
"""Prints the commands of a page: the lines that begin with `tactus` in its blocks, and its blocks of Python as one command each.

    page_commands.py PAGE
"""
import re
import shlex
import sys

for kind, block in re.findall(r"^```(\w*)\n(.*?)^```$", open(sys.argv[1], encoding="utf8").read(), re.M | re.S):
    if kind == "python":
        print("python3 -c " + shlex.quote(block))
    else:
        print("".join(line + "\n" for line in block.splitlines() if line.startswith("tactus ")), end="")
