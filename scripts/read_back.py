"""Checks the result of a scene from its BVH files alone, read by an independent reader (pybvh).

    python read_back.py SCENE RESULT_FOLDER

SCENE is the scene file (TOML; groups are written out here, too), or JSON with the same tables. Of its hard constraints those
given as numbers are looked at: pins, places and facings relative to characters or objects, times, durations and synchronised
moments, as they are after the drags of the scene. What holds as before the edit is looked at where both perform one BVH clip
each of known unit, whose file is read as well. Where objects that move are comes from the animation in scene.glb, whose
numbers are single precision. When a moment happens comes from report.json, as does what concerns times only. Where a moment
falls on an output frame, places must hold to 1e-6 m and facings to 1e-4 degrees; where it falls between two, the four frames
around it are interpolated, and the tolerances MID_... hold.

Prints a line per check and a summary. Exit code 1 when a check fails, when there was nothing to check, and when places are
held but none could be looked at.
"""

import json
import os
import re
import sys
import tomllib
from pathlib import Path

import numpy as np
import pybvh

PLACE_TOLERANCE = 1e-6  # metres; files carry ten decimals
FACING_TOLERANCE = 1e-4  # degrees
# Beside objects that move: places are single precision, on stages of tens of metres.
GLB_PLACE_TOLERANCE = 1e-5
GLB_FACING_TOLERANCE = 1e-3
TIME_TOLERANCE = 1e-9  # seconds
# Between frames, of what a cubic through four frames at 30 fps misses in quick motion.
MID_PLACE_TOLERANCE = 5e-3
MID_FACING_TOLERANCE = 0.5
# A moment this near a frame is on it: a body at 10 m/s moves less than the tolerance meanwhile.
FRAME_TOLERANCE = 1e-6

METRES = {"m": 1.0, "cm": 0.01, "inch": 0.0254}

# Thigh joints by name, in any of the usual spellings: LeftUpLeg, Character1_LeftUpLeg, lThigh, lfemur, left_hip.
THIGH = re.compile(r"(?:^|[^a-z])(left|right|l|r)[_. -]?(upleg|upperleg|thigh|femur)$")
HIP = re.compile(r"(?:^|[^a-z])(left|right|l|r)[_. -]?(hip)$")


def plan(points):
    """Ground plan `x - i z` of world points with y up."""
    return points[..., 0] - 1j * points[..., 2]


def thighs(names):
    """Columns of the left and the right thigh joint."""
    for pattern in (THIGH, HIP):
        found = {}
        for column, name in enumerate(names):
            if match := pattern.search(name.lower()):
                found.setdefault(match[1][0], column)
        if len(found) == 2:
            return found["l"], found["r"]
    raise ValueError(f"no hips among {', '.join(names)}")


def between(track, frame):
    """What a track has between two frames: the cubic through the four around it."""
    first = min(max(int(np.floor(frame)) - 1, 0), len(track) - 4)
    nodes = np.arange(first, first + 4)
    weights = [np.prod([(frame - m) / (n - m) for m in nodes if m != n]) for n in nodes]
    return np.asarray(weights) @ track[nodes]


