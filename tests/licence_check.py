#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A program of a default build may be passed on under Apache-2.0: what it loads, directly or not, is known, and is not under the GPL.

  licence_check.py PROGRAM...   1 when a program loads a library that is not listed here
  licence_check.py --self-test  check that it can fail
Exits with 77 (skipped) where ldd is missing, and for programs of a sanitizer.
"""
import re
import shutil
import subprocess
import sys

# Read in Debian 12's /usr/share/doc/*/copyright. "or": ours is the choice.
LICENCES = {
    "libc": "LGPL-2.1+, part of the system",
    "libm": "LGPL-2.1+, part of the system",
    "libpthread": "LGPL-2.1+, part of the system",
    "libstdc++": "GPL-3 with the exception for run-time libraries",
    "libgcc_s": "GPL-3 with the exception for run-time libraries",
    "libzstd": "BSD-3-Clause or GPL-2",
    "liblz4": "BSD-2-Clause",
    "libode": "BSD-3-Clause or LGPL-2.1+",
    "libccd": "BSD-3-Clause",
    "libfmt": "MIT",
    "libtomlplusplus": "MIT",
    "libldl": "LGPL-2.1+, loaded as it is and replaceable",
    "libgnutls": "LGPL-2.1+, loaded as it is and replaceable",
    "libtasn1": "LGPL-2.1+, loaded by libgnutls",
    "libp11-kit": "BSD-3-Clause, loaded by libgnutls",
    "libffi": "MIT, loaded by libp11-kit",
    "libnettle": "LGPL-3+ or GPL-2+, loaded by libgnutls",
    "libhogweed": "LGPL-3+ or GPL-2+, loaded by libgnutls",
    "libgmp": "LGPL-3+ or GPL-2+, loaded by libgnutls",
    "libidn2": "LGPL-3+ or GPL-2+, loaded by libgnutls",
    "libunistring": "LGPL-3+ or GPL-2+, loaded by libgnutls",
}
LOADER = re.compile(r"linux-vdso|ld-linux")
SANITIZER = re.compile(r"lib[alt]san")


def loaded(ldd):
    """File name and licence of each library that ldd tells of; None: not listed."""
    names = (line.split()[0].rsplit("/", 1)[-1] for line in ldd.splitlines())
    return [(name, LICENCES.get(name.split(".so")[0])) for name in names if not LOADER.match(name)]


def findings(program, ldd):
    return [f"{program} loads {name}, which is not listed as going with Apache-2.0" for name, licence in loaded(ldd) if licence is None]


def self_test():
    good = "\tlinux-vdso.so.1 (0x1)\n\tlibode.so.8 => /lib/libode.so.8 (0x1)\n\t/lib64/ld-linux-x86-64.so.2 (0x1)\n"
    for bad in ("libcholmod.so.3", "libc-of-another.so.1", "libstdc++x.so.6"):
        if findings("p", good) or len(findings("p", good + f"\t{bad} => /lib/{bad} (0x1)\n")) != 1:
            return 1
    return 0


def main(arguments):
    if not arguments:
        print(__doc__, file=sys.stderr)
        return 2
    if arguments == ["--self-test"]:
        return self_test()
    if shutil.which("ldd") is None:
        print("skipped: ldd not found")
        return 77
    problems = []
    for program in arguments:
        ldd = subprocess.run(["ldd", program], check=True, capture_output=True, text=True).stdout
        if SANITIZER.search(ldd):
            print("skipped: not a program that is passed on")
            return 77
        print(*(f"{name}: {licence}" for name, licence in loaded(ldd)), sep="\n")
        problems += findings(program, ldd)
    print(*(f"FAILED  {p}" for p in problems), sep="\n")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
