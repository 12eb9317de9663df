# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The character of the studio scene: a wooden artist's figure of turned parts, rigged, subdivided and dancing.

Not a scene of its own; studio.py calls add_mannequin().
"""

import math

import bpy
import numpy as np
import scene_kit as kit
from mathutils import Euler, Matrix, Vector

# bone: parent, head, tail, profile (radius at equal steps from head to tail), depth of the section against its width.
# The figure faces -Y, 1.8 m tall, arms hanging. ".L" is at +X; ".R" is made by mirroring.
kBones = {
    "pelvis": ("", (0, 0, 0.96), (0, 0, 1.10), (0.02, 0.135, 0.15, 0.135, 0.11, 0.02), 0.72),
    "waist": ("pelvis", (0, 0, 1.09), (0, 0, 1.22), (0.02, 0.085, 0.095, 0.095, 0.085, 0.02), 0.8),
    "chest": ("waist", (0, 0, 1.20), (0, 0, 1.50), (0.02, 0.115, 0.145, 0.165, 0.17, 0.15, 0.02), 0.66),
    "neck": ("chest", (0, 0, 1.48), (0, 0, 1.585), (0.02, 0.048, 0.045, 0.048, 0.02), 1.0),
    "head": ("neck", (0, -0.01, 1.56), (0, -0.02, 1.83), (0.01, 0.062, 0.085, 0.1, 0.106, 0.098, 0.01), 1.12),
    "arm.L": ("chest", (0.205, 0, 1.45), (0.245, 0, 1.165), (0.01, 0.052, 0.058, 0.052, 0.045, 0.038, 0.01), 1.0),
    "forearm.L": ("arm.L", (0.245, 0, 1.165), (0.272, 0, 0.925), (0.01, 0.042, 0.046, 0.040, 0.032, 0.026, 0.01), 1.0),
    "hand.L": ("forearm.L", (0.272, 0, 0.925), (0.285, -0.012, 0.745), (0.01, 0.028, 0.043, 0.042, 0.033, 0.01), 0.5),
    "thigh.L": ("pelvis", (0.095, 0, 0.95), (0.105, 0, 0.525), (0.01, 0.085, 0.092, 0.085, 0.074, 0.060, 0.01), 1.05),
    "shin.L": ("thigh.L", (0.105, 0, 0.525), (0.110, 0, 0.095), (0.01, 0.058, 0.066, 0.060, 0.047, 0.038, 0.01), 1.0),
    "foot.L": ("shin.L", (0.110, 0.065, 0.048), (0.115, -0.195, 0.034), (0.01, 0.042, 0.048, 0.052, 0.048, 0.01), 0.75),
}
kJoints = {  # balls between the parts: bone that carries it, its end, radius
    "arm.L": 0.056, "forearm.L": 0.043, "hand.L": 0.028, "thigh.L": 0.078, "shin.L": 0.060, "foot.L": 0.037,
    "waist": 0.088,
}  # fmt: skip

# Turns of the bones in degrees about the figure's own axes (X right, Y back, Z up), against the parent; by frame.
kDance = {
    1: {"pelvis": (16, 0, 12), "waist": (-8, 4, 8), "chest": (-12, -4, 10), "neck": (-8, 0, 6), "head": (-10, 8, 14),
        "arm.L": (-24, -96, 18), "forearm.L": (0, -22, 12), "hand.L": (0, -14, 0),
        "arm.R": (28, 68, 22), "forearm.R": (0, 26, -12), "hand.R": (0, 18, 0),
        "thigh.L": (52, -8, 0), "shin.L": (34, 0, 0), "foot.L": (46, 0, 0),
        "thigh.R": (-17, 3, -6), "shin.R": (1, 0, 0), "foot.R": (0, 0, 0)},
    25: {"pelvis": (6, 0, -14), "waist": (-2, -6, -8), "chest": (-4, 6, -10), "neck": (0, 0, -8), "head": (-4, -6, -14),
         "arm.L": (-70, -38, 0), "forearm.L": (-38, 0, 0), "hand.L": (-10, 0, 0),
         "arm.R": (40, 44, 0), "forearm.R": (-24, 18, 0), "hand.R": (0, 10, 0),
         "thigh.L": (-58, -6, 0), "shin.L": (84, 0, 0), "foot.L": (30, 0, 0),
         "thigh.R": (-6, 3, 4), "shin.R": (1, 0, 0), "foot.R": (0, 0, 0)},
}  # fmt: skip
kPeriodFrames = 48


def mirror_name(name: str) -> str:
    return name[:-2] + ".R" if name.endswith(".L") else name


def all_bones() -> dict[str, tuple]:
    """kBones with the right side added."""
    bones = dict(kBones)
    for name, (parent, head, tail, profile, depth) in kBones.items():
        if name.endswith(".L"):
            flip = np.array([-1, 1, 1])
            bones[mirror_name(name)] = (mirror_name(parent), tuple(flip * head), tuple(flip * tail), profile, depth)
    return bones


def aligned(head, tail) -> Matrix:
    """Frame at `head` with Z along the bone and X kept as near to the figure's X as it can be."""
    axis_z = (Vector(tail) - Vector(head)).normalized()
    axis_y = axis_z.cross(Vector((1, 0, 0))).normalized()
    axis_x = axis_y.cross(axis_z)
    turn = Matrix((axis_x, axis_y, axis_z)).transposed()
    return Matrix.Translation(Vector(head)) @ turn.to_4x4()


