# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the module shows to, and takes from, the process that loads it."""

import re
import subprocess

import pytest

FORBIDDEN = (
    "libGL",
    "libOpenGL",
    "libEGL",
    "libOSMesa",
    "libGLX",
    "libOpenImageIO",
    "libOpenEXR",
    "libImath",
    "libembree",
    "libtbb",
    "libLLVM",
    "libpython",
)


@pytest.fixture(scope="module")
def binary(module_dir):
    (found,) = module_dir.glob("shadow_core*.so")
    return found


def run(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def test_one_symbol_is_exported(binary):
    names = {line.split()[-1] for line in run("nm", "-D", "--defined-only", str(binary)).splitlines()}
    assert names == {"PyInit_shadow_core"}


def test_no_library_of_blenders_is_needed(binary):
    needed = re.findall(r"\(NEEDED\).*\[(.*)\]", run("readelf", "-d", str(binary)))
    assert needed
    resolved = re.findall(r"^\s*(\S+)", run("ldd", str(binary)), re.MULTILINE)
    for library in [*needed, *resolved]:
        assert not library.startswith(FORBIDDEN), library


def test_no_gl_function_is_wanted_from_the_process(binary):
    undefined = {line.split()[-1] for line in run("nm", "-D", "--undefined-only", str(binary)).splitlines()}
    assert not [name for name in undefined if re.match(r"(gl[A-Z]|egl[A-Z]|OSMesa)", name)]
