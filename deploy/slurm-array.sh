#!/bin/bash
# Extraction as a Slurm array: every task writes one shard.
#
#   sbatch --array=1-64 deploy/slurm-array.sh /shared/rows /shared/scenes/*.toml
#
# The shards together are one dataset, whose hash is that of a run of one process. Tasks that failed are submitted again by
# their numbers: sbatch --array=7,31 … with SHARDS=64 set, so that the number of shards stays what it was.
#SBATCH --job-name=peelnet-extract
#SBATCH --cpus-per-task=4
#SBATCH --mem=8G
#SBATCH --time=02:00:00
#SBATCH --output=%x-%A-%a.log
#SBATCH --requeue
# With GPUs: add --gpus=1, and set ADAPTER to a part of the adapter's name.

set -euo pipefail

if (($# < 2)); then
    echo "usage: sbatch --array=1-N $0 DATASET SCENE…" >&2
    exit 2
fi
out=$1
shift
shards=${SHARDS:-$SLURM_ARRAY_TASK_COUNT}
adapter=${ADAPTER:-software}

# Threads of the software rasteriser and of everything else.
export LP_NUM_THREADS=$SLURM_CPUS_PER_TASK RAYON_NUM_THREADS=$SLURM_CPUS_PER_TASK
# Where Vulkan's loader finds no folder of a user's session, as on a compute node.
export XDG_RUNTIME_DIR=${XDG_RUNTIME_DIR:-${TMPDIR:-/tmp}}

exec srun peelnet extract "$@" --out "$out" --shard "$SLURM_ARRAY_TASK_ID/$shards" --adapter "$adapter" --seed "${SEED:-1}"
