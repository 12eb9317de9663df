# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pass names: short, without dots, unique and stable."""

import itertools
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from addon.names import PASS_NAME_BYTES, PassKey, pass_names


def test_plain_names_stay_readable():
    keys = [PassKey("Key", "edsm"), PassKey("Light.001", "sm"), PassKey("Key", "edsm", "Tint")]
    assert pass_names(keys) == ["Shadow Key edsm", "Shadow Light_001 sm", "Shadow Key edsm Tint"]


def test_hostile_names_give_valid_unique_passes():
    lights = [
        "Light.001", "Light_001", "Light.001 ", "", " ", ".", "..", "Coverage", "Combined", "a" * 63, "a" * 62 + "b",
        "Лампа над столом.001", "Лампа над столом.002", "灯" * 21, "灯" * 20 + "火", "tab\tname", "new\nline", "x\0y",
        "Key~abcd", "😀" * 15, "Key edsm", "Key",
    ]  # fmt: skip
    outputs = ("", "Tint", "A long output name")
    keys = [PassKey(*parts) for parts in itertools.product(lights, ("sm", "edsm"), outputs)]
    names = pass_names(keys)
    assert len(set(names)) == len(keys)
    for name in names:
        assert len(name.encode()) <= PASS_NAME_BYTES
        assert "." not in name
        assert name.isprintable()
        assert name not in {"Combined", "Coverage"}


def test_five_hundred_lights_cut_to_the_same_prefix():
    keys = [PassKey(f"A very long name of a lamp in the hall.{i:03d}", "edsm") for i in range(500)]
    assert len(set(pass_names(keys))) == 500


def test_order_and_company_do_not_matter():
    keys = [PassKey("A.1", "sm"), PassKey("A_1", "sm"), PassKey("B" * 60, "sm"), PassKey("B" * 59 + "C", "sm")]
    expected = dict(zip(keys, pass_names(keys), strict=True))
    for order in itertools.permutations(keys):
        assert dict(zip(order, pass_names(order), strict=True)) == expected
    assert expected[PassKey("A_1", "sm")] == "Shadow A_1 sm"
    assert pass_names([PassKey("B" * 60, "sm")]) == [expected[PassKey("B" * 60, "sm")]]
