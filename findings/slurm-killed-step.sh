#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# A batch task whose slurmstepd is killed, as the kernel's out-of-memory killer may do.
# Packages: Debian slurmctld, slurmd, slurm-client 22.05.8-4+deb12u3, munge 0.5.15-2+deb12u1.
# Input: one node without cgroups, a batch job with --requeue that says when it begins and runs until it is let go; its step is killed.
# Guess: with its step the task is gone, or Slurm says that it failed; it is at work once at a time, and its log keeps what it said.
# What happens: the task goes on. Slurm takes it for running for about a minute, then requeues it, and from then on it is at work
#   twice at once. The second one's log begins anew, in the same file: what the first had said is lost (--open-mode=append keeps it).
# Seen:
#   | before the kill: RUNNING, 1 at work, its log has 1 line
#   | after the kill: RUNNING, 1 at work
#   | requeued: PENDING (BeginTime), 1 at work
#   | begun again: RUNNING, 2 at work
#   | what the first said is in the log: no
set -euo pipefail
source "$(dirname "$0")/packages.sh"
installed slurmctld=22.05.8-4+deb12u3 slurmd=22.05.8-4+deb12u3 slurm-client=22.05.8-4+deb12u3 munge=0.5.15-2+deb12u1
PATH=$PATH:/usr/sbin

free_port() { /usr/bin/python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])'; }

chmod 711 "$temp"
mkdir state spool
(umask 077 && head -c 1024 /dev/urandom >munge.key)
cat >slurm.conf <<END
ClusterName=finding
SlurmctldHost=$(hostname)(127.0.0.1)
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthInfo=socket=$temp/munge.sock
StateSaveLocation=$temp/state
SlurmctldPort=$(free_port)
SlurmctldPidFile=$temp/slurmctld.pid
SlurmdPidFile=$temp/slurmd.pid
SlurmdSpoolDir=$temp/spool
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SlurmdTimeout=10
NodeName=n1 NodeHostname=$(hostname) NodeAddr=127.0.0.1 Port=$(free_port) CPUs=2 State=UNKNOWN
PartitionName=short Nodes=n1 Default=YES State=UP
END
echo "CgroupPlugin=cgroup/v1" >cgroup.conf
export SLURM_CONF=$temp/slurm.conf

munged --foreground --key-file="$temp/munge.key" --socket="$temp/munge.sock" --pid-file="$temp/munged.pid" \
  --log-file="$temp/munged.log" --seed-file="$temp/munge.seed" 2>munged.err &
daemons=($!)
slurmctld -D -f "$SLURM_CONF" 2>slurmctld.log &
daemons+=($!)
slurmd -D -N n1 -f "$SLURM_CONF" 2>slurmd.log &
daemons+=($!)
disown -a
# Tasks end by themselves when the folder is gone; their steps would wait for the controller.
end_all() {
  local environment
  kill -9 "${daemons[@]}" 2>/dev/null || true
  for environment in $(grep -lzxF "SLURM_CONF=$SLURM_CONF" /proc/[0-9]*/environ 2>/dev/null); do
    environment=${environment#/proc/}
    [ "${environment%/environ}" = $$ ] || kill -9 "${environment%/environ}" 2>/dev/null || true
  done
  rm -rf "$temp"
}
trap end_all EXIT

until_is() { until [ "$("${@:2}" 2>/dev/null)" = "$1" ]; do sleep 0.2; done; }
state() { squeue -h -j "$job" -o "${1:-%T}"; }
at_work() {
  local beat count=0
  for beat in beat.*; do
    rm -f "$beat"
  done
  sleep 3
  for beat in beat.*; do
    [ ! -e "$beat" ] || count=$((count + 1))
  done
  echo "$count"
}

cat >task.sh <<END
#!/bin/sh
echo "begins as \$\$"
while [ -d $temp/spool ]; do
  touch $temp/beat.\$\$
  sleep 0.5
done
END
until_is idle sinfo -h -o %T
job=$(sbatch --parsable --requeue --output="$temp/log.txt" task.sh)
until_is 1 grep -c begins log.txt
cp log.txt first.txt
seen echo "before the kill: $(state), $(at_work) at work, its log has $(wc -l <log.txt) line"
task=$(sed 's/.* //' first.txt)
kill -9 "$(ps -o ppid= -p "$task" | tr -d ' ')"
seen echo "after the kill: $(state), $(at_work) at work"
until_is "PENDING (BeginTime)" state "%T (%r)"
seen echo "requeued: $(state "%T (%r)"), $(at_work) at work"
scontrol update jobid="$job" starttime=now
until_is RUNNING state
until_is 1 grep -c begins log.txt
seen echo "begun again: $(state), $(at_work) at work"
seen echo "what the first said is in the log: $(grep -qxF "$(cat first.txt)" log.txt && echo yes || echo no)"
finish
