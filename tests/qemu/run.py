#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A device from the kernel to the trace: an emulated machine with Debian's kernel, a device of /dev/uhid in it, hidraw, hidapi, `capture`.

  run.py TACTUS UHID_DEVICE FOLDER    writes initramfs, console and traces to FOLDER

A controller moves 1000 times per second, 2000 times, and is unplugged; meanwhile the wall clock leaps. Then comes something that is no
controller. The traces must be whole and in order, and each capture must say that the device is gone. Needs qemu-system-x86_64, a kernel of Debian below /boot, and static busybox.
"""
import csv
import io
import json
import pathlib
import re
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).parent
MODULES = ("hid-generic", "uhid")
LIBRARIES = ("libhidapi-hidraw.so.0",)  # loaded while the program runs
TIMEOUT_S = 300
REACH = 350
STEP_M = 4e-6  # of the first axis


def run(*command, **options):
    return subprocess.run([str(part) for part in command], check=True, stdout=subprocess.PIPE, **options).stdout


def newest_kernel():
    kernels = sorted(pathlib.Path("/boot").glob("vmlinuz-*"))
    if not kernels:
        sys.exit("run.py: no kernel below /boot (apt-get install linux-image-amd64)")
    return kernels[-1], kernels[-1].name.removeprefix("vmlinuz-")


def modules_of(version):
    """Files in the order in which they are loaded."""
    files = []
    for name in MODULES:
        for line in run("modprobe", "-S", version, "--show-depends", name, text=True).splitlines():
            words = line.split()
            if words[0] == "insmod" and words[1] not in files:
                files.append(words[1])
    return files


def libraries_of(program):
    return re.findall(r"(/\S+)", run("ldd", program, text=True))


def build_root(root, programs, version):
    for folder in ("bin", "proc", "sys", "dev"):
        (root / folder).mkdir(parents=True)
    shutil.copy("/bin/busybox", root / "bin/busybox")
    shutil.copy(HERE / "init", root / "init")
    (root / "init").chmod(0o755)
    extra = [library for library in map(find_library, LIBRARIES)]
    needed = {library for binary in [*programs, *extra] for library in libraries_of(binary)} | set(extra)
    for program in programs:
        shutil.copy(program, root / "bin")
    for library in needed:
        target = root / library.lstrip("/")
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(library, target)
    files = modules_of(version)
    for file in files:
        shutil.copy(file, root)
    (root / "modules.list").write_text("".join(f"/{pathlib.Path(file).name}\n" for file in files))


def find_library(name):
    found = re.search(rf"{re.escape(name)} .*=> (\S+)", run("/sbin/ldconfig", "-p", text=True))
    if not found:
        sys.exit(f"run.py: {name} is not installed")
    return found.group(1)


def pack(root, archive):
    names = "\n".join(str(path.relative_to(root)) for path in sorted(root.rglob("*")))
    archive.write_bytes(run("cpio", "-o", "-H", "newc", "--quiet", cwd=root, input=names.encode()))


def boot(kernel, archive, folder):
    console, traces = folder / "console.txt", [folder / "hand.mcap", folder / "glove.mcap"]
    subprocess.run(["qemu-system-x86_64", "-accel", "tcg", "-m", "512", "-nographic", "-no-reboot", "-nodefaults", "-display", "none",
                    "-kernel", kernel, "-initrd", archive, "-append", "console=ttyS0 quiet panic=-1",
                    *(word for file in [console, *traces] for word in ("-serial", f"file:{file}"))],
                   check=True, timeout=TIMEOUT_S, stdin=subprocess.DEVNULL)
    return console.read_text(errors="replace").replace("\r", ""), traces


def captures(console):
    """Of each: what the device printed at its end, what was printed meanwhile, and what the capture printed."""
    found = re.findall(r"^BEGIN (\d+) ([^\n]*)\n(.*?)^END$", console, re.S | re.M)
    if len(found) != 2:
        sys.exit(f"run.py: the machine did not come to its end:\n{console[-3000:]}")
    for status, _, printed in found:
        assert status == "1" and "R-DEV-4" in printed, printed  # the device is gone
    return [(json.loads(device), printed) for _, device, printed in found]


def rows_of(tactus, trace):
    return list(csv.DictReader(io.StringIO(run(tactus, "export", "csv", trace, text=True))))


def check_controller(console, device, printed, rows):
    clock, printed = printed.split("\n", 1)
    assert "2033" in clock, clock
    assert "hid:0" in console and "Six axes, serial U1" in console, console
    raw = [round(float(row["/users/hand/device_x"]) / STEP_M) + REACH for row in rows]
    moved = raw[raw.index(0):] if 0 in raw else []
    steps = [(b - a) % (2 * REACH + 1) for a, b in zip(moved, moved[1:])]
    seen = 1 + sum(steps)
    missed = sum(int(row["/users/hand/missed"]) for row in rows)
    late = sorted(int(row["/users/hand/late_ns"]) for row in rows)
    print(f"controller: {device['reports']} reports at 1000 Hz, its latest {device['latest_us']:.0f} us late\n"
          f"trace: {len(rows)} ticks, {missed} missed; late p50 {late[len(late) // 2] / 1e3:.0f} us, p99 {late[len(late) * 99 // 100] / 1e3:.0f} us,"
          f" max {late[-1] / 1e3:.0f} us\n"
          f"motion: {seen} of {device['reports']} reports followed, in order, largest step {max(steps)}\n"
          f"at the end: {json.loads(printed)['error']['text']}")
    assert seen == device["reports"], "the trace does not follow the motion to its end"
    assert max(steps) < 100, "a stretch of motion is missing"


def check_glove(console, device, printed, rows):
    assert "hid:/dev/hidraw0" in console and "Glove, serial U1, recorded report by report" in console, console
    reports = [bytes.fromhex(word) for row in rows for word in row["/users/hand/device_reports"].split()]
    expected = [n.to_bytes(4, "little") + bytes([n % 251]) * 60 for n in range(device["reports"])]
    print(f"glove: {device['reports']} reports at 1000 Hz, {len(reports)} in the trace, at most"
          f" {max(len(row['/users/hand/device_reports'].split()) for row in rows)} in a tick")
    assert reports == expected, "the trace does not hold every report, in order"


def main():
    tactus, device, folder = (pathlib.Path(argument).resolve() for argument in sys.argv[1:])
    shutil.rmtree(folder, ignore_errors=True)
    root = folder / "root"
    kernel, version = newest_kernel()
    build_root(root, [tactus, device], version)
    pack(root, folder / "initramfs.cpio")
    console, traces = boot(kernel, folder / "initramfs.cpio", folder)
    for check, (device, printed), trace in zip((check_controller, check_glove), captures(console), traces):
        check(console, device, printed, rows_of(tactus, trace))


if __name__ == "__main__":
    main()