class Objects:
    """Places and facings of the objects that move, frame by frame, from the animation of a GLB file."""

    TYPES = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}

    def __init__(self, path, fps):
        data = path.read_bytes()
        length = int.from_bytes(data[12:16], "little")
        self.document = json.loads(data[20 : 20 + length])
        self.buffer = data[28 + length :]
        self.tracks = {}
        for animation in self.document.get("animations", []):
            for channel in animation["channels"]:
                target, sampler = channel["target"], animation["samplers"][channel["sampler"]]
                name = self.document["nodes"][target["node"]].get("name")
                if target["path"] in ("translation", "rotation"):
                    # Keyframes are left out only between equal ones.
                    keys = np.rint(self.rows(sampler["input"])[:, 0] * fps).astype(int)
                    latest = np.searchsorted(keys, np.arange(keys[-1] + 1), side="right") - 1
                    self.tracks.setdefault((name, target["path"]), self.rows(sampler["output"])[latest])

    def rows(self, index):
        accessor = self.document["accessors"][index]
        view = self.document["bufferViews"][accessor["bufferView"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        width = self.TYPES[accessor["type"]]
        values = np.frombuffer(self.buffer, "<f4", accessor["count"] * width, start)
        return values.reshape(-1, width).astype(float)

    def stance(self, name, frame):
        """Place and facing (a unit number) at a frame, which may lie between two."""
        places, turns = self.tracks[name, "translation"], self.tracks[name, "rotation"]
        # About +y: e^{i facing} = (w + i y)^2.
        track = np.stack([plan(places), (turns[:, 3] + 1j * turns[:, 1]) ** 2], axis=1)
        nearest = round(frame)
        if abs(frame - nearest) < FRAME_TOLERANCE:
            place, ahead = track[min(nearest, len(track) - 1)]
        else:
            place, ahead = between(track, frame)
        return place, ahead / abs(ahead)


class Performer:
    """Positions of root and hips in one file, frame by frame, in metres."""

    def __init__(self, path, unit=1.0):
        bvh = pybvh.read_bvh_file(path, world_up="+y")
        joints = bvh.joint_positions()
        left, right = thighs(bvh.joint_names)
        self.fps = 1.0 / bvh.frame_time
        self.frame_count = bvh.frame_count
        self.track = np.stack([plan(bvh.root_pos), plan(joints[:, left]), plan(joints[:, right])], axis=1) * unit

    def stance(self, frame):
        """Place and facing (a unit number) at a frame, which may lie between two."""
        nearest = round(frame)
        if abs(frame - nearest) < FRAME_TOLERANCE:
            root, left, right = self.track[nearest]
        else:
            root, left, right = between(self.track, frame)
        ahead = -1j * (left - right)
        return root, ahead / abs(ahead)


class ReadBack:
    """Checks of one result and how they went."""

    def __init__(self, scene, scene_folder, folder):
        self.scene, self.scene_folder = scene, scene_folder
        self.report = json.loads((folder / "report.json").read_text())
        self.times = {moment["name"]: moment["time"] for moment in self.report["moments"]}
        self.passed = self.failed = self.unchecked = self.places = 0
        self.performers, self.sources = {}, {}
        self.objects = Objects(folder / "scene.glb", self.report["fps"]) if scene.get("object") else None
        files = [name for name in self.report["files"] if name.endswith(".bvh")]
        for told, name in zip(self.report["characters"], files, strict=True):
            performer = Performer(folder / name)
            self.performers[told["name"]] = performer
            if performer.frame_count != told["frames_out"] or abs(performer.fps - self.report["fps"]) > 1e-6:
                self.tell(False, f"{name}: {performer.frame_count} frames at {performer.fps} fps, not as reported")
        names = [character["name"] for character in scene.get("character", [])]
        if names != list(self.performers):
            self.tell(False, f"characters {names}, but files of {list(self.performers)}")

    def tell(self, good, text):
        self.passed += good
        self.failed += not good
        print(f"{'ok    ' if good else 'FAILED'} {text}")

    def leave(self, text):
        self.unchecked += 1
        print(f"left   {text}")

    def holds(self, label, error, tolerance, unit):
        self.tell(bool(error <= tolerance), f"{label}: {error:.1e} {unit}, at most {tolerance:.0e}")

    def moment(self, name):
        """Stance at a moment and whether that is on a frame; None where the file shows no such instant."""
        performer = self.performers[re.split("[/:]", name)[0]]
        frame = (self.times[name] - self.report["start_time"]) * self.report["fps"]
        if -FRAME_TOLERANCE < frame < performer.frame_count - 1 + FRAME_TOLERANCE:
            return *performer.stance(frame), abs(frame - round(frame)) < FRAME_TOLERANCE
        if not -1 < frame < performer.frame_count:
            self.tell(False, f"{name} is at frame {frame} of {performer.frame_count}")
        return None

    def place(self, label, error, on_frame, tolerance=PLACE_TOLERANCE):
        self.places += 1
        tolerance = tolerance if on_frame else MID_PLACE_TOLERANCE
        self.holds(f"{label}, place{'' if on_frame else ' between frames'}", abs(error), tolerance, "m")

    def facing(self, label, found, wanted_degrees, on_frame, tolerance=FACING_TOLERANCE):
        self.places += 1
        tolerance = tolerance if on_frame else MID_FACING_TOLERANCE
        error = abs(np.degrees(np.angle(found * np.exp(-1j * np.radians(wanted_degrees)))))
        self.holds(f"{label}, facing{'' if on_frame else ' between frames'}", error, tolerance, "deg")

    def pin(self, name, pin):
        for at in instants(pin):
            label = f"{name} at {at}"
            stance = self.moment(at)
            if stance is None:
                self.leave(f"{label}: beyond the frames of the file")
                continue
            root, ahead, on_frame = stance
            if "position" in pin:
                self.place(label, root - complex(*pin["position"]), on_frame)
            if "facing" in pin:
                self.facing(label, ahead, pin["facing"], on_frame)

    def relative(self, name, relative):
        if self.scene.get("mode") == "paper":
            self.leave(f"{name}: offsets of paper mode are others")
            return
        partners = relative["to"] if isinstance(relative["to"], list) else [relative["to"]]
        moments = instants(relative)
        for at, to in zip(moments, partners if len(partners) == len(moments) else partners * len(moments)):
            label = f"{name} at {at} to {to}"
            stance, partner = self.moment(at), self.partner(to, at)
            tolerances = (PLACE_TOLERANCE, FACING_TOLERANCE)
            if self.moves(to):
                tolerances = (GLB_PLACE_TOLERANCE, GLB_FACING_TOLERANCE)
            if stance is None or partner is None:
                self.leave(f"{label}: no frame shows it")
                continue
            offset, facing = self.wanted(relative, at, to)
            if offset is None and facing is None:
                self.leave(f"{label}: not given in numbers")
            on_frame = stance[2] and partner[2]
            if offset is not None:
                self.place(label, (stance[0] - partner[0]) / partner[1] - offset, on_frame, tolerances[0])
            if facing is not None:
                self.facing(label, stance[1] / partner[1], facing, on_frame, tolerances[1])

    def wanted(self, relative, at, to):
        """Offset and facing (degrees) that a relative constraint holds; None for what is free or not known here."""
        offset, facing = relative.get("offset", "rest"), relative.get("facing", "free")
        if "rest" in (offset, facing):
            own, partner = self.rest(at), self.rest(to)
            known = own is not None and partner is not None
            if offset == "rest":
                offset = (own[0] - partner[0]) / partner[1] if known else None
            if facing == "rest":
                facing = np.degrees(np.angle(own[1] / partner[1])) if known else None
        if isinstance(offset, list):
            offset = complex(*offset)
        return None if offset == "free" else offset, None if facing == "free" else facing

    def rest(self, moment):
        """Stance at a moment before the edit, from the source; None unless that is one BVH file of known unit, unplaced."""
        performer, when = moment.split(":")
        character = next((c for c in self.scene["character"] if c["name"] == performer.split("/")[0]), None)
        if character is None or len(character["track"]) != 1 or "position" in character or "facing" in character:
            return None
        clip = self.scene["clips"][character["track"][0]]
        named = {"file", "frames", "unit"} <= set(clip) if isinstance(clip, dict) else False
        if not named or not clip["file"].endswith(".bvh") or clip.get("up") != "y":
            return None
        frames = dict(zip(("start", "end"), clip["frames"])) | clip.get("events", {})
        frame = frames[when] if when in frames else int(when) if when.isdigit() else None
        unit = METRES.get(clip["unit"], clip["unit"])
        return None if frame is None else self.source(clip["file"], unit).stance(frame)

    def source(self, name, unit):
        if name not in self.sources:
            inside = name.removeprefix("mocap:")
            if inside != name and "COTILLION_MOCAP" not in os.environ:
                sys.exit(f"{name}: $COTILLION_MOCAP is not set")
            folder = self.scene_folder if inside == name else Path(os.environ["COTILLION_MOCAP"])
            self.sources[name] = Performer(folder / inside, unit)
        return self.sources[name]

    def moves(self, name):
        """Whether this is an object that is carried or goes by keys."""
        things = [thing for thing in self.scene.get("object", []) if thing["name"] == name]
        carried = any(carry["object"] == name for carry in self.scene.get("carry", []))
        return any(carried or "keys" in thing for thing in things)

    def partner(self, to, at):
        """Stance of whom or what a constraint is relative to, at a moment."""
        for thing in self.scene.get("object", []):
            if thing["name"] == to and self.moves(to):
                frame = (self.times[at] - self.report["start_time"]) * self.report["fps"]
                return *self.objects.stance(to, frame), abs(frame - round(frame)) < FRAME_TOLERANCE
            if thing["name"] == to:
                return complex(*thing["position"]), np.exp(1j * np.radians(thing.get("facing", 0.0))), True
        return self.moment(to)

    def time(self, name, time):
        self.holds(f"{name} at {time['at']}", abs(self.times[time["at"]] - time["seconds"]), TIME_TOLERANCE, "s")

    def duration(self, name, duration):
        found = self.times[duration["to"]] - self.times[duration["from"]]
        self.holds(f"{name} to {duration['to']}", abs(found - duration["seconds"]), TIME_TOLERANCE, "s")

    def sync(self, name, sync):
        groups = [sync["moments"]] if "moments" in sync else list(zip(*sync["intervals"]))
        for first, *others in groups:
            for other in others:
                error = abs(self.times[first] - self.times[other] - sync.get("offset", 0.0))
                self.holds(f"{name} of {first} and {other}", error, TIME_TOLERANCE, "s")

    def run(self):
        places_held = False
        for kind in ("pin", "relative", "time", "duration", "sync"):
            for index, constraint in enumerate(self.scene.get(kind, [])):
                if constraint.get("strength") == "hard":
                    places_held |= kind in ("pin", "relative")
                    getattr(self, kind)(constraint.get("name", f"{kind}[{index}]"), constraint)
        if places_held and self.places == 0:
            self.tell(False, "places are held, but none could be looked at")
        if self.passed + self.failed == 0:
            self.tell(False, "nothing to check: no hard constraint is given in numbers")


def instants(constraint):
    """The moments at which a constraint is looked at: its own, or both ends of its interval."""
    return [constraint["at"]] if "at" in constraint else list(constraint["during"])


PLACEHOLDER = re.compile(r"\{\{|\}\}|\{([^{}]*)\}")
EXPRESSION = re.compile(r"(?:(-?[\d.]+)\s*\*\s*)?([^\W\d_]\w*)(?:\s*\*\s*(-?[\d.]+))?(?:\s*([+-])\s*([\d.]+))?")


def number(text):
    return float(text) if "." in text else int(text)


def reckoned(expression, row):
    """What a placeholder stands for in a row: a value of it, perhaps times a number, plus or minus a number."""
    before, name, after, sign, amount = EXPRESSION.fullmatch(expression.strip()).groups()
    value = row[name]
    for factor in (before, after):
        value = value * number(factor) if factor else value
    return value + number(sign + amount) if sign else value


def filled(template, row):
    """A template of a group for one row."""
    if isinstance(template, dict):
        return {filled_text(key, row): filled(value, row) for key, value in template.items()}
    if isinstance(template, list):
        return [filled(value, row) for value in template]
    if not isinstance(template, str):
        return template
    alone = PLACEHOLDER.fullmatch(template)
    return reckoned(alone[1], row) if alone and alone[1] is not None else filled_text(template, row)


def filled_text(text, row):
    brace = {"{{": "{", "}}": "}"}
    return PLACEHOLDER.sub(lambda match: brace.get(match[0]) or str(reckoned(match[1], row)), text)


def merge(scene, piece):
    """Adds tables to a scene: lists go on, tables get further keys."""
    for key, value in piece.items():
        if key not in scene:
            scene[key] = value
        elif isinstance(value, list):
            scene[key] += value
        else:
            merge(scene[key], value)


def write_out(scene):
    """Replaces the groups of a scene by what they stand for."""
    for group in scene.pop("group", []):
        keys = group.pop("keys", [])
        rows = group.pop("rows", None) or [[]] * group.pop("count")
        for index, row in enumerate(rows):
            merge(scene, filled(group, dict(zip(keys, row), i=index + 1)))


def drag(scene):
    """Moves the targets of constraints to where the scene's drags end."""
    tables = {
        table.get("name", f"{kind}[{index}]"): table
        for kind in ("pin", "relative", "time", "duration", "sync")
        for index, table in enumerate(scene.get(kind, []))
    }
    for pull in scene.get("drag", []):
        ends = {"position": "to", "facing": "facing", "offset": "offset", "seconds": "seconds"}
        ends = {key: pull[end] for key, end in ends.items() if end in pull}
        named = tables.get(pull["handle"])
        if named is not None and "moments" in named:
            ends = {"offset": ends["seconds"]}
        for table in [named] if named is not None else scene.get("pin", []) + scene.get("time", []):
            if named is not None or table.get("at") == pull["handle"]:
                table |= {key: end for key, end in ends.items() if key in table or named is not None}


def main():
    if len(sys.argv) != 3:
        print("usage: read_back.py SCENE RESULT_FOLDER", file=sys.stderr)
        return 2
    path, folder = map(Path, sys.argv[1:])
    scene = json.loads(path.read_text()) if path.suffix == ".json" else tomllib.loads(path.read_text())
    write_out(scene)
    drag(scene)
    checks = ReadBack(scene, path.parent, folder)
    checks.run()
    print(f"{checks.passed} passed, {checks.failed} failed" + (f", {checks.unchecked} left" if checks.unchecked else ""))
    return 1 if checks.failed else 0


if __name__ == "__main__":
    sys.exit(main())
