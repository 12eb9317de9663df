# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The snapshot file: round trip, what a reader of another make sees in it, and what is refused."""

import json
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from addon.snapshot import (
    ALL_GROUPS,
    CameraData,
    Job,
    LightData,
    MeshData,
    RenderSettings,
    SceneSnapshot,
    SnapshotError,
)


def make_snapshot() -> SceneSnapshot:
    rng = np.random.default_rng(3)
    matrices = np.tile(np.eye(4), (3, 1, 1))
    matrices[:, :3, 3] = rng.normal(size=(3, 3))
    return SceneSnapshot(
        camera=CameraData(True, (-1.0, 1.0, -0.5, 0.5), 0.1, 100.0, np.eye(4)),
        render=RenderSettings(64, 32, (4, 2, 20, 10), 8, "GAUSSIAN", 2.0),
        meshes=[
            MeshData("Würfel", rng.normal(size=(8, 3)).astype(np.float32), np.array([[0, 1, 2]], np.uint32)),
            MeshData("empty", np.zeros((0, 3), np.float32), np.zeros((0, 3), np.uint32)),
        ],
        instance_mesh=np.array([0, 0, 1], np.uint32),
        instance_matrix=matrices,
        instance_flags=np.array([3, 1, 4], np.uint32),
        instance_receiver_group=np.array([0, 63, 1], np.uint8),
        instance_blocker_group=np.array([2, 0, 0], np.uint8),
        instance_names=["a", "b", "c"],
        lights=[
            LightData("Key.001", "SPOT", np.eye(4), color=(1.0, 0.5, 0.25), receiver_set=ALL_GROUPS ^ 2, blocker_set=5),
            LightData("Area", "AREA", np.eye(4), area_size=(2.0, 3.0), area_round=True, casts_shadow=False),
        ],
        jobs=[Job(0, "edsm", {"map_size": 512, "softness": 0.5, "reading": "paper", "flag": True}), Job(1, "sm")],
        warnings=["one thing"],
        source={"blender": "4.5", "frame": 7},
    )


def test_round_trip(tmp_path):
    first = make_snapshot()
    path = first.save(tmp_path / "s.npz")
    second = SceneSnapshot.load(path)
    assert second._to_json() == first._to_json()
    for a, b in zip(first.meshes, second.meshes, strict=True):
        np.testing.assert_array_equal(a.positions, b.positions)
        np.testing.assert_array_equal(a.triangles, b.triangles)
    for name in ("mesh", "matrix", "flags", "receiver_group", "blocker_group"):
        a, b = getattr(first, f"instance_{name}"), getattr(second, f"instance_{name}")
        np.testing.assert_array_equal(a, b)
        assert a.dtype == b.dtype
    assert second.triangle_count == 2
    assert second.lights[0].receiver_set == ALL_GROUPS ^ 2
    assert second.camera.window == (-1.0, 1.0, -0.5, 0.5)


def test_file_is_a_plain_numpy_archive(tmp_path):
    path = make_snapshot().save(tmp_path / "s.npz")
    with zipfile.ZipFile(path) as archive:
        document = json.loads(archive.read("snapshot.json"))
    assert document["format"] == "shadow-layers-snapshot"
    assert document["version"] == 1
    assert document["lights"][0]["receiver_set"] == "fffffffffffffffd"
    assert document["render"]["region"] == [4, 2, 20, 10]
    with np.load(path) as arrays:
        assert arrays["mesh_positions_0"].shape == (8, 3)
        assert arrays["instance_matrix"].dtype == np.float64


def test_no_half_file_under_the_final_name(tmp_path, monkeypatch):
    path = make_snapshot().save(tmp_path / "s.npz")
    before = path.read_bytes()
    snapshot = make_snapshot()
    monkeypatch.setattr(np.lib.format, "write_array", lambda *a, **k: (_ for _ in ()).throw(OSError("disk full")))
    with pytest.raises(OSError, match="disk full"):
        snapshot.save(path)
    assert path.read_bytes() == before
    assert [file.name for file in tmp_path.iterdir()] == ["s.npz"]


def rewrite(path: Path, **changes) -> Path:
    """The file with members replaced (None: left out)."""
    with zipfile.ZipFile(path) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    members.update({name.replace("__", "."): data for name, data in changes.items()})
    with zipfile.ZipFile(path, "w") as archive:
        for name, data in members.items():
            if data is not None:
                archive.writestr(name, data)
    return path


def edit_json(path: Path, edit) -> Path:
    with zipfile.ZipFile(path) as archive:
        document = json.loads(archive.read("snapshot.json"))
    edit(document)
    return rewrite(path, snapshot__json=json.dumps(document))


@pytest.mark.parametrize(
    ("damage", "text"),
    [
        (lambda p: edit_json(p, lambda d: d.update(version=9)), "9.*newer"),
        (lambda p: edit_json(p, lambda d: d.update(format="other")), "format is"),
        (lambda p: rewrite(p, snapshot__json=None), "snapshot.json is missing"),
        (lambda p: rewrite(p, mesh_triangles_0__npy=None), "mesh_triangles_0.npy is missing"),
        (lambda p: rewrite(p, instance_flags__npy=b"\x93NUMPY"), "not a whole snapshot"),
        (lambda p: p.write_bytes(p.read_bytes()[:200]), "not a whole snapshot"),
        (lambda p: edit_json(p, lambda d: d["jobs"][0].update(light=5)), "job 0 names light 5"),
        (lambda p: edit_json(p, lambda d: d["lights"][0].update(kind="HEMI")), "HEMI"),
        (lambda p: edit_json(p, lambda d: d["render"].update(filter="TENT")), "TENT"),
        (lambda p: edit_json(p, lambda d: d["meshes"].pop()), "names mesh 1"),
        (lambda p: edit_json(p, lambda d: d["instances"].pop()), "instance names"),
    ],
)
def test_damaged_files_are_refused_by_name(tmp_path, damage, text):
    path = make_snapshot().save(tmp_path / "s.npz")
    damage(path)
    with pytest.raises(SnapshotError, match=text):
        SceneSnapshot.load(path)


def test_wrong_arrays_are_refused_before_writing(tmp_path):
    snapshot = make_snapshot()
    snapshot.instance_matrix = snapshot.instance_matrix.astype(np.float32)
    with pytest.raises(SnapshotError, match=r"instance_matrix must be float64 \(3, 4, 4\)"):
        snapshot.save(tmp_path / "s.npz")
    assert not list(tmp_path.iterdir())


def test_missing_file_is_an_os_error(tmp_path):
    with pytest.raises(OSError, match=r"nowhere\.npz"):
        SceneSnapshot.load(tmp_path / "nowhere.npz")


def test_not_finite_vertices_survive(tmp_path):
    snapshot = make_snapshot()
    snapshot.meshes[0].positions[0] = (np.nan, np.inf, -np.inf)
    loaded = SceneSnapshot.load(snapshot.save(tmp_path / "s.npz"))
    np.testing.assert_array_equal(loaded.meshes[0].positions, snapshot.meshes[0].positions)
