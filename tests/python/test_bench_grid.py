# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The benchmark's grid: how it is read, laid out and told; and the program around it, from outside."""

import copy
import json
import signal
import subprocess
import sys
import time

import pytest
import tomllib

MINIMAL = """
[resolutions]
small = "64x48"
wide = "96x48"
[scenes]
box = { script = "box" }
figure = { script = "model", model = "figure", arguments = ["--light", "sun"] }
[methods.sm]
technique = "sm"
axes = { map_size = "map_size" }
[methods.pcf]
technique = "pcf"
settings = { bilinear = true }
axes = { map_size = "map_size", kernel = "kernel" }
[methods.blurred]
technique = "vsm"
axes = { map_size = "map_size", kernel = { parameter = "blur_radius", half = true } }
[[tables]]
id = "one"
title = "One"
scenes = ["box", "figure"]
rows = ["pcf", { method = "blurred", kernel = [6, 7, 8] }]
axes = { map_size = [64, 128], kernel = [3, 5] }
repeat = 4
quick = { scenes = ["box"], axes = { map_size = [64], kernel = [3] } }
[[tables]]
id = "two"
title = "Two"
scenes = ["box"]
resolutions = ["small", "wide"]
rows = ["sm"]
axes = { map_size = [64] }
errors = true
"""

TECHNIQUES = [
    {"id": "sm", "test_only": False, "parameters": [{"id": "map_size"}]},
    {"id": "pcf", "test_only": False, "parameters": [{"id": "map_size"}, {"id": "kernel"}, {"id": "bilinear"}]},
    {"id": "probe", "test_only": True, "parameters": []},
]
VSM = {"id": "vsm", "test_only": False, "parameters": [{"id": "map_size"}, {"id": "blur_radius"}]}


@pytest.fixture(scope="module", autouse=True)
def scripts(root):
    sys.path.insert(0, str(root / "scripts"))
    yield
    sys.path.remove(str(root / "scripts"))


@pytest.fixture(scope="module")
def bench_grid(scripts):
    import bench_grid

    return bench_grid


@pytest.fixture
def document():
    return tomllib.loads(MINIMAL)


def lay_out(bench_grid, document, techniques=TECHNIQUES, only=(), quick=False):
    grid = bench_grid.parse_grid(document)
    return bench_grid.lay_out(grid, techniques=techniques, only=list(only), quick=quick)


def test_a_table_of_all_techniques_names_none(bench_grid, document):
    document["tables"][0] |= {"rows": "all", "axes": {}}
    document["tables"][0].pop("quick")
    rows = lay_out(bench_grid, document, [*TECHNIQUES, VSM], only=["one"])[0].runs[0].rows
    assert [(row.technique, row.settings) for row in rows] == [("sm", {}), ("pcf", {}), ("vsm", {})]
    document["tables"][0]["rows"] = "some"
    with pytest.raises(bench_grid.GridError, match='rows is neither "all" nor a list'):
        lay_out(bench_grid, document)


def test_rows_are_laid_out_over_the_axes_that_they_follow(bench_grid, document):
    one, two = lay_out(bench_grid, document, [*TECHNIQUES, VSM])
    assert [run.scene.name for run in one.runs] == ["box", "figure"]
    assert one.runs[1].scene.arguments == ("--light", "sun") and one.runs[1].scene.model == "figure"
    rows = one.runs[0].rows
    pcf = [row for row in rows if row.method == "pcf"]
    assert [row.place for row in pcf] == [{"map_size": m, "kernel": k} for m in (64, 128) for k in (3, 5)]
    assert pcf[0].settings == {"bilinear": True, "map_size": 64, "kernel": 3}
    assert [(run.resolution_name, run.resolution) for run in two.runs] == [("small", "64x48"), ("wide", "96x48")]
    assert (one.runs[0].repeat, one.runs[0].errors, two.runs[0].repeat, two.runs[0].errors) == (4, False, 5, True)


