# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The rows of `make measure NAMES=edsm_causes`: the program's table is read and checked."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))

import measure_edsm_causes as causes

TABLE = ["| scene | map | wrong | one | other |", "| --- | --- | --- | --- | --- |", "| box | 512 | 7 | 3 | 4 |"]


def test_tables_are_read():
    columns, rows = causes.read_table(TABLE)
    assert columns == ["scene", "map", "wrong", "one", "other"]
    assert rows == [["box", "512", "7", "3", "4"]]


@pytest.mark.parametrize("broken", [TABLE[::2], [*TABLE[:2], "| box | 512 | 7 | 3 |"]])
def test_what_is_no_table_is_refused(broken):
    with pytest.raises(ValueError, match="no Markdown table"):
        causes.read_table(broken)


def test_counts_must_add_up_but_for_rounding():
    assert causes.adds_up(["box", "512", "7", "3", "4"])
    assert causes.adds_up(["box", "512", "8", "3", "4"])
    assert not causes.adds_up(["box", "512", "9", "3", "4"])


def test_scenes_have_generators():
    for name in causes.kScenes:
        assert (causes.root / "test_scenes" / f"{name}.py").is_file(), name
    assert (causes.root / "tests" / "bench" / f"{causes.kProgram}.cpp").is_file()


def test_a_program_that_fails_is_told(tmp_path):
    program = tmp_path / "program"
    program.write_text("#!/bin/sh\nprintf '%s\\n' '| a |' '| --- |'\nexit 3\n")
    program.chmod(0o755)
    with pytest.raises(RuntimeError, match="exit code 3"):
        causes.run_program(program, [])
