# SPDX-License-Identifier: Apache-2.0
"""What the tests share that run a program in callgrind."""
import pathlib
import re
import shutil
import subprocess


def program_and_folder(arguments, usage):
    """The two arguments PROGRAM and FOLDER, which is made; or the status to exit with: 77 where valgrind is missing."""
    if len(arguments) != 2:
        print(usage)
        return 2
    if shutil.which("valgrind") is None:
        print("skipped: valgrind not found")
        return 77
    program, folder = map(pathlib.Path, arguments)
    folder.mkdir(parents=True, exist_ok=True)
    return program, folder


def run(counts, *command, collect=None):
    """Run a command; callgrind writes what it counts to the file, only inside the function `collect` if there is one."""
    toggle = [f"--toggle-collect={collect}"] if collect else []
    return subprocess.run(["valgrind", "--tool=callgrind", *toggle, f"--callgrind-out-file={counts}", *map(str, command)],
                          check=True, capture_output=True, text=True)


def instructions(counts, function, *command):
    """Executed inside a function, and what the command printed."""
    done = run(counts, *command, collect=function)
    return int(re.search(r"Collected : (\d+)", done.stderr).group(1)), done.stdout.strip()