def make_part(length: float, profile, depth: float) -> kit.Shape:
    """A closed turned part along +Z from 0 to `length`, of few quads: the subdivision makes it round."""
    unit = kit.ball(6).positions
    share = (unit[:, 2] + 1) / 2
    radius = np.interp(share, np.linspace(0, 1, len(profile)), profile)
    flat = unit[:, :2] / np.maximum(np.hypot(unit[:, 0], unit[:, 1]), 1e-6)[:, None]
    xy = flat * radius[:, None] * np.array([1.0, depth])
    # The two points on the axis and the ring next to them close the ends.
    return kit.Shape(np.column_stack([xy, share * length]), kit.ball(6).faces)


def add_armature(bones: dict[str, tuple], place: Matrix):
    data = bpy.data.armatures.new("Rig")
    rig = kit.add_object("Rig", data, place=place)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    for name, (parent, head, tail, _profile, _depth) in bones.items():
        bone = data.edit_bones.new(name)
        bone.head, bone.tail = head, tail
        if parent:
            bone.parent = data.edit_bones[parent]
    bpy.ops.object.mode_set(mode="OBJECT")
    return rig


def add_body(bones: dict[str, tuple], rig, wood):
    """One mesh of all parts, each weighted to its bone, with armature and subdivision."""
    shapes, owners = [], []
    for name, (parent, head, tail, profile, depth) in bones.items():
        length = (Vector(tail) - Vector(head)).length
        shapes.append(make_part(length, profile, depth).transformed(aligned(head, tail)))
        owners.append(name)
        radius = kJoints.get(name.replace(".R", ".L"))
        if radius:
            joint = bones[parent][2] if name.startswith("foot") else head  # the ankle lies before the heel
            ball = kit.ball(4)
            shapes.append(kit.Shape(ball.positions * radius, ball.faces).moved(joint))
            owners.append(name)
    mesh = kit.new_mesh("Mannequin", kit.joined(shapes), smooth=True)
    body = kit.add_object("Mannequin", mesh, material=wood)
    start = 0
    for shape, owner in zip(shapes, owners, strict=True):
        group = body.vertex_groups.get(owner) or body.vertex_groups.new(name=owner)
        group.add(list(range(start, start + len(shape.positions))), 1.0, "REPLACE")
        start += len(shape.positions)
    body.parent = rig
    body.modifiers.new("Rig", "ARMATURE").object = rig
    smooth = body.modifiers.new("Subdivision", "SUBSURF")
    smooth.levels, smooth.render_levels = 1, 2
    return body


def animate(rig) -> None:
    """Keys the dance; the first pose comes again after the period, so that it loops."""
    poses = [*kDance.items(), (1 + kPeriodFrames, kDance[1])]
    for frame, pose in poses:
        for name, degrees in pose.items():
            bone = rig.pose.bones[name]
            rest = bone.bone.matrix_local.to_3x3()
            turn = Euler([math.radians(d) for d in degrees], "XYZ").to_matrix()
            bone.rotation_mode = "QUATERNION"
            bone.rotation_quaternion = (rest.inverted() @ turn @ rest).to_quaternion()
            bone.keyframe_insert("rotation_quaternion", frame=frame)


def add_mannequin(place: Matrix, wood) -> None:
    """The figure at `place` (feet at its origin), animated over kPeriodFrames frames."""
    bones = all_bones()
    rig = add_armature(bones, place)
    add_body(bones, rig, wood)
    animate(rig)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, kPeriodFrames
    scene.frame_set(1)
