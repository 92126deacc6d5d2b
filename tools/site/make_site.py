#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Make one static site of the documentation: README, examples, reports, the specification and the interface of the libraries.

  make_site.py OUT           write the site into the folder OUT, which is replaced; exit 1 when a link leads nowhere
  make_site.py --check OUT   check the links of a site
  make_site.py --self-test   check that each kind of finding is found

It needs cmark-gfm and doxygen; without them it ends with 77 and says so. The pages need no network: nothing is loaded from elsewhere.
"""
import pathlib
import shutil
import sys
import tempfile

sys.dont_write_bytecode = True
ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path += [str(pathlib.Path(__file__).resolve().parent), str(ROOT / "spec")]
import api
import links
import pages

TOOLS = {"cmark-gfm": "cmark-gfm", "doxygen": "doxygen"}  # program: Debian package
MARK = ".tactus-site"  # in a folder that may be replaced
SKIPPED = 77


def make(out):
    if out.exists() and any(out.iterdir()) and not (out / MARK).is_file():
        raise SystemExit(f"{out}: not a site that this program made; name another folder, or empty it")
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir(parents=True)
    (out / MARK).touch()
    with tempfile.TemporaryDirectory() as scratch:
        api.write(ROOT, out / "api", pathlib.Path(scratch))
    pages.write(ROOT, out)


def check(out):
    found = links.findings(out)
    print(*found, f"{out}: {len(list(out.rglob('*.html')))} pages, {len(found)} findings", sep="\n")
    return 1 if found else 0


def main(args):
    if args == ["--self-test"]:
        return links.self_test() | api.self_test() | pages.self_test()
    if args[:1] == ["--check"] and len(args) == 2:
        return check(pathlib.Path(args[1]))
    if len(args) != 1 or args[0].startswith("-"):
        print(__doc__, file=sys.stderr)
        return 2
    missing = [package for program, package in TOOLS.items() if not shutil.which(program)]
    if missing:
        print(f"the site needs: apt-get install {' '.join(missing)}")
        return SKIPPED
    make(pathlib.Path(args[0]))
    return check(pathlib.Path(args[0]))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