def test_a_radius_is_half_the_kernel_and_equal_ones_are_one_row(bench_grid, document):
    one, _ = lay_out(bench_grid, document, [*TECHNIQUES, VSM])
    blurred = [row for row in one.runs[0].rows if row.method == "blurred"]
    assert [row.settings["blur_radius"] for row in blurred] == [
        3,
        4,
        3,
        4,
    ]  # 6 and 7 are one
    assert [row.settings["map_size"] for row in blurred] == [64, 64, 128, 128]


def test_sm_is_measured_at_each_map_size_whether_named_or_not(bench_grid, document):
    one, two = lay_out(bench_grid, document)
    assert [row.settings for row in one.runs[0].rows if row.technique == "sm"] == [{"map_size": 64}, {"map_size": 128}]
    assert [row.settings for row in two.runs[0].rows] == [{"map_size": 64}]


def test_what_the_core_does_not_have_is_named_and_the_rest_goes_on(bench_grid, document):
    one, two = lay_out(bench_grid, document)
    assert one.missing == ["blurred"] and two.missing == []
    assert {row.technique for row in one.runs[0].rows} == {"sm", "pcf"}
    document["methods"]["pcf"]["technique"] = "probe"
    assert lay_out(bench_grid, document)[0].missing == ["pcf", "blurred"], "test techniques are nobody's"


def test_the_quick_form_takes_tables_that_have_one(bench_grid, document):
    (one,) = lay_out(bench_grid, document, quick=True)
    assert [run.scene.name for run in one.runs] == ["box"] and one.runs[0].repeat == 3
    assert [row.place for row in one.runs[0].rows] == [{"map_size": 64}, {"map_size": 64, "kernel": 3}]
    with pytest.raises(bench_grid.GridError, match="quick"):
        lay_out(bench_grid, document, only=["two"], quick=True)
    assert [table.name for table in lay_out(bench_grid, document, only=["two"])] == ["two"]


def change(document, path, value):
    changed = copy.deepcopy(document)
    *way, last = path
    target = changed
    for key in way:
        target = target[key]
    target[last] = value
    return changed


BAD = [
    (("resolutions", "small"), "64", "small"),
    (("scenes", "box"), {"arguments": []}, "script"),
    (("scenes", "box"), {"script": "box", "color": 1}, "color"),
    (("scenes", "box"), {"script": "box", "arguments": [1]}, "arguments"),
    (("methods", "pcf"), {"axes": {}}, "technique"),
    (("methods", "pcf", "axes"), {"kernel": 3}, "kernel"),
    (("tables", 0, "scenes"), ["castle"], "castle"),
    (("tables", 0, "scenes"), [], "scenes"),
    (("tables", 0, "rows"), ["pfc"], "pfc"),
    (("tables", 0, "rows"), [{"method": "pcf", "radius": 1}], "radius"),
    (("tables", 0, "axes"), {"map_size": []}, "map_size"),
    (("tables", 0, "axes"), {"colour": [1]}, "colour"),
    (("tables", 0, "against"), ["edsm"], "edsm"),
    (("tables", 0, "repeat"), 0, "repeat"),
    (("tables", 0, "repeat"), True, "repeat"),
    (("tables", 0, "quick"), {"scenes": ["castle"]}, "castle"),
    (("tables", 1, "id"), "one", "one"),
    (("tables", 1, "resolutions"), ["huge"], "huge"),
    (("tables",), [], "tables"),
]


@pytest.mark.parametrize(("path", "value", "culprit"), BAD)
def test_mistakes_in_the_grid_are_named(bench_grid, document, path, value, culprit):
    with pytest.raises(bench_grid.GridError, match=culprit):
        bench_grid.parse_grid(change(document, path, value))


def test_unknown_parameters_and_tables_are_named(bench_grid, document):
    document["methods"]["pcf"]["settings"] = {"softness": 1}
    with pytest.raises(bench_grid.GridError, match=r"pcf has no parameter softness; it has map_size, kernel, bilinear"):
        lay_out(bench_grid, document)
    with pytest.raises(bench_grid.GridError, match="three; there are one, two"):
        lay_out(bench_grid, document, only=["three"])


