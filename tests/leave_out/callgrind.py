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


def entered(counts, kinds, *command):
    """By kind, the functions that the command entered whose names match the kind's pattern."""
    run(counts, *command)
    functions = re.findall(r"^c?fn=\(\d+\) (.+)$", counts.read_text(), re.MULTILINE)
    return {kind: sorted({f for f in functions if re.search(pattern, f)}) for kind, pattern in kinds.items()}


def is_wanted(title, found, wanted):
    """Whether functions of these kinds and of no other ran; prints a line about it."""
    ran = {kind for kind, functions in found.items() if functions}
    print(f"{'ok    ' if ran == wanted else 'FAILED'}  {title}: " +
          (", ".join(f"{len(found[kind])} functions of {kind}" for kind in sorted(ran)) or "nothing of it runs"))
    if ran - wanted:
        print(*(f"        {f}" for kind in ran - wanted for f in found[kind]), sep="\n")
    return ran == wanted
