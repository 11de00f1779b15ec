# SPDX-License-Identifier: Apache-2.0
"""Slurm on this machine for a test: munged, slurmctld and two slurmd in a folder of their own, as processes of this one.

No cgroups: what a killed node had started is found by its environment."""
import contextlib
import getpass
import os
import pathlib
import shutil
import signal
import socket
import subprocess

NEEDED = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "scontrol")
NODES = ("n1", "n2")

CONFIGURATION = """ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.sock
CredType=cred/munge
StateSaveLocation={folder}/state
SlurmctldPort={ports[0]}
SlurmctldPidFile={folder}/slurmctld.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdPidFile={folder}/%n.pid
SlurmdLogFile={folder}/%n.log
SlurmdSpoolDir={folder}/%n
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
JobCompType=jobcomp/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SwitchType=switch/none
MpiDefault=none
ReturnToService=2
SlurmctldTimeout=10
SlurmdTimeout=10
NodeName=n1 NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[1]} CPUs=2 State=UNKNOWN
NodeName=n2 NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[2]} CPUs=2 State=UNKNOWN
PartitionName=short Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP
"""


def search_path():
    return os.pathsep.join([os.environ.get("PATH", ""), "/usr/sbin", "/sbin"])


def missing():
    return [name for name in NEEDED if not shutil.which(name, path=search_path())]


def free_ports(count):
    with contextlib.ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket()) for _ in range(count)]
        for one in sockets:
            one.bind(("127.0.0.1", 0))
        return [one.getsockname()[1] for one in sockets]


def environment_of(process):
    try:
        text = pathlib.Path(f"/proc/{process}/environ").read_bytes()
    except OSError:
        return {}
    return dict(entry.split("=", 1) for entry in text.decode(errors="replace").split("\0") if "=" in entry)


def parent_of(process):
    try:
        return int(pathlib.Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[1])
    except OSError:
        return 0


class Cluster:
    def __init__(self, folder):
        self.folder, self.daemons = pathlib.Path(folder), {}
        self.folder.mkdir()
        self.folder.chmod(0o711)  # munged demands a folder that others may enter
        for name in ("state", *NODES):
            (self.folder / name).mkdir()
        key = self.folder / "munge.key"
        key.touch(0o600)
        key.write_bytes(os.urandom(1024))
        self.configuration = self.folder / "slurm.conf"
        self.configuration.write_text(CONFIGURATION.format(host=socket.gethostname(), user=getpass.getuser(), folder=self.folder,
                                                           ports=free_ports(3)))
        (self.folder / "cgroup.conf").write_text("CgroupPlugin=cgroup/v1\n")
        self.environment = {**os.environ, "PATH": search_path(), "SLURM_CONF": str(self.configuration)}
        self.start("munged", "--foreground", *(f"--{name}={self.folder}/{file}" for name, file in (
            ("key-file", "munge.key"), ("socket", "munge.sock"), ("pid-file", "munged.pid"), ("log-file", "munged.log"),
            ("seed-file", "munge.seed"))))
        self.start_controller()
        for node in NODES:
            self.start_node(node)

    def start(self, name, *arguments, as_name=None):
        with (self.folder / "daemons.txt").open("ab") as log:
            self.daemons[as_name or name] = subprocess.Popen([name, *arguments], env=self.environment, cwd=self.folder,
                                                             stdin=subprocess.DEVNULL, stdout=log, stderr=log)

    def start_controller(self):
        self.start("slurmctld", "-D", "-f", str(self.configuration))

    def start_node(self, node):
        self.start("slurmd", "-D", "-N", node, "-f", str(self.configuration), as_name=node)

    def kill(self, name):
        daemon = self.daemons.pop(name)
        daemon.kill()
        daemon.wait()

    def started(self):
        """Environments of whatever lives and was started with this configuration, by process."""
        processes = {int(entry.name): environment_of(entry.name) for entry in pathlib.Path("/proc").iterdir() if entry.name.isdigit()}
        return {process: environment for process, environment in processes.items()
                if environment.get("SLURM_CONF") == str(self.configuration)}

    def batches(self, node=None, shard=None):
        """Process of the batch script, and those that it has started, of tasks that run."""
        return [process for process, environment in self.started().items()
                if "SLURM_ARRAY_TASK_ID" in environment and node in (None, environment.get("SLURMD_NODENAME"))
                and shard in (None, int(environment["SLURM_ARRAY_TASK_ID"]))]

    def steps_of(self, processes):
        """The slurmstepd of these: parents that are no tasks themselves."""
        return {parent_of(process) for process in processes} - set(processes) - {0, 1}

    def kill_node(self, node):
        self.kill(node)
        processes = self.batches(node=node)
        for process in self.steps_of(processes) | set(processes):
            with contextlib.suppress(ProcessLookupError):
                os.kill(process, signal.SIGKILL)

    def ask(self, *command):
        done = subprocess.run(command, env=self.environment, capture_output=True, text=True, check=False)
        return done.stdout if done.returncode == 0 else ""

    def tasks(self, job):
        """State and node by number of the task."""
        rows = [line.split("|") for line in self.ask("squeue", "-h", "-r", "-t", "all", "-j", job, "-o", "%K|%T|%N|%r").split("\n")]
        return {int(row[0]): row[1:] for row in rows if len(row) == 4 and row[0].isdigit()}

    def stop(self):
        for name in reversed(list(self.daemons)):
            self.kill(name)
        # Steps wait for a controller that does not come back.
        for process in self.started():
            with contextlib.suppress(ProcessLookupError):
                os.kill(process, signal.SIGKILL)
