# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The figures of docs/comparison.md as data: sound, and told as they were drawn."""

import sys

import pytest


@pytest.fixture(scope="module")
def make_comparison(root):
    sys.path.insert(0, str(root / "scripts"))
    try:
        import make_comparison
    finally:
        sys.path.remove(str(root / "scripts"))
    return make_comparison


@pytest.fixture(scope="module")
def figures(make_comparison, root):
    return make_comparison.read_figures(root / "scripts" / "comparison_figures.toml")


def test_every_figure_can_be_drawn(make_comparison, figures, core, root):
    techniques = {entry["id"]: entry for entry in core.techniques()}
    assert len({figure["id"] for figure in figures}) == len(figures) >= 5
    for figure in figures:
        assert (root / "test_scenes" / f"{figure['scene']}.py").is_file()
        width, height, left, top = figure["crop"]
        assert 0 <= left < left + width <= 1280 and 0 <= top < top + height <= 720
        for panel in figure["panels"]:
            if panel.get("technique") in techniques:
                technique = panel["technique"]
                settings = make_comparison.choose_settings(figure, panel, techniques[technique])
                core.resolve_parameters(technique, settings)  # refuses values that are out of range
            assert panel.get("truth", "hard") in ("hard", "soft")


def test_panels_take_the_figures_settings_that_they_have(make_comparison):
    figure = {"id": "f", "settings": {"map_size": 64, "kernel": 3}}
    technique = {"id": "vsm", "parameters": [{"id": "map_size"}, {"id": "blur_radius"}]}
    panel = {"technique": "vsm", "settings": {"blur_radius": 2}}
    assert make_comparison.choose_settings(figure, panel, technique) == {"map_size": 64, "blur_radius": 2}
    with pytest.raises(make_comparison.FigureError, match="vsm has no parameter kernel"):
        make_comparison.choose_settings(figure, panel | {"settings": {"kernel": 3}}, technique)


@pytest.mark.parametrize(
    ("text", "culprit"),
    [
        ("", "figures"),
        ("[[figures]]\nid = 'one'\n", "one: title"),
        (
            "[[figures]]\nid='one'\ntitle=''\nscene=''\nlook=''\ncrop=[]\nzoom=1\ncolumns=1\npanels=[{}]\n"
            "[figures.settings]\n",
            "neither a technique nor a truth",
        ),
    ],
)
def test_mistakes_are_named(make_comparison, tmp_path, text, culprit):
    (tmp_path / "figures.toml").write_text(text)
    with pytest.raises(make_comparison.FigureError, match=culprit):
        make_comparison.read_figures(tmp_path / "figures.toml")


def test_the_page_tells_settings_and_what_was_missing(make_comparison, figures):
    figure = next(figure for figure in figures if figure["id"] == "edges")
    panels = [
        {"label": "truth (Cycles)", "technique": "", "settings": {}},
        {"label": "pcf", "technique": "pcf", "settings": {"map_size": 512, "kernel": 3}},
    ]
    entry = {"figure": figure, "file": "compare_edges.png", "panels": panels, "missing": ["msm"]}
    page = make_comparison.make_page([entry])
    for text in (
        "images/compare_edges.png",
        "`map_size` 512",
        "truth (Cycles); `pcf` (kernel 3).",
        "build: msm",
        "blades",
    ):
        assert text in page
