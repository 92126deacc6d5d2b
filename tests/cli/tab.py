#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What a shell makes of a line when somebody presses the tabulator.

  tab.py SHELL START LINE...   SHELL (a command with its options) reads the line START on a terminal, then each LINE and a tabulator;
                               prints the line that then stands there. A tab in LINE is pressed where it stands.
"""
import os
import pty
import re
import select
import sys
import time

PROMPT = "ready>"
QUIET_S, LIMIT_S = 0.7, 60


def read_until(terminal, done):
    """What comes until `done` holds and nothing more comes for a moment."""
    text, end = "", time.monotonic() + LIMIT_S
    while time.monotonic() < end:
        if select.select([terminal], [], [], QUIET_S)[0]:
            text += os.read(terminal, 65536).decode(errors="replace")
        elif done(text):
            return text
    sys.exit(f"tab.py: the shell does not answer: {text!r}")


def shown(text):
    """Without what moves the cursor and sets colours."""
    text = re.sub(r"\x1b\[[0-9;?]*[a-zA-Z]|\x1b[=>]|\x07", "", text)
    while "\b" in text:
        text = re.sub(r"[^\b]?\b", "", text, count=1)
    return text


def main(shell, start, lines):
    child, terminal = pty.fork()
    if child == 0:
        os.environ.update(PS1=PROMPT, TERM="dumb", COLUMNS="200")
        words = shell.split()
        os.execvp(words[0], words)
    read_until(terminal, lambda text: PROMPT in text)
    os.write(terminal, (start + "\n").encode())
    read_until(terminal, lambda text: PROMPT in text)
    for line in lines:
        os.write(terminal, (line + "\t").encode())
        print(shown(read_until(terminal, lambda text: text)).replace("\r", "").strip())
        os.write(terminal, b"\x15\x03")
        read_until(terminal, lambda text: PROMPT in text)
    os.write(terminal, b"\x04exit\n")
    os.close(terminal)
    os.waitpid(child, 0)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], sys.argv[3:])
