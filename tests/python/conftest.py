# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the tests find what was built. SHADOW_LAYERS_BUILD names another build folder than build/release."""

import importlib
import os
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("SHADOW_LAYERS_BUILD", ROOT / "build" / "release")).resolve()
HOW = "build it with 'cmake --preset release && cmake --build --preset release', or set SHADOW_LAYERS_BUILD"


@pytest.fixture(scope="session")
def root():
    return ROOT


@pytest.fixture(scope="session")
def module_dir():
    folder = BUILD / "python"
    if not list(folder.glob("shadow_core*.so")):
        pytest.fail(f"no shadow_core in {folder}: {HOW}")
    return folder


@pytest.fixture(scope="session")
def core(module_dir):
    sys.path.insert(0, str(module_dir))
    return importlib.import_module("shadow_core")


@pytest.fixture(scope="session")
def shader_dir():
    return str(ROOT / "shaders")


@pytest.fixture(scope="session")
def shadowcore():
    program = BUILD / "bin" / "shadowcore"
    if not program.is_file():
        pytest.fail(f"no shadowcore in {program.parent}: {HOW}")
    return program