def test_unreadable_grids_are_named(bench_grid, tmp_path):
    with pytest.raises(bench_grid.GridError, match=r"nowhere\.toml"):
        bench_grid.read_grid(tmp_path / "nowhere.toml")
    (tmp_path / "bad.toml").write_text("[scenes")
    with pytest.raises(bench_grid.GridError, match=r"bad\.toml is no TOML"):
        bench_grid.read_grid(tmp_path / "bad.toml")


def test_the_projects_own_grid_is_sound_and_holds_the_papers_axes(bench_grid, root, core):
    grid = bench_grid.read_grid(root / "scripts" / "bench_grid.toml")
    for scene in grid.scenes.values():
        assert (root / "test_scenes" / f"{scene.script}.py").is_file()
    plan = bench_grid.lay_out(grid, techniques=core.techniques(), only=[], quick=False)
    tables = {table.name: table for table in plan}
    assert bench_grid.lay_out(grid, techniques=core.techniques(), only=[], quick=True)
    maps = tables["filters-kernels-maps"]
    assert maps.axes == {"map_size": [512, 1024, 2048, 4096], "kernel": [3, 10, 17]}
    assert tables["penumbrae-kernels"].axes["kernel"] == [7, 15, 23, 31]
    assert {run.resolution_name for run in tables["revectorisation-pictures"].runs} == {"SD", "HD", "FullHD"}
    for table in tables.values():
        assert all(any(row.technique == "sm" for row in run.rows) for run in table.runs)


def make_record(**changes):
    spread = {"median": 12.34, "quartile_1": 11.0, "quartile_3": 13.0, "count": 5}
    errors = {
        "truth": "filtered", "footprint_texels": 7.0, "footprint_world": 0.0,
        "own": {"mean_absolute": 0.01234}, "hard": {"wrong_fraction": 0.0005},
    }  # fmt: skip
    record = {
        "method": "pcf", "place": {"kernel": 7}, "triangles": 29172, "render_ms": spread,
        "ratio_to_sm_spread": {"median": 1.5, "quartile_1": 1.4, "quartile_3": 1.6}, "layers_ratio_to_sm": 2.0,
        "stage_ratio_to_sm": {"resolve": 3.456}, "errors": errors,
        "stage_ms": {"frame: ids": {"median": 99.0}, "resolve": {"median": 8.0}, "depth_map": {"median": 9.0}},
    }  # fmt: skip
    return record | changes


def test_tables_tell_medians_ratios_errors_and_what_is_not_there():
    import bench_tables

    sm = make_record(method="sm", place={}, ratio_to_sm_spread=None, layers_ratio_to_sm=None, errors=None)
    runs = [
        {"scene": "box", "resolution": "HD (1280x720)", "records": [sm, make_record()]},
        {"scene": "figure", "resolution": "HD (1280x720)", "skipped": "the model figure.obj is not there"},
        {"scene": "hall", "resolution": "HD (1280x720)", "failed": "no memory"},
    ]
    table = {"id": "one", "title": "Kernels", "missing": ["vsm"], "runs": runs}
    machine = {"processor": "An 8086", "threads": 1, "gl_renderer": "llvmpipe", "revision": "abc"}
    page = bench_tables.make_page({"state": "failures", "machine": machine, "tables": [table]})
    for text in (
        "An 8086",
        "llvmpipe",
        "abc",
        "not in this build: vsm",
        "figure.obj is not there",
        "no memory",
    ):
        assert text in page
    assert "Not whole: failures" in page
    lines = page.splitlines()
    (pcf,) = [line for line in lines if line.startswith("| `pcf`")]
    assert pcf == (
        "| `pcf` | 7 | 12.3 (11.0, 13.0) | 1.50 (1.40, 1.60) | 2.00 | 3.46 | 1.234 | filtered 7 texels | 0.050 "
        "| depth_map 9.0 · resolve 8.0 |"
    )
    tables = [line for line in lines if line.startswith("|")]
    widths = {line.count("|") for line in tables[tables.index(pcf) - 3 : tables.index(pcf) + 1]}
    assert len(widths) == 1, "every row has as many cells as the head"


