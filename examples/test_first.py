#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Hold the first program in another language against the one in C++: both print the same text.

    test_first.py C++-PROGRAM c PROGRAM
    test_first.py C++-PROGRAM csharp FOLDER-OF-LIBTACTUS
    test_first.py C++-PROGRAM python FOLDER-OF-THE-PACKAGE
    test_first.py C++-PROGRAM javascript FOLDER-OF-THE-PACKAGE-FOR-PYTHON NPM-PACKAGE

Ends with 77, and says what is missing, where the language is not installed.
"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

FIRST = pathlib.Path(__file__).resolve().parent / "first"


def skip(reason):
    print(f"skipped: {reason}")
    sys.exit(77)


def printed(*command, **environment):
    done = subprocess.run([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=120, check=False,
                          env=os.environ | environment)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: status {done.returncode}\n{done.stdout}")
    return done.stdout


def run_c(program):
    return printed(program)


def run_csharp(library):
    if not shutil.which("mcs") or not shutil.which("mono"):
        skip("no Mono (apt-get install mono-mcs mono-runtime)")
    warnings = printed("mcs", "-warn:4", "-warnaserror", "-unsafe", FIRST / "First.cs", "-out:First.exe")
    if warnings:
        sys.exit(warnings)
    return printed("mono", "First.exe", LD_LIBRARY_PATH=library)


def run_python(package):
    python = "/usr/bin/python3" if os.path.exists("/usr/bin/python3") else sys.executable  # the one that has the system's NumPy
    if subprocess.run([python, "-c", "import numpy"], capture_output=True, check=False).returncode != 0:
        skip("no NumPy (apt-get install python3-numpy)")
    return printed(python, FIRST / "first.py", PYTHONPATH=package, PYTHONDONTWRITEBYTECODE="1")


def run_javascript(python_package, package):
    if not shutil.which("node"):
        skip("no Node (apt-get install nodejs)")
    if not pathlib.Path(package, "tactus.wasm").exists():
        skip("the module of WebAssembly is not built here")
    run_python(python_package)  # writes the stream
    os.makedirs("node_modules/@tactus-codec")
    os.symlink(package, "node_modules/@tactus-codec/decoder")
    shutil.copy(FIRST / "first.mjs", "first.mjs")
    return printed("node", "first.mjs")


def main(wanted, language, *rest):
    runs = {"c": run_c, "csharp": run_csharp, "python": run_python, "javascript": run_javascript}
    with tempfile.TemporaryDirectory() as scratch:
        os.chdir(scratch)
        own, other = printed(wanted), runs[language](*rest)
        os.chdir("/")
    if not own.endswith(" m\n") or own != other:
        sys.exit(f"first.cpp prints\n{own}and the program in {language}\n{other}")
    print(own, end="")


if __name__ == "__main__":
    main(*sys.argv[1:])
