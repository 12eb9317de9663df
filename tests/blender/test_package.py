# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The packages: what is in them, and that a user can install, use and remove them."""

import json
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import bpy
import pytest

kModern = bpy.app.version >= (4, 2, 0)


@pytest.fixture(scope="session")
def packages(project_root, tmp_path_factory) -> dict[str, Path]:
    """Both zips, made from the tree by scripts/package.py."""
    out = tmp_path_factory.mktemp("packages")
    # Debian's Blender has no interpreter of its own to name: the system's is the one it was built with.
    python = sys.executable if Path(sys.executable).name.startswith("python") else "python3"
    subprocess.run([python, project_root / "scripts" / "package.py", "--out", out], check=True)
    found = sorted(out.iterdir())
    assert len(found) == 2
    legacy = next(path for path in found if "blender-3.4" in path.name)
    return {"legacy": legacy, "extension": next(path for path in found if path != legacy)}


def product_version(root: Path) -> str:
    return re.search(r"VERSION (\d+\.\d+\.\d+)", (root / "CMakeLists.txt").read_text())[1]


def test_packages_hold_what_the_add_on_needs_and_nothing_else(packages):
    for kind, path in packages.items():
        names = zipfile.ZipFile(path).namelist()
        prefix = "shadow_layers/" if kind == "legacy" else ""
        assert all(name.startswith(prefix) for name in names)
        inside = {name[len(prefix) :] for name in names}
        assert {"__init__.py", "LICENSE", "engine.py", "batch.py", "compare/measures.py"} <= inside
        assert any(name.startswith("native/shadow_core") for name in inside)
        assert "shaders/shared/conventions.h" in inside
        assert ("blender_manifest.toml" in inside) == (kind == "extension")
        assert not [name for name in inside if "__pycache__" in name or name.endswith((".pyc", ".blend", ".pyi"))]


def test_version_is_the_same_everywhere(packages, project_root):
    version = product_version(project_root)
    manifest = zipfile.ZipFile(packages["extension"]).read("blender_manifest.toml").decode()
    assert re.search(r'^version = "([^"]+)"', manifest, re.M)[1] == version
    source = zipfile.ZipFile(packages["legacy"]).read("shadow_layers/__init__.py").decode()
    numbers = re.search(r'"version": \(([^)]*)\)', source)[1]
    assert ".".join(part.strip() for part in numbers.split(",")) == version
    assert all(version in path.name for path in packages.values())


def test_same_sources_give_the_same_bytes(packages, project_root, tmp_path):
    python = sys.executable if Path(sys.executable).name.startswith("python") else "python3"
    subprocess.run([python, project_root / "scripts" / "package.py", "--out", tmp_path], check=True)
    for path in packages.values():
        assert (tmp_path / path.name).read_bytes() == path.read_bytes()


def test_package_installs_renders_and_goes_again(packages, project_root, run_script, scene_file, tmp_path):
    package = packages["extension" if kModern else "legacy"]
    user = tmp_path / "user"
    env = {
        "BLENDER_USER_RESOURCES": str(user),
        "BLENDER_USER_CONFIG": str(user / "config"),
        "BLENDER_USER_SCRIPTS": str(user / "scripts"),
        "BLENDER_USER_EXTENSIONS": str(user / "extensions"),
        "SHADOW_LAYERS_NATIVE": "",  # neither module nor shaders of the tree
        "SHADOW_LAYERS_SHADERS": "",
        "PYTHONPATH": "",
    }
    for folder in ("config", "scripts/addons", "extensions"):
        (user / folder).mkdir(parents=True)
    out = tmp_path / "found.json"
    script = project_root / "tests" / "blender" / "package_user.py"
    run_script(script, [str(package), str(scene_file("box")), str(out)], env=env)
    found = json.loads(out.read_text(encoding="utf-8"))
    assert found["enabled"] and not found["errors"]
    for place in ("folder", "module", "shaders"):
        assert Path(found[place]).is_relative_to(user), f"{place} comes from {found[place]}"
    assert 0.02 < found["shadow_share"] < 0.6
    assert len(found["passes"]) == 1 and "Key" in found["passes"][0]
    assert not found["enabled_after"] and not found["engine_after"] and not found["files_after"]