def test_antialiased_rows_tell_the_error_at_the_border():
    import bench_tables

    def record(method, border):
        own = {"mean_absolute": 0.001, "border_mean_absolute": border}
        errors = {"truth": "pixel" if method == "fsasm" else "hard", "own": own, "hard": {"wrong_fraction": 0.0}}
        return make_record(method=method, errors=errors)

    run = {"scene": "box", "resolution": "HD (1280x720)", "records": [record("sm", None), record("fsasm", 0.0137)]}
    head, _, sm, fsasm = bench_tables.make_run(run)[-4:]
    place = head.split("|").index(" border ")
    assert [line.split("|")[place] for line in (sm, fsasm)] == ["  ", " 1.37 "]
    run["records"] = [record("sm", None)]
    assert " border " not in bench_tables.make_run(run)[-3]


def test_ratios_to_other_methods_are_taken_at_the_same_place():
    import bench_tables

    def record(method, ms, **place):
        return make_record(method=method, place=place, render_ms=make_record()["render_ms"] | {"median": ms})

    records = [
        record("sm", 10, map_size=64),
        record("pcf", 20, map_size=64, kernel=3),
        record("pcf", 80, map_size=64, kernel=9),
        record("rpcf", 40, map_size=64, kernel=9),
        record("rpcf", 30, map_size=128, kernel=3),
    ]
    ratios = [bench_tables.compute_ratio(one, records, "pcf") for one in records]
    assert ratios == [0.5, 1.0, 1.0, 0.5, None]
    lines = bench_tables.make_run({"scene": "box", "resolution": "HD", "records": records}, ["pcf"])
    assert "| ratio | to pcf | layer ratio |" in lines[2]
    assert len({line.count("|") for line in lines[2:]}) == 1


@pytest.fixture
def start_bench(root, tmp_path, shadowcore):
    """Starts scripts/bench.py with the small grid of this file."""

    def start(*arguments, grid=MINIMAL):
        (tmp_path / "grid.toml").write_text(grid)
        command = [sys.executable, root / "scripts" / "bench.py", "--grid", tmp_path / "grid.toml", "--out",
                   tmp_path / "out", "--build", shadowcore.parent.parent, "--models", tmp_path, *arguments]  # fmt: skip
        return subprocess.Popen(
            [str(part) for part in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )

    return start


def test_missing_models_are_left_out_with_a_line(start_bench, tmp_path):
    only_models = MINIMAL.replace('scenes = ["box", "figure"]', 'scenes = ["figure"]')
    process = start_bench("one", grid=only_models)
    output, _ = process.communicate(timeout=60)
    assert process.returncode == 0 and "figure.obj is not there" in output, output
    document = json.loads((tmp_path / "out" / "results.json").read_text())
    assert document["state"] == "whole" and "skipped" in document["tables"][0]["runs"][0]
    assert "Left out" in (tmp_path / "out" / "results.md").read_text()


def test_a_mistake_in_the_grid_ends_before_anything_is_measured(start_bench, tmp_path):
    process = start_bench(grid=MINIMAL.replace('"box"]', '"castle"]'))
    output, _ = process.communicate(timeout=60)
    assert process.returncode == 2 and "castle" in output.splitlines()[-1]
    assert not (tmp_path / "out" / "results.json").exists()


def test_interrupted_it_keeps_what_was_measured_and_no_half_file(start_bench, tmp_path):
    process = start_bench()
    end = time.monotonic() + 60
    while not (tmp_path / "out" / "info.json").exists() and time.monotonic() < end:
        time.sleep(0.02)
    time.sleep(0.3)
    process.send_signal(signal.SIGTERM)
    output, _ = process.communicate(timeout=60)
    assert process.returncode == 130 and "interrupted" in output, output
    assert json.loads((tmp_path / "out" / "results.json").read_text())["state"] == "interrupted"
    assert not list((tmp_path / "out").glob(".*"))
