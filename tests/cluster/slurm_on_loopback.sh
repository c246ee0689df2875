#!/usr/bin/env bash
# A real Slurm with one node, this machine, on loopback: to try the profile for clusters and to test
# it.
#
#   sudo tests/cluster/slurm_on_loopback.sh start FOLDER
#   sudo tests/cluster/slurm_on_loopback.sh stop FOLDER
#
# All that it writes is in the folder given: configuration, key, state, sockets, logs. Only the link
# /etc/slurm/slurm.conf is elsewhere, as long as the cluster runs: the executor plug-in takes
# SLURM_CONF out of the environment of its jobs, so no other place is found there.
#
# It needs root and the Debian packages slurmctld, slurmd, slurm-client and munge:
#   apt-get install --no-install-recommends slurmctld slurmd slurm-client munge
# NODE_CPUS and NODE_MEM_MB change what the node says it has. A job that holds more memory than it
# asked for is ended.
set -eu
export PATH=$PATH:/usr/sbin:/sbin

refuse() {
    printf '%s\n' "$1" >&2
    exit 2
}

usage="use: $0 start FOLDER, or $0 stop FOLDER"
[ $# = 2 ] || refuse "$usage"
[ "$(id -u)" = 0 ] || refuse "Slurm's daemons need root, this user is $(id -un): use sudo"
case $2 in
*[!A-Za-z0-9._/-]*) refuse "the folder '$2' has a character that slurm.conf can not hold: use letters, digits, . _ - and /" ;;
esac
mkdir -p "$2"
folder=$(cd "$2" && pwd -P)
configuration=$folder/slurm.conf
cluster=loopback
link=/etc/slurm/slurm.conf
unset SLURM_CONF

needs() { # the packages, a folder whose sockets have names that fit, no other Slurm
    local program
    for program in munged slurmctld slurmd sbatch squeue; do
        command -v "$program" >/dev/null || refuse "there is no $program: apt-get install --no-install-recommends slurmctld slurmd slurm-client munge"
    done
    [ ${#folder} -le 70 ] || refuse "the path $folder is longer than 70 characters: sockets below it would have no valid name"
    ! running slurmctld || refuse "a cluster runs in $folder already: stop it first"
    [ -L "$link" ] && [ ! -e "$link" ] && rm "$link" # its cluster's folder has gone
    [ ! -e "$link" ] || refuse "$link exists: this machine has a Slurm, or one runs in another folder"
}

running() { # NAME: whether the daemon of this folder runs
    [ -s "$folder/$1.pid" ] && kill -0 "$(cat "$folder/$1.pid")" 2>/dev/null
}

free_ports() { # two
    python3 -c 'import socket
sockets = [socket.create_server(("127.0.0.1", 0)) for _ in range(2)]
print(*(one.getsockname()[1] for one in sockets))'
}

write_configuration() {
    local ports cpus memory_MB
    read -r -a ports <<<"$(free_ports)"
    cpus=${NODE_CPUS:-$(getconf _NPROCESSORS_ONLN)}
    memory_MB=${NODE_MEM_MB:-$(awk '/^MemTotal/ {print int($2 / 1024 * 0.9)}' /proc/meminfo)}
    cat >"$configuration" <<END
ClusterName=$cluster
SlurmctldHost=localhost(127.0.0.1)
SlurmctldPort=${ports[0]}
SlurmdPort=${ports[1]}
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket
CryptoType=crypto/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/linux
JobAcctGatherFrequency=1
JobAcctGatherParams=OverMemoryKill,UsePss
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
SchedulerParameters=sched_interval=1,bf_interval=2,batch_sched_delay=0
JobRequeue=0
ReturnToService=2
MinJobAge=300
KillWait=5
SlurmdTimeout=30
SlurmdParameters=config_overrides
MpiDefault=none
StateSaveLocation=$folder/slurmctld
SlurmdSpoolDir=$folder/slurmd
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
PlugStackConfig=$folder/plugstack.conf
NodeName=localhost NodeAddr=127.0.0.1 CPUs=$cpus RealMemory=$memory_MB State=UNKNOWN
PartitionName=main Nodes=ALL Default=YES MaxTime=120 State=UP
END
    : >"$folder/plugstack.conf"
}

start_munge() {
    (umask 077 && head -c 1024 /dev/urandom >"$folder/munge.key")
    munged --force --key-file "$folder/munge.key" --socket "$folder/munge.socket" \
        --pid-file "$folder/munged.pid" --log-file "$folder/munged.log" \
        --seed-file "$folder/munge.seed" --num-threads 2
}

start() {
    needs
    chmod 755 "$folder"
    mkdir -p "$folder/slurmctld" "$folder/slurmd"
    write_configuration
    mkdir -p "$(dirname "$link")"
    ln -s "$configuration" "$link"
    start_munge
    slurmctld
    slurmd -N localhost
    local attempt
    for attempt in $(seq 100); do
        [ "$(sinfo --noheader --format=%T 2>/dev/null)" = idle ] && break
        [ "$attempt" -lt 100 ] || refuse "the node is not idle after 20 s: read $folder/slurmctld.log and slurmd.log"
        sleep 0.2
    done
    printf 'Slurm runs: one node, %s\n' "$(sinfo --noheader --format='%c CPUs, %m MB, partition %P')"
}

processes_of_jobs() { # the ids of what jobs of this cluster still run
    local process
    for process in /proc/[0-9]*; do
        { tr '\0' '\n' <"$process/environ"; } 2>/dev/null |
            grep -qx "SLURM_CLUSTER_NAME=$cluster" && basename "$process"
    done
    return 0
}

stop() {
    local name process daemons=()
    for name in slurmd slurmctld munged; do
        ! running "$name" || daemons+=("$(cat "$folder/$name.pid")")
    done
    [ ${#daemons[@]} = 0 ] || kill "${daemons[@]}"
    for process in $(processes_of_jobs); do # none where every job has ended
        kill -9 "$process" 2>/dev/null || true
    done
    for process in "${daemons[@]}"; do # slurmd may wait for ever for a job that was lost
        timeout 10 tail --pid="$process" -f /dev/null || kill -9 "$process" 2>/dev/null || true
    done
    [ "$(readlink "$link")" != "$configuration" ] || rm "$link"
}

case $1 in
start) start ;;
stop) stop ;;
*) refuse "$usage" ;;
esac
