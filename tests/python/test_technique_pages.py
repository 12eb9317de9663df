# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What docs/techniques/<id>.md says of parameters is what the descriptors say; sources that are cited are listed."""

import re
import subprocess

import pytest

CODE = re.compile(r"`([^`]+)`")
NUMBER = re.compile(r"-?[\d,]*\.?\d+(?:e[+-]?\d+)?")
RANGE = re.compile(rf"({NUMBER.pattern}) … ({NUMBER.pattern})")
SWITCHES = {"on": True, "off": False}


def read_rows(page):
    """The cells of the page's parameter table: [parameter ids, default, meaning]."""
    lines = iter(page.splitlines())
    for line in lines:
        if re.fullmatch(r"\| parameter +\| default +\| meaning +\|", line):
            next(lines)
            break
    rows = []
    for line in lines:
        if not line.startswith("|"):
            break
        ids, default, meaning = (cell.strip() for cell in line.strip("|").split("|"))
        rows.append((CODE.findall(ids), default, meaning))
    return rows


def parse_number(text):
    return float(text.replace(",", ""))


def find_mistake(parameter, default, meaning):
    """What a row says of a parameter that its descriptor doesn't, or nothing."""
    told = default.split(" ")[0].strip("`")
    value = parameter["default"]
    kind = parameter["type"]
    if kind == "bool":
        right = SWITCHES.get(told) == value
    elif kind == "enum":
        right = told == value
    else:
        right = NUMBER.fullmatch(told) is not None and parse_number(told) == value
    if not right:
        return f"default is {value!r}, not {told!r}"
    for least, most in RANGE.findall(meaning) if kind in ("int", "float") else []:
        if (parse_number(least), parse_number(most)) != (parameter["min"], parameter["max"]):
            return f"range is {parameter['min']:g} … {parameter['max']:g}, not {least} … {most}"
    return None


def find_mistakes(technique, page):
    """Of one technique's page, as texts; rows without a default refer to another page."""
    specs = {parameter["id"]: parameter for parameter in technique["parameters"]}
    rows = read_rows(page)
    named = [name for names, _, _ in rows for name in names] if rows else [n for n in CODE.findall(page) if n in specs]
    mistakes = [f"{name} is missing" for name in specs if name not in named]
    for names, default, meaning in rows:
        for name in names:
            if name not in specs:
                mistakes.append(f"{name} is no parameter")
            elif default and (mistake := find_mistake(specs[name], default, meaning)):
                mistakes.append(f"{name}: {mistake}")
    return mistakes


def test_mistakes_are_found():
    technique = {
        "parameters": [
            {"id": "kernel", "type": "int", "default": 3, "min": 1, "max": 31},
            {"id": "sharp", "type": "bool", "default": True},
            {"id": "mode", "type": "enum", "default": "paper"},
            {"id": "width", "type": "float", "default": 0.5, "min": 1e-6, "max": 1e6},
        ]
    }
    good = (
        "text\n\n| parameter | default | meaning |\n| --- | --- | --- |\n| `kernel` | 3 taps | per side, 1 … 31 |\n"
        "| `sharp` | on | |\n| `mode` | `paper` | |\n| `width` | 0.5 | 1e-6 … 1e6 |\n"
    )
    assert find_mistakes(technique, good) == []
    for right, wrong in [
        ("| `kernel` | 3 taps |", "| `kernel` | 5 taps |"),
        ("1 … 31", "1 … 32"),
        ("| on |", "| off |"),
        ("`paper`", "half"),
        ("`width`", "`breadth`"),
        ("1e-6", "1e-5"),
        ("| `sharp` | on | |\n", ""),
    ]:
        assert right in good
        assert find_mistakes(technique, good.replace(right, wrong)), f"{right} -> {wrong}"


def test_pages_tell_the_parameters_of_the_descriptors(core, root):
    mistakes = []
    for technique in core.techniques():
        page = (root / "docs" / "techniques" / f"{technique['id']}.md").read_text(encoding="utf-8")
        mistakes += [f"docs/techniques/{technique['id']}.md: {text}" for text in find_mistakes(technique, page)]
    assert not mistakes, "\n".join(mistakes)


@pytest.fixture(scope="module")
def bib_keys(root):
    text = (root / "docs" / "references.bib").read_text(encoding="utf-8")
    return re.findall(r"^@\w+\{([^,\s]+),", text, re.MULTILINE)


def test_no_source_is_listed_twice(bib_keys):
    assert len(bib_keys) > 10
    assert sorted(bib_keys) == sorted(set(bib_keys))


def test_cited_sources_are_listed(root, bib_keys):
    command = ["git", "-C", str(root), "grep", "-hoE", r"\[[A-Z][A-Za-z]+[0-9]{2}\]", "--", "native", "shaders", "docs"]
    cited = set(subprocess.run(command, check=True, capture_output=True, text=True).stdout.split())
    assert "[Macedo16]" in cited
    assert {key.strip("[]") for key in cited} <= set(bib_keys)
