# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads bench_grid.toml and lays it out into runs: one scene in one resolution with rows of techniques and settings.

What is wrong in the file ends in a GridError that names table or method and the remedy. What the core doesn't have is
no mistake: it is left out and named.
"""

from __future__ import annotations

import itertools
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import tomllib

Settings = dict[str, Any]


class GridError(Exception):
    """The grid asks for something that makes no sense; the text names what and where."""


@dataclass(frozen=True)
class Scene:
    """A generator of test_scenes/ with its arguments; `model` names an OBJ file that it shows."""

    name: str
    script: str
    arguments: tuple[str, ...] = ()
    model: str = ""


@dataclass(frozen=True)
class Axis:
    """The parameter that follows an axis; `half`: a radius, half the axis' value rounded down."""

    parameter: str
    half: bool = False

    def settings(self, value: Any) -> Settings:
        return {self.parameter: value // 2 if self.half else value}


@dataclass(frozen=True)
class Method:
    name: str
    technique: str
    settings: Settings
    axes: dict[str, Axis]


@dataclass(frozen=True)
class Row:
    """A method at one place of a table: `place` holds the values of the axes that it follows."""

    method: str
    technique: str
    settings: Settings
    place: Settings


@dataclass(frozen=True)
class Run:
    """What one call of shadowcore measures."""

    table: str
    scene: Scene
    resolution_name: str
    resolution: str
    rows: tuple[Row, ...]
    repeat: int
    warm_up: int
    errors: bool


@dataclass
class Table:
    name: str
    title: str
    axes: dict[str, list]
    against: list[str] = field(default_factory=list)  # methods that times are given as ratios to, beside sm
    runs: list[Run] = field(default_factory=list)
    missing: list[str] = field(default_factory=list)  # methods whose technique the core does not have


@dataclass(frozen=True)
class Grid:
    scenes: dict[str, Scene]
    methods: dict[str, Method]
    resolutions: dict[str, str]
    defaults: dict[str, Any]
    tables: list[dict[str, Any]]


TABLE_KEYS = {"id", "title", "scenes", "resolutions", "rows", "axes", "against", "errors", "repeat", "warm_up", "quick"}
ALL_ROWS = "all"  # every technique that the core has, with its defaults
QUICK_KEYS = TABLE_KEYS - {"id", "title", "quick"}


def require(good: bool, text: str) -> None:
    if not good:
        raise GridError(text)


def check_keys(where: str, entry: Any, known: set[str], needed: set[str] = frozenset()) -> None:
    require(isinstance(entry, dict), f"{where}: {entry!r} is no table of keys and values")
    unknown = sorted(set(entry) - known)
    require(not unknown, f'{where}: "{", ".join(unknown)}" is not known; known are {", ".join(sorted(known))}')
    missing = sorted(needed - set(entry))
    require(not missing, f"{where}: {', '.join(missing)} is missing")


def read_grid(path: Path) -> Grid:
    """Raises GridError naming the file and what is wrong in it."""
    try:
        document = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise GridError(f"{path} cannot be read: {error.strerror}") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise GridError(f"{path} is no TOML: {error}") from None
    try:
        return parse_grid(document)
    except GridError as error:
        raise GridError(f"{path}: {error}") from None


def parse_grid(document: dict[str, Any]) -> Grid:
    sections = {"defaults", "resolutions", "scenes", "methods", "tables"}
    check_keys("the file", document, sections, sections - {"defaults"})
    resolutions = document["resolutions"]
    for name, size in resolutions.items():
        good = isinstance(size, str) and re.fullmatch(r"[1-9]\d*x[1-9]\d*", size)
        require(bool(good), f'resolution {name}: {size!r} is not "WIDTHxHEIGHT"')
    scenes = {name: parse_scene(name, entry) for name, entry in document["scenes"].items()}
    methods = {name: parse_method(name, entry) for name, entry in document["methods"].items()}
    defaults = {"repeat": 5, "warm_up": 1, "resolutions": list(resolutions)[:1], "errors": False}
    given = document.get("defaults", {})
    check_keys("defaults", given, set(defaults))
    defaults |= given
    require(isinstance(document["tables"], list) and bool(document["tables"]), "there is no [[tables]]")
    grid = Grid(scenes, methods, resolutions, defaults, document["tables"])
    names = [check_table(grid, entry) for entry in grid.tables]
    twice = sorted({name for name in names if names.count(name) > 1})
    require(not twice, f"two tables have the id {', '.join(twice)}")
    return grid


def parse_scene(name: str, entry: Any) -> Scene:
    check_keys(f"scene {name}", entry, {"script", "arguments", "model"}, {"script"})
    arguments = entry.get("arguments", [])
    good = isinstance(arguments, list) and all(isinstance(argument, str) for argument in arguments)
    require(good, f"scene {name}: arguments {arguments!r} is no list of texts")
    return Scene(name, entry["script"], tuple(arguments), entry.get("model", ""))


def parse_method(name: str, entry: Any) -> Method:
    check_keys(f"method {name}", entry, {"technique", "settings", "axes"}, {"technique"})
    axes = {}
    for axis, follower in entry.get("axes", {}).items():
        if isinstance(follower, dict):
            check_keys(f"method {name}, axis {axis}", follower, {"parameter", "half"}, {"parameter"})
            axes[axis] = Axis(follower["parameter"], bool(follower.get("half", False)))
        else:
            require(isinstance(follower, str), f"method {name}, axis {axis}: {follower!r} names no parameter")
            axes[axis] = Axis(follower)
    return Method(name, entry["technique"], dict(entry.get("settings", {})), axes)


def check_table(grid: Grid, entry: dict[str, Any]) -> str:
    name = str(entry.get("id", "?")) if isinstance(entry, dict) else "?"
    where = f"table {name}"
    check_keys(where, entry, TABLE_KEYS, {"id", "title", "scenes", "rows", "axes"})
    quick = entry.get("quick", {})
    check_keys(f"{where}, quick", quick, QUICK_KEYS)
    for part in (grid.defaults | entry, grid.defaults | entry | quick):
        for key, known in (("scenes", grid.scenes), ("resolutions", grid.resolutions)):
            require(isinstance(part[key], list) and bool(part[key]), f"{where}: {key} is no list with anything in it")
            unknown = [one for one in part[key] if one not in known]
            require(
                not unknown, f"{where}: {key}: there is no {', '.join(map(str, unknown))}; there are {', '.join(known)}"
            )
        for key, least in (("repeat", 1), ("warm_up", 0)):
            value = part[key]
            good = isinstance(value, int) and not isinstance(value, bool) and value >= least
            require(good, f"{where}: {key} = {value!r} is no whole number from {least}")
        require(isinstance(part["axes"], dict), f"{where}: axes are {part['axes']!r}, not {{ map_size = [512], ... }}")
        for axis, values in part["axes"].items():
            require(isinstance(values, list) and bool(values), f"{where}: axis {axis} is no list with anything in it")
            followed = any(axis in method.axes for method in grid.methods.values())
            require(followed, f"{where}: no method follows the axis {axis}")
        good = part["rows"] == ALL_ROWS or (isinstance(part["rows"], list) and bool(part["rows"]))
        require(good, f'{where}: rows is neither "{ALL_ROWS}" nor a list with anything in it')
        unknown = [one for one in part.get("against", []) if one not in grid.methods]
        require(not unknown, f"{where}: against: there is no method {', '.join(map(str, unknown))}")
        for row in part["rows"] if part["rows"] != ALL_ROWS else []:
            split_row(grid, where, row, part["axes"])
    return name


def split_row(grid: Grid, where: str, row: Any, axes: dict[str, list]) -> tuple[Method, dict[str, list]]:
    """The method of a row and the values it takes on the table's axes; an inline table sets some of its own."""
    own = {}
    if isinstance(row, dict):
        check_keys(f"{where}, row {row}", row, {"method", *axes}, {"method"})
        own = {key: value if isinstance(value, list) else [value] for key, value in row.items() if key != "method"}
        row = row["method"]
    require(row in grid.methods, f"{where}: there is no method {row!r}; there are {', '.join(grid.methods)}")
    method = grid.methods[row]
    return method, {axis: own.get(axis, values) for axis, values in axes.items() if axis in method.axes}


def expand_row(grid: Grid, where: str, row: Any, axes: dict[str, list]) -> list[Row]:
    """A row at every place of the axes that it follows. Two radii that come out equal are one row."""
    method, values = split_row(grid, where, row, axes)
    rows: dict[str, Row] = {}
    for combination in itertools.product(*values.values()):
        place = dict(zip(values, combination, strict=True))
        settings = dict(method.settings)
        for axis, value in place.items():
            settings |= method.axes[axis].settings(value)
        made = Row(method.name, method.technique, settings, place)
        rows.setdefault(repr(sorted(settings.items())), made)
    return list(rows.values())


def lay_out(grid: Grid, *, techniques: list[dict], only: list[str], quick: bool) -> list[Table]:
    """The tables asked for, with what the core has. `techniques`: as `shadowcore info --json` lists them."""
    known = {entry["id"]: entry for entry in techniques if not entry["test_only"]}
    names = [entry["id"] for entry in grid.tables]
    unknown = [name for name in only if name not in names]
    require(not unknown, f"there is no table {', '.join(unknown)}; there are {', '.join(names)}")
    tables = []
    for entry in grid.tables:
        if (only and entry["id"] not in only) or (quick and "quick" not in entry):
            continue
        part = grid.defaults | entry | (entry.get("quick", {}) if quick else {})
        tables.append(lay_out_table(grid, part, known, quick))
    require(bool(tables), "nothing is left to measure: none of these tables has a quick form")
    return tables


def lay_out_table(grid: Grid, part: dict[str, Any], known: dict[str, dict], quick: bool) -> Table:
    where = f"table {part['id']}"
    table = Table(part["id"], part["title"], part["axes"], list(part.get("against", [])))
    if part["rows"] == ALL_ROWS:
        rows = [Row(technique, technique, {}, {}) for technique in known]
    else:
        rows = [made for row in part["rows"] for made in expand_row(grid, where, row, part["axes"])]
    table.missing = list(dict.fromkeys(row.method for row in rows if row.technique not in known))
    rows = [row for row in rows if row.technique in known]
    for row in rows:
        check_parameters(where, row, known[row.technique])
    rows = add_reference(rows)
    repeat = min(part["repeat"], 3) if quick else part["repeat"]
    for scene, resolution in itertools.product(part["scenes"], part["resolutions"]):
        table.runs.append(
            Run(part["id"], grid.scenes[scene], resolution, grid.resolutions[resolution], tuple(rows), repeat,
                part["warm_up"], part["errors"])
        )  # fmt: skip
    return table


def check_parameters(where: str, row: Row, technique: dict) -> None:
    names = [parameter["id"] for parameter in technique["parameters"]]
    unknown = [name for name in row.settings if name not in names]
    has = ", ".join(names) or "none"
    require(
        not unknown,
        f"{where}, method {row.method}: {row.technique} has no parameter {', '.join(unknown)}; it has {has}",
    )


def add_reference(rows: list[Row]) -> list[Row]:
    """sm in front, at each map size that occurs: what all times are given as ratios to."""
    sizes = list(dict.fromkeys(row.settings["map_size"] for row in rows if "map_size" in row.settings))
    there = {row.settings.get("map_size") for row in rows if row.technique == "sm"}
    extra = [Row("sm", "sm", {"map_size": size}, {"map_size": size}) for size in sizes if size not in there]
    return extra + rows
