"""Writes docs/odd_files.md: what readers of motion capture make of odd and broken files, one process a file and reader.

    python odd_files.py CAPTURES/odd PROGRAM PEER > docs/odd_files.md

PROGRAM is `cotillion`, PEER is `cotillion-readers` of benches/readers. Needs pybvh, bvhio and bpy (Blender as a module) in the
Python that runs it; readers that are not there are left out. A reader that takes longer than 30 s hangs.
"""

import importlib.util
import json
import subprocess
import sys
from pathlib import Path

SECONDS = 30
NOTE = 70  # Characters of a warning that are shown.
MEGABYTES = 4000  # Address space of a reader, so that one that believes a header does not take the machine with it.

PYBVH = """
import sys, numpy, pybvh
b = pybvh.read_bvh_file(sys.argv[1])
bad = not (numpy.isfinite(b.joint_angles).all() and numpy.isfinite(b.root_pos).all())
print(f"{len([n for n in b.nodes if not n.is_end_site()])} joints, {b.frame_count} frames" + (", NaN or infinity" if bad else ""))
"""
BVHIO = """
import sys, math, bvhio
b = bvhio.readAsBvh(sys.argv[1])
joints = [j for j, *_ in b.Root.layout()]
bad = any(not math.isfinite(x) for j in joints for k in j.Keyframes for x in (*k.Position, *k.Rotation))
print(f"{len(joints)} joints, {b.FrameCount} frames" + (", NaN or infinity" if bad else ""))
"""
BLENDER = """
import sys, math, bpy
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_anim.bvh(filepath=sys.argv[1], update_scene_fps=True, update_scene_duration=True)
body = bpy.context.object
action = body.animation_data.action
curves = [c for layer in action.layers for s in layer.strips for bag in s.channelbags for c in bag.fcurves]
frames = max((len(c.keyframe_points) for c in curves), default=0)
bad = any(not math.isfinite(k.co[1]) for c in curves for k in c.keyframe_points)
print(f"{len(body.data.bones)} joints, {frames} frames" + (", NaN or infinity" if bad else ""))
"""


def readers(program, peer):
    """Name and command of each reader that is there."""
    yield "cotillion", [program, "inspect", "--json"]
    for name, module, code in [("pybvh", "pybvh", PYBVH), ("bvhio", "bvhio", BVHIO), ("Blender", "bpy", BLENDER)]:
        if importlib.util.find_spec(module):
            yield name, [sys.executable, "-c", code]
    yield "bvh_anim", [peer, "--try"]


def verdict(name, command, file):
    """What one reader makes of one file, in a few words."""
    limited = ["prlimit", f"--as={MEGABYTES * 1_000_000}", *command, str(file)]
    try:
        done = subprocess.run(limited, capture_output=True, text=True, timeout=SECONDS, errors="replace")
    except subprocess.TimeoutExpired:
        return "**hangs**"
    if done.returncode < 0 or "panicked" in done.stderr:
        return "**crashes**"
    if name == "cotillion":
        return ours(done)
    if done.returncode != 0:
        return "**out of memory**" if "MemoryError" in done.stderr else "refuses"
    return f"reads {done.stdout.strip().splitlines()[-1]}"


def ours(done):
    if done.returncode != 0:
        fault = json.loads(done.stderr)[0]
        return f"refuses: line {fault['line']}, column {fault['column']}: {fault['message'].split(';')[0]}"
    facts = json.loads(done.stdout)[0]
    notes = [warning.split(";")[0] for warning in facts["warnings"] if not warning.startswith("unit guessed")]
    short = [note if len(note) <= NOTE else note[:NOTE].rsplit(" ", 1)[0] + " …" for note in notes]
    return f"reads {facts['joints']} joints, {facts['frames']} frames" + "".join(f"; {note}" for note in short)


def main():
    folder, program, peer = sys.argv[1:]
    files = sorted(path for path in Path(folder).iterdir() if path.suffix == ".bvh")
    rows = list(readers(program, peer))
    print(__doc__.split("\n")[0].replace("Writes docs/odd_files.md: what", "# What").split(",")[0] + "\n")
    print(
        "Written by `scripts/odd_files.py` on a folder of odd and broken BVH files. 'Reads' without a remark where the\n"
        "file is broken means that nobody is told. Every reader ran on every file in a process of its own.\n"
    )
    print("| file | " + " | ".join(name for name, _ in rows) + " |")
    print("|---" * (len(rows) + 1) + "|")
    for file in files:
        cells = [verdict(name, command, file).replace("|", "\\|") for name, command in rows]
        print(f"| `{file.stem}` | " + " | ".join(cells) + " |", flush=True)


main()
