#!/usr/bin/env python3
"""Runs a scene in shards on a Dask cluster and merges them: farm.py SCENE -o FOLDER [--shards N] [--scheduler ADDRESS].

Without an address it starts Dask's local cluster: one worker a core. Workers need the program and the scene (with its
clips) at the same paths, and the folder of the result. Other farms do the same three things: see docs/many_characters.md.
"""

import argparse
import os
import pathlib
import shutil
import subprocess
import sys

from dask.distributed import Client, LocalCluster, as_completed


def run_shard(program, scene, folder, number, of, options):
    """Makes shard `number` of `of`, one thread a shard; returns the folder it is in."""
    made = f"{folder}/shard-{number}-of-{of}"
    command = [program, "run", scene, "-o", made, "--shard", f"{number}/{of}", "--quiet", *options]
    threads = os.environ | {"RAYON_NUM_THREADS": "1"}
    done = subprocess.run(command, capture_output=True, text=True, env=threads)
    if done.returncode != 0:
        raise RuntimeError(f"shard {number} of {of}: {done.stderr.strip()}")
    return made


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene")
    parser.add_argument("-o", "--output", required=True, help="folder of the result")
    parser.add_argument("--shards", type=int, default=os.cpu_count(), help="into how many; as many as cores")
    parser.add_argument("--scheduler", help="address of a Dask scheduler; left out, a local cluster is started")
    parser.add_argument("--cotillion", default="cotillion", help="the program")
    parser.add_argument("options", nargs="*", help="options of `cotillion run`, after --")
    args = parser.parse_args()
    program = shutil.which(args.cotillion)
    if program is None:
        sys.exit(f"{args.cotillion} is no program")
    scene, output = (str(pathlib.Path(path).resolve()) for path in (args.scene, args.output))
    work = f"{output}.shards"
    cluster = args.scheduler or LocalCluster(
        n_workers=os.cpu_count(), threads_per_worker=1, dashboard_address=None
    )
    with Client(cluster) as client:
        of = range(1, args.shards + 1)
        jobs = [client.submit(run_shard, program, scene, work, n, args.shards, args.options, pure=False) for n in of]
        made = []
        for job in as_completed(jobs):
            made.append(job.result())
            print(f"{len(made)} of {args.shards} shards", flush=True)
    subprocess.run([program, "merge", *sorted(made), "-o", output], check=True)
    shutil.rmtree(work)


if __name__ == "__main__":
    main()
