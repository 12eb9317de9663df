# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What docs/techniques/<id>.md says of parameters is what the descriptors say; sources that are cited are listed;
docs/techniques.md has all figures of every technique."""

import importlib
import itertools
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
    reported = default.split(" ")[0].strip("`")
    value = parameter["default"]
    kind = parameter["type"]
    if kind == "bool":
        right = SWITCHES.get(reported) == value
    elif kind == "enum":
        right = reported == value
    else:
        right = NUMBER.fullmatch(reported) is not None and parse_number(reported) == value
    if not right:
        return f"default is {value!r}, not {reported!r}"
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


def read_overview(page):
    """The table of figures in docs/techniques.md: by technique the cells by column."""
    lines = page.splitlines()
    start = next((k for k, line in enumerate(lines) if line.startswith("| technique | truth |")), len(lines))
    table = [[cell.strip() for cell in line.strip("|").split("|")]
             for line in itertools.takewhile(lambda line: line.startswith("|"), lines[start:])]  # fmt: skip
    return {CODE.findall(cells[0])[0]: dict(zip(table[0], cells, strict=True)) for cells in table[2:]}


def find_overview_mistakes(techniques, page):
    """What the page lacks of the techniques of the build, or tells differently."""
    rows, ids = read_overview(page), [technique["id"] for technique in techniques]
    mistakes = [f"{name} is no technique" for name in rows if name not in ids]
    for technique in techniques:
        row = rows.get(technique["id"])
        if row is None:
            mistakes.append(f"{technique['id']} has no row")
            continue
        errors = [cell for column, cell in row.items() if column.startswith("error, ")]
        right = {
            "errors": len(errors) >= 2 and all(re.fullmatch(r"\d+\.\d+", cell) for cell in errors),
            "truth": row["truth"].startswith(technique["truth"]),
            "time": re.fullmatch(r"\d+\.\d+( \(\d+\.\d+ … \d+\.\d+\))?", row["time"]),
            "memory": re.fullmatch(r"\d+\.\d+ MB", row["memory"]) and row["memory"] != "0.0 MB",
            "meshes": row["meshes"] == technique["meshes"].replace("_", " "),
            "size": row["size"] == technique["light_size"],
            "lights": row["lights"] == ", ".join(technique["lights"]).lower(),
            "summary": f"| {technique['summary']} | {technique['limits']} |" in page,
            "picture": f"![{technique['id']}](images/{technique['id']}.png)" in page,
        }
        mistakes += [f"{technique['id']}: {what}: {row.get(what, errors)}" for what, good in right.items() if not good]
    return mistakes


@pytest.fixture(scope="module")
def overview(root):
    return (root / "docs" / "techniques.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def offered(core):
    return [technique for technique in core.techniques() if not technique["test_only"]]


def test_the_overview_tells_all_of_every_technique(root, offered, overview):
    assert not (mistakes := find_overview_mistakes(offered, overview)), "\n".join(["run `make table`:", *mistakes])
    for technique in offered:
        assert (root / "docs" / "images" / f"{technique['id']}.png").is_file(), "run `make docs`"


def make_results(techniques):
    """What the benchmark of all techniques leaves, as far as the page uses it."""
    records = [
        {"technique": technique["id"], "lights": 2, "ratio_to_sm": 1.25, "counters": {"map_bytes": 8 * 10**6, "x": 9},
         "errors": {"truth": technique["truth"], "footprint_texels": 3.0, "footprint_world": 0.0,
                    "own": {"mean_absolute": 0.00125}}}
        for technique in techniques
    ]  # fmt: skip
    runs = [{"scene": scene, "resolution": "HD (1280x720)", "records": records} for scene in ("one", "two")]
    machine = {"processor": "P", "threads": 2, "gl_renderer": "R", "load_before": 0.1}
    return {"state": "whole", "machine": machine, "tables": [{"id": "techniques", "runs": runs}]}


def test_the_overview_is_made_whole_or_not_at_all(root, offered, monkeypatch):
    monkeypatch.syspath_prepend(str(root / "scripts"))
    make_page = importlib.import_module("make_technique_table").make_page
    results = make_results(offered)
    page = make_page(offered, results)
    assert find_overview_mistakes(offered, page) == []
    row = read_overview(page)["sm"]
    assert (row["error, one"], row["time"], row["memory"]) == ("0.125", "1.25", "4.0 MB")
    results["tables"][0]["runs"][1]["records"] = results["tables"][0]["runs"][1]["records"][:-1]
    with pytest.raises(SystemExit, match=f"no figures of {offered[-1]['id']}"):
        make_page(offered, results)
    results["tables"][0]["runs"][1] = {"scene": "two", "failed": "no memory"}
    with pytest.raises(SystemExit, match="two: no memory"):
        make_page(offered, results)


def test_what_the_overview_lacks_is_found(offered, overview):
    row = next(line for line in overview.splitlines() if line.startswith(f"| [`{offered[-1]['id']}`]"))
    cells = row.split(" | ")
    assert find_overview_mistakes(offered, overview.replace(row + "\n", "")) == [f"{offered[-1]['id']} has no row"]
    assert find_overview_mistakes(offered[:-1], overview) == [f"{offered[-1]['id']} is no technique"]
    for k in range(1, len(cells)):
        poor = " | ".join([*cells[:k], "" if k < len(cells) - 1 else "|", *cells[k + 1 :]])
        assert find_overview_mistakes(offered, overview.replace(row, poor)), cells[k]


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
