# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixtures of the Blender suite. The same test files run in every supported Blender, inside its own process."""

import importlib
import json
import os
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import bpy
import pytest

root = Path(__file__).resolve().parent.parent.parent
module_dir = Path(os.environ.get("SHADOW_LAYERS_BUILD", root / "build" / "release")).resolve() / "python"
os.environ["SHADOW_LAYERS_NATIVE"] = str(module_dir)  # where the add-on looks first; processes started here inherit it
for folder in (root, module_dir):
    if str(folder) not in sys.path:
        sys.path.insert(0, str(folder))

is_wheel = not bpy.app.binary_path  # Blender as a Python module has no executable


def pytest_sessionstart(session: pytest.Session) -> None:
    if not list(module_dir.glob("shadow_core*.so")):
        pytest.exit(f"no native module in {module_dir}: run `make build` first, or set SHADOW_LAYERS_BUILD", 3)


def pytest_report_header(config: pytest.Config) -> str:
    return f"Blender {bpy.app.version_string} ({'module' if is_wheel else bpy.app.binary_path})"


@pytest.fixture(scope="session")
def project_root() -> Path:
    return root


@pytest.fixture(scope="session")
def native_module_dir() -> Path:
    """Folder that holds the built shadow_core."""
    return module_dir


@pytest.fixture(scope="session")
def blender_version() -> tuple[int, int, int]:
    return tuple(bpy.app.version)


@pytest.fixture(scope="session")
def addon():
    """The add-on, imported from the tree as package `addon` and registered for the whole session."""
    package = importlib.import_module("addon")
    package.register()
    yield package
    package.unregister()


@pytest.fixture
def fresh_scene(addon) -> bpy.types.Scene:
    """An empty factory file, with the add-on registered and its engine chosen; 64 x 36 pixels, standard view."""
    new_file()
    scene = bpy.context.scene
    scene.render.engine = "SHADOW_LAYERS"
    scene.render.resolution_x, scene.render.resolution_y = 64, 36
    scene.render.resolution_percentage = 100
    return scene


def new_file() -> None:
    """An empty file with factory settings; keeps registered classes and add-ons."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    scene.view_settings.view_transform = "Standard"
    scene.cycles.use_denoising = False


@pytest.fixture(scope="session")
def scene_file(tmp_path_factory) -> Callable[..., Path]:
    """scene_file("jenga", "--option", "value") builds a scene of test_scenes/ once a session and returns its .blend."""
    folder = tmp_path_factory.mktemp("scenes")
    made: dict[tuple[str, ...], Path] = {}

    def build(name: str, *options: str) -> Path:
        key = (name, *options)
        if key not in made:
            path = folder / f"{name}_{len(made)}.blend"
            run_blender(root / "test_scenes" / f"{name}.py", [str(path), *options], timeout_s=240)
            made[key] = path
        return made[key]

    return build


@pytest.fixture
def open_scene(addon, scene_file) -> Callable[..., bpy.types.Scene]:
    """open_scene("box", ...) opens a scene of test_scenes/ in this process and returns the Blender scene."""

    def open_it(name: str, *options: str) -> bpy.types.Scene:
        bpy.ops.wm.open_mainfile(filepath=str(scene_file(name, *options)))
        return bpy.context.scene

    return open_it


def blender_command(script: Path, arguments: list[str], blend: Path | None = None) -> list[str]:
    """Command line that runs `script` in another process of this same Blender. `blend` is opened first by `blender -b`;
    for the module it becomes the first argument (the way of addon/batch.py)."""
    if is_wheel:
        return [sys.executable, str(script), *([str(blend)] if blend else []), *arguments]
    command = [bpy.app.binary_path, "-b"]
    if blend:
        command.append(str(blend))
    return [*command, "--factory-startup", "--python-exit-code", "1", "-P", str(script), "--", *arguments]


def run_blender(
    script: Path,
    arguments: list[str],
    blend: Path | None = None,
    *,
    check: bool = True,
    timeout_s: float = 120,
    env: dict[str, str] | None = None,
    prefix: Sequence[str] = (),
) -> subprocess.CompletedProcess:
    """Runs `script` as blender_command says; output captured as text. check: a failure raises with the output in it.
    `prefix` goes before the command (unshare, prlimit, ...)."""
    command = [*prefix, *blender_command(script, arguments, blend)]
    environment = {**os.environ, **(env or {})}
    done = subprocess.run(command, capture_output=True, text=True, timeout=timeout_s, env=environment, check=False)
    if check and done.returncode != 0:
        tail = "\n".join((done.stdout + done.stderr).splitlines()[-40:])
        raise AssertionError(f"exit code {done.returncode} of {' '.join(command)}\n{tail}")
    return done


@pytest.fixture(scope="session")
def run_script() -> Callable[..., subprocess.CompletedProcess]:
    """run_script(script, arguments, blend=None, check=True, timeout_s=120, env=None, prefix=()): another process."""
    return run_blender


@pytest.fixture
def run_batch(project_root) -> Callable[..., subprocess.CompletedProcess]:
    """run_batch(blend, "render", "--out", ..., check=True): addon/batch.py in another process of this Blender."""

    def run(blend: Path, *arguments: object, **options) -> subprocess.CompletedProcess:
        return run_blender(project_root / "addon" / "batch.py", [str(a) for a in arguments], blend, **options)

    return run


@pytest.fixture(scope="module")
def module(addon):
    """module("batch_run"): a part of the add-on."""
    return lambda name: importlib.import_module(f"{addon.__name__}.{name}")


@pytest.fixture(scope="module")
def cache_folder(tmp_path_factory):
    """Where the truths of a test file are kept."""
    return tmp_path_factory.mktemp("cache")


@pytest.fixture
def compare(module, blend, cache_folder, tmp_path):
    """compare("--techniques", ...): comparison.json of a run in this process, on the test file's own `blend`."""

    def run(*arguments, file=blend, out=None, code=0):
        out = out or tmp_path / "o"
        words = [str(file), "compare", "--out", str(out), "--cache", str(cache_folder), *map(str, arguments)]
        assert module("batch_run").run(module("batch_options").parse_arguments(words)) == code
        return json.loads((out / "comparison.json").read_text()) if code == 0 else None

    return run
