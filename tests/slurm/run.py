#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A sweep as an array of Slurm jobs gives the table of one process byte for byte, killed in the middle, too.

  run.py PROGRAM    starts a Slurm of one node on the loopback for itself, runs reports/plans/cluster/slurm.sh there and ends it;
                    ends with 77 and the reason where Slurm cannot be started
"""
import os
import pathlib
import shutil
import socket
import subprocess
import sys
import tempfile
import time

SKIPPED = 77
UP_S, JOB_S = 20, 120  # longest waits
POINTS = 96
PROJECT = pathlib.Path(__file__).resolve().parents[2]
PROGRAMS = ["munged", "slurmctld", "slurmd", "sbatch", "scancel", "sinfo", "squeue"]
PLAN = """name = "cluster"
command = ["encode", "{scene}", "-o", "/dev/null", "-p", "{deadband}"]
[[input]]
name = "push"
file = "push-{seed}.mcap"
command = ["sim", "push-1dof", "--duration", "3s", "--seed", "{seed}", "-o", "{file}"]
[vary]
deadband = { from = "1%", to = "24%", count = 24 }
scene = ["push"]
[repeat]
seed = ["1", "2", "3", "4"]
[measure]
packets_per_s = "/traffic/packets_per_s"
force_rms_N = "/error/contact_force_N/rms"
"""
CONF = """ClusterName=tactus
SlurmctldHost={host}(127.0.0.1)
AuthType=auth/munge
AuthInfo=socket={at}/munge.socket
CredType=cred/munge
SlurmUser=root
SlurmdUser=root
StateSaveLocation={at}/state
SlurmdSpoolDir={at}/spool
SlurmctldPidFile={at}/slurmctld.pid
SlurmdPidFile={at}/slurmd.pid
SlurmctldPort={ctld}
SlurmdPort={slurmd}
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
MpiDefault=none
ReturnToService=2
AccountingStorageType=accounting_storage/none
NodeName={host} NodeAddr=127.0.0.1 CPUs=2
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


class CannotStart(Exception):
    pass


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Slurm:
    """Daemons in the foreground, as children of this process."""

    def __init__(self, at):
        self.at, self.running = at, []
        self.env = {**os.environ, "SLURM_CONF": f"{at}/slurm.conf"}

    def __enter__(self):
        if os.geteuid() != 0:
            raise CannotStart("its daemons want root")
        missing = [name for name in PROGRAMS if not shutil.which(name)]
        if missing:
            raise CannotStart(f"no {', '.join(missing)} (apt-get install slurm-wlm munge)")
        for folder in ("state", "spool"):
            (self.at / folder).mkdir()
        (self.at / "key").write_bytes(os.urandom(1024))
        (self.at / "key").chmod(0o400)
        conf = CONF.format(at=self.at, host=socket.gethostname().split(".")[0], ctld=free_port(), slurmd=free_port())
        (self.at / "slurm.conf").write_text(conf, encoding="utf-8")
        try:
            self.start("munged", "--force", "--foreground", f"--key-file={self.at}/key", f"--socket={self.at}/munge.socket",
                       f"--pid-file={self.at}/munge.pid", f"--log-file={self.at}/munge.log", f"--seed-file={self.at}/munge.seed")
            self.start("slurmctld", "-D", "-f", f"{self.at}/slurm.conf")
            self.start("slurmd", "-D", "-f", f"{self.at}/slurm.conf")
            self.wait_until_idle()
        except BaseException:
            self.__exit__()
            raise
        return self

    def start(self, *words):
        with open(self.at / f"{words[0]}.out", "wb") as out:
            self.running.append(subprocess.Popen(words, env=self.env, stdin=subprocess.DEVNULL, stdout=out, stderr=out))

    def wait_until_idle(self):
        end = time.monotonic() + UP_S
        while time.monotonic() < end:
            died = [p.args[0] for p in self.running if p.poll() is not None]
            if died:
                printed = (self.at / f"{died[0]}.out").read_text(errors="replace").strip().splitlines()
                raise CannotStart(f"{died[0]} ended: {printed[-1] if printed else 'without a word'}")
            try:
                if self.run("sinfo", "--noheader", "--format=%T", timeout=5).stdout.strip() == "idle":
                    return
            except (subprocess.TimeoutExpired, subprocess.CalledProcessError):
                pass
            time.sleep(0.2)
        raise CannotStart(f"its node was not idle within {UP_S} s")

    def run(self, *words, timeout=30, **more):
        return subprocess.run(words, env={**self.env, **more}, cwd=self.at, check=True, timeout=timeout, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def wait_for(self, done, what):
        end = time.monotonic() + JOB_S
        while not done():
            if time.monotonic() > end:
                raise AssertionError(f"{what}: not within {JOB_S} s\n{self.run('squeue').stdout}")
            time.sleep(0.03)

    def has_jobs(self):
        return self.run("squeue", "--noheader").stdout.strip() != ""

    def __exit__(self, *_):
        for process in reversed(self.running):
            process.terminate()
        for process in reversed(self.running):
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def rows(at):
    return sum(1 for _ in at.glob("parts/points/*.json"))


def check(slurm, at):
    script = str(PROJECT / "reports/plans/cluster/slurm.sh")
    slurm.run("tactus", "sweep", "plan.toml", "-o", "one", "-q")
    slurm.run(script, "2", "plan.toml", "-o", "parts", "-q")
    slurm.wait_for(lambda: rows(at) >= 3, "the first points")
    slurm.run("scancel", "--signal=KILL", "--full", "--name=tactus-sweep")
    slurm.wait_for(lambda: not slurm.has_jobs(), "the end of killed jobs")
    before = rows(at)
    assert before < POINTS and not (at / "parts/table.csv").exists(), f"{before} points: nothing was left to kill"
    slurm.run(script, "2", "plan.toml", "-o", "parts", "-q")
    slurm.wait_for(lambda: (at / "parts/table.csv").exists() and not slurm.has_jobs(), "the merged table")
    for name in ("points.csv", "table.csv", "context.json"):
        assert (at / "one" / name).read_bytes() == (at / "parts" / name).read_bytes(), f"{name} differs from that of one process"
    print(f"{POINTS} points in 2 jobs of Slurm, killed after {before}: tables equal those of one process")


def main(args):
    if len(args) != 1:
        print(__doc__, file=sys.stderr)
        return 2
    with tempfile.TemporaryDirectory(prefix="slurm") as scratch:
        at = pathlib.Path(scratch)
        (at / "bin").mkdir()
        (at / "bin/tactus").symlink_to(pathlib.Path(args[0]).resolve())
        os.environ["PATH"] = f"{at}/bin:{os.environ['PATH']}"
        (at / "plan.toml").write_text(PLAN, encoding="utf-8")
        try:
            with Slurm(at) as slurm:
                check(slurm, at)
        except CannotStart as why:
            print(f"skipped: Slurm cannot be started here: {why}")
            return SKIPPED
        except subprocess.CalledProcessError as failed:
            print(f"{failed}\n{failed.stdout}{failed.stderr}")
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
