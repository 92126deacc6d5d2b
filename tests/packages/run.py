#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Make the Debian packages of a finished build; install, use and remove them in a root of their own.

  run.py BUILD               the root is this Debian under a layer that takes every change and is thrown away
  run.py BUILD --root DIR    the root is DIR, a bare Debian that somebody made (debootstrap); apt fetches what the packages need

Prints sizes, what was done inside, and what lintian finds. Ends with 77, and says why, where the machine cannot do it.
"""
import argparse
import io
import os
import pathlib
import shutil
import subprocess
import sys
import tarfile
import tempfile

SKIPPED = 77
HERE = pathlib.Path(__file__).resolve().parent
SOURCE = HERE.parent.parent
NEEDED = {"cpack": "cmake", "dpkg-deb": "dpkg", "dpkg-shlibdeps": "dpkg-dev", "unshare": "util-linux"}
# Warnings that stay, and why.
ACCEPTED = {"maintscript-calls-ldconfig": "CPack writes these scripts itself, beside the trigger"}


def skip(why):
    print(f"skipped: {why}")
    sys.exit(SKIPPED)


def run(*words, **options):
    return subprocess.run([str(w) for w in words], check=True, text=True, **options)


def commit_time():
    """Of the sources [s]; None outside of a checkout."""
    if not (SOURCE / ".git").exists():
        return None
    return int(run("git", "-C", SOURCE, "log", "-1", "--format=%ct", stdout=subprocess.PIPE).stdout)


def check_files(package, build, time):
    """Everybody may read what is installed, and only root may write it; nothing tells where it was built, or when."""
    modes = {tarfile.DIRTYPE: (0o755,), tarfile.REGTYPE: (0o644, 0o755), tarfile.SYMTYPE: (0o777,)}
    folders = [str(folder).encode() for folder in (build, SOURCE)]
    data = subprocess.run(["dpkg-deb", "--fsys-tarfile", package], check=True, stdout=subprocess.PIPE).stdout
    with tarfile.open(fileobj=io.BytesIO(data)) as archive:
        for member in archive:
            if member.mode not in modes[member.type] or (member.uname, member.gname) != ("root", "root"):
                sys.exit(f"{package.name}: {member.name} has mode {member.mode:o} and belongs to {member.uname}:{member.gname}")
            if time is not None and member.mtime != time:
                sys.exit(f"{package.name}: {member.name} is of {member.mtime}, and the commit of {time}")
            content = archive.extractfile(member).read() if member.isreg() else b""
            if any(folder in content for folder in folders):
                sys.exit(f"{package.name}: {member.name} names the folder in which it was built")


def check_linked(build):
    """Before debug information is stripped, which leaves its trace in the build id."""
    for file in [*build.glob("bindings/c/*.so"), build / "cli/tactus"]:
        if file.exists() and any(str(folder).encode() in file.read_bytes() for folder in (build, SOURCE)):
            sys.exit(f"{file} names the folder in which it was built")


def run_cpack(build, folder):
    folder.mkdir()
    before = os.umask(0o077)  # that of a careful person
    run("cpack", "--config", build / "CPackConfig.cmake", "-B", folder, "-D", f"CPACK_OUTPUT_FILE_PREFIX={folder}", stdout=subprocess.DEVNULL)
    os.umask(before)
    return sorted(folder.glob("*.deb"))


def make_packages(build, scratch):
    time = commit_time()
    check_linked(build)
    found = run_cpack(build, scratch / "packages")
    again = run_cpack(build, scratch / "elsewhere")
    if not found or [package.name for package in found] != [package.name for package in again]:
        sys.exit(f"made {[package.name for package in found]}, then {[package.name for package in again]}")
    for package, other in zip(found, again):
        fields = run("dpkg-deb", "-f", package, "Package", "Installed-Size", stdout=subprocess.PIPE).stdout.split()
        check_files(package, build, time)
        if time is not None and package.read_bytes() != other.read_bytes():
            sys.exit(f"{package.name} differs when it is made again, in another folder")
        print(f"{fields[1]:16} {package.stat().st_size / 1e6:6.2f} MB, installed {int(fields[3]) / 1e3:6.1f} MB")
    return found


def lint(packages):
    """Findings of lintian that are not accepted."""
    if shutil.which("lintian") is None:
        print("lintian is not there (apt-get install lintian): not looked at")
        return []
    user = ["--allow-root"] if os.geteuid() == 0 else []
    text = subprocess.run(["lintian", *user, *map(str, packages)], text=True, capture_output=True, check=False).stdout
    print("lintian:", text.strip() or "nothing found", sep="\n")
    findings = [line for line in text.splitlines() if line[:2] in ("E:", "W:")]
    return [line for line in findings if line.split()[2] not in ACCEPTED]


def provide(root, packages, build):
    """What the work inside reads, below /srv/tactus-test."""
    inside = root / "srv/tactus-test"
    inside.mkdir(parents=True)
    for package in packages:
        shutil.copy(package, inside)
    for source in [HERE / "inside.sh", build / "examples/umbrella.cpp", *(SOURCE / "tests/consumer").glob("*.c*")]:
        shutil.copy(source, inside)
    shutil.copytree(SOURCE / "tests/consumer/installed", inside / "installed")


def can_layer():
    probe = "mount -t tmpfs none /mnt && mkdir /mnt/a /mnt/b /mnt/c && mount -t overlay none -o lowerdir=/,upperdir=/mnt/a,workdir=/mnt/b /mnt/c"
    return subprocess.run(["unshare", "--mount", "sh", "-c", probe], capture_output=True, check=False).returncode == 0


LAYERED = """set -eu
mount -t tmpfs none /mnt
mkdir /mnt/upper /mnt/work /mnt/root
mv "$1" /mnt/upper/srv
mount -t overlay none -o lowerdir=/,upperdir=/mnt/upper,workdir=/mnt/work /mnt/root
mount --rbind /dev /mnt/root/dev
mount -t proc none /mnt/root/proc
mount -t tmpfs none /mnt/root/tmp
exec chroot /mnt/root env -i PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 sh /srv/tactus-test/inside.sh dpkg
"""


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--root", type=pathlib.Path)
    options = parser.parse_args()
    missing = [f"{program} (apt-get install {package})" for program, package in NEEDED.items() if shutil.which(program) is None]
    if missing:
        skip("it needs " + ", ".join(missing))
    if os.geteuid() != 0:
        skip("only root may install packages")
    if options.root is None and not can_layer():
        skip("this kernel, or the container around this, allows no overlay in a mount namespace")
    with tempfile.TemporaryDirectory() as scratch:
        packages = make_packages(options.build.resolve(), pathlib.Path(scratch))
        if options.root:
            provide(options.root, packages, options.build)
            run("chroot", options.root, "sh", "/srv/tactus-test/inside.sh", "apt")
        else:
            provide(pathlib.Path(scratch, "root"), packages, options.build)
            run("unshare", "--mount", "sh", "-c", LAYERED, "sh", pathlib.Path(scratch, "root/srv"))
        findings = lint(packages)
    sys.exit(f"{len(findings)} findings of lintian are not accepted:\n" + "\n".join(findings) if findings else 0)


if __name__ == "__main__":
    main()
