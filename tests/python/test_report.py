# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures, tables and the page: read back, not just written."""

import base64
import re
import struct
import sys
import zlib
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "addon"))

from compare import flip, measures, pictures, pixels, report, table, temporal
from compare.png import encode_png


def decode_png(data):
    """Just enough of a reader: checks every chunk's sum; (array top row first, palette, texts)."""
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    position, chunks = 8, []
    while position < len(data):
        (length,) = struct.unpack(">I", data[position : position + 4])
        kind, body = data[position + 4 : position + 8], data[position + 8 : position + 8 + length]
        assert struct.unpack(">I", data[position + 8 + length : position + 12 + length])[0] == zlib.crc32(kind + body)
        chunks.append((kind, body))
        position += 12 + length
    assert chunks[0][0] == b"IHDR" and chunks[-1] == (b"IEND", b"")
    width, height, depth, color, *_ = struct.unpack(">IIBBBBB", chunks[0][1])
    channels = {0: 1, 2: 3, 3: 1, 6: 4}[color]
    stride = width * channels * depth // 8
    raw = np.frombuffer(zlib.decompress(b"".join(body for kind, body in chunks if kind == b"IDAT")), np.uint8)
    raw = raw.reshape(height, stride + 1)
    rows = raw[:, 1:].copy()
    for row in range(height):
        assert raw[row, 0] in (0, 2)
        if raw[row, 0] == 2 and row:
            rows[row] += rows[row - 1]
    rows = rows.view(">u2") if depth == 16 else rows
    shape = (height, width) if channels == 1 else (height, width, channels)
    palette = next((np.frombuffer(body, np.uint8).reshape(-1, 3) for kind, body in chunks if kind == b"PLTE"), None)
    return rows.reshape(shape), palette, [body for kind, body in chunks if kind == b"iTXt"]


# ---- PNG


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
@pytest.mark.parametrize("shape", [(1, 1), (3, 5), (4, 7, 3), (5, 3, 4)])
def test_png_keeps_every_value(dtype, shape):
    pixels_in = np.random.default_rng(1).integers(0, np.iinfo(dtype).max, shape, dtype, endpoint=True)
    decoded, palette, _ = decode_png(encode_png(pixels_in))
    assert palette is None
    np.testing.assert_array_equal(decoded[::-1], pixels_in)  # the array's row 0 is the picture's bottom


def test_png_palette_and_text():
    index = np.array([[0, 1], [2, 0]], np.uint8)
    colors = ((1, 2, 3), (4, 5, 6), (7, 8, 9))
    decoded, palette, texts = decode_png(encode_png(index, palette=colors, text={"Light": "Lüster"}))
    np.testing.assert_array_equal(decoded[::-1], index)
    assert palette.tolist() == [list(color) for color in colors]
    assert texts == [b"Light\0\0\0\0\0" + "Lüster".encode()]


@pytest.mark.parametrize(
    "bad", [np.zeros((2, 2), np.float32), np.zeros((2, 2, 2), np.uint8), np.zeros((0, 4), np.uint8)]
)
def test_png_refuses_other_arrays(bad):
    with pytest.raises(ValueError, match="PNG needs uint8 or uint16"):
        encode_png(bad)


# ---- pictures


def test_layer_picture_rounds_and_survives_bad_values():
    layer = np.array([[0.0, 0.5, 1.0, 2.0, -1.0, np.nan, np.inf]], np.float32)
    for depth, top in ((8, 255), (16, 65535)):
        decoded, _, _ = decode_png(pictures.make_layer_png(layer, depth=depth))
        assert decoded[0].tolist() == [0, round(top / 2), top, top, 0, 0, top]
    assert decode_png(pictures.make_layer_png(layer[..., None]))[0].shape == (1, 7)


def test_difference_picture_has_the_color_of_each_fault():
    truth = np.array([[True, False, True, False, True, False, True]])
    classes = pixels.PixelClasses(np.array([[pixels.COMPARABLE] * 6 + [0]], np.uint8))
    faults = np.array([[0, 0, measures.WRONG_SHADOW, measures.WRONG_LIGHT, measures.ACNE, measures.LEAK, 0]], np.uint8)
    decoded, palette, _ = decode_png(pictures.make_difference_png(truth, classes, faults))
    labels = [label for _, label in pictures.DIFFERENCE_COLORS]
    assert [labels[index].split(",")[0].split(":")[0] for index in decoded[0]] == [
        "light", "shadow", "false shadow at a border", "false light at a border", "acne", "leak", "not compared",
    ]  # fmt: skip
    assert len({tuple(color) for color in palette.tolist()}) == len(labels)


def test_truth_picture_is_grey_where_nothing_is_compared():
    classes = pixels.PixelClasses(np.array([[pixels.COMPARABLE, pixels.COMPARABLE, 2]], np.uint8))
    decoded, palette, _ = decode_png(pictures.make_truth_png(np.array([[True, False, True]]), classes))
    assert [tuple(palette[index]) for index in decoded[0]][:2] == [(255, 255, 255), (0, 0, 0)]
    assert tuple(palette[decoded[0, 2]]) == pictures.PALETTE[pictures.EXCLUDED_INDEX]


# ---- FLIP


def test_flip_of_equal_and_of_different_pictures():
    if not flip.is_flip_available():
        assert flip.compute_mean_flip(np.ones((8, 8)), np.ones((8, 8), bool), np.ones((8, 8), bool)) is None
        pytest.skip("flip-evaluator is not installed")
    truth = np.zeros((40, 60), bool)
    truth[:, 30:] = True
    everywhere = np.ones_like(truth)
    assert flip.compute_mean_flip(truth.astype(np.float32), truth, everywhere) == 0.0
    moved = np.roll(truth, 2, axis=1).astype(np.float32)
    assert flip.compute_mean_flip(moved, truth, everywhere) > 0.01
    assert flip.compute_mean_flip(moved, truth, np.zeros_like(truth)) == 0.0  # nothing is compared


# ---- table and page


def make_record(technique, wrong=0.01, **changes):
    values = {info.id: wrong for info in measures.MEASURES}
    return {
        "light": "Key <b>", "technique": technique, "frame": 1, "measures": values, "flip": None, "pixel_count": 1000,
        "excluded": {cause: 0 for cause in pixels.EXCLUSION_CAUSES} | {"background": 77},
        "time_ms": {"depth_map": {"cpu": 3.5, "gl": 1.5}, "fit": {"cpu": 1.25, "gl": None}},
        "total_ms": 4.75, "settings": {"map_size": 1024},
        "truth_ms": {"shadows_on": 30.0, "shadows_off": 17.5, "total": 47.5}, "truth_cached": True, **changes,
    }  # fmt: skip


def make_light(*records):
    png = encode_png(np.zeros((9, 16), np.uint8))
    entries = [report.TechniqueEntry(record, png, png) for record in records]
    return report.LightEntry("Key <b>", "SUN", 1, png, entries)


class PageReader(HTMLParser):
    """Checks that tags nest, and gathers what the page shows and loads."""

    void = {"meta", "img", "br", "link", "input"}  # noqa: RUF012

    def __init__(self):
        super().__init__()
        self.open, self.sources, self.text, self.ids, self.links = [], [], [], [], []

    def handle_starttag(self, tag, attributes):
        if tag not in self.void:
            self.open.append(tag)
        for name, value in attributes:
            if name == "src":
                self.sources.append(value)
            elif name == "id":
                self.ids.append(value)
            elif name == "href":
                self.links.append(value)

    def handle_endtag(self, tag):
        assert self.open and self.open.pop() == tag

    def handle_data(self, data):
        if not self.open or self.open[-1] not in ("style", "script"):
            self.text.append(data)


def read_page(lights, notes=(), temporal_records=()):
    page = report.build_page("Title & more", {"Blender": "4.5"}, lights, notes, temporal_records)
    reader = PageReader()
    reader.feed(page)
    reader.close()
    assert not reader.open
    return page, reader


def test_page_is_whole_and_needs_no_network():
    page, reader = read_page([make_light(make_record("sm", 0.02), make_record("edsm", 0.001))], ["A note."])
    assert len(reader.sources) == 1 + 2 * 2
    for source in reader.sources:
        assert source.startswith("data:image/png;base64,")
        decode_png(base64.b64decode(source.split(",")[1]))
    without_data = re.sub(r"data:image/png;base64,[^\"]+", "", page)
    assert not re.search(r"https?://|@import|url\(|<link|<script src", without_data)
    assert {link.removeprefix("#") for link in reader.links} == set(reader.ids)
    text = " ".join(reader.text)
    assert "A note." in text and "Title & more" in text and "Key <b>" in text  # escaped, so shown as it is


def test_page_shows_every_measure_with_its_unit():
    _, reader = read_page([make_light(make_record("sm", 0.0123))])
    text = " ".join(reader.text)
    assert text.count("1.230 %") >= 2 * 3  # three fractions, in the summary and beside the pictures
    assert "0.01 px" in text and "+0.01230" in text and "77" in text and f"10.0{report.TIMES}" in text
    for info in measures.MEASURES:
        assert info.label in text


def test_truth_and_its_error_are_shown():
    truth = {"kind": "soft", "standard_error": {"rms": 0.01234, "bias": 0.0001}}
    light = make_light(make_record("edtsm", truth=truth))
    light.truth = "soft"
    text = " ".join(read_page([light])[1].text)
    assert "soft \N{PLUS-MINUS SIGN} 0.0123" in text and "0.01234" in text
    assert "\N{PLUS-MINUS SIGN}" not in " ".join(read_page([make_light(make_record("sm"))])[1].text)
    lines = table.format_table([make_record("edtsm", truth=truth), make_record("sm")]).splitlines()
    assert lines[1].split()[lines[0].split().index("truth") + 2] == "0.01234"  # the light's name has a space
    assert lines[2].split()[4:6] == ["hard", "-"]


def make_temporal_record(technique, value, **changes):
    return {
        "light": "Key <b>", "technique": technique, "truth": "soft", "truth_standard_error": 0.0125, "move": "light",
        "step_deg": 0.1, "frames": 8, "pixel_count": 7000,
        "measures": {info.id: value for info in temporal.TEMPORAL_MEASURES}, **changes,
    }  # fmt: skip


def test_page_shows_changes_from_frame_to_frame():
    records = [make_temporal_record("sm", 0.04321), make_temporal_record("edsm", None)]
    _, reader = read_page([make_light(make_record("sm"))], temporal_records=records)
    text = " ".join(reader.text)
    assert "the lights moved, 8 frames, 0.1\N{DEGREE SIGN} each" in text and "soft \N{PLUS-MINUS SIGN} 0.0125" in text
    assert text.count("0.04321") == len(temporal.TEMPORAL_MEASURES)
    own = make_temporal_record("sm", 0.5, move="frames", step_deg=None, truth_standard_error=None)
    assert "the scene's own frames, 8 frames" in " ".join(read_page([], temporal_records=[own])[1].text)
    assert "From frame to frame" not in read_page([make_light(make_record("sm"))])[0]


def test_table_of_changes_has_a_line_per_record():
    records = [make_temporal_record("sm", 0.04321), make_temporal_record("edsm", None)]
    lines = table.format_temporal_table(records).splitlines()
    assert len(lines) == 3 and "0.04321" in lines[1] and lines[2].split()[-1] == "-"
    assert all(info.label in lines[0] for info in temporal.TEMPORAL_MEASURES)


def test_page_of_undefined_measures_and_no_lights():
    nothing = make_record("sm", None, truth_ms={}, total_ms=0.0)
    _, reader = read_page([make_light(nothing)])
    assert "nothing to compare" in " ".join(reader.text)
    read_page([])


def test_best_technique_is_marked():
    light = make_light(make_record("sm", 0.02), make_record("edsm", 0.001))
    assert report.find_best(light).record["technique"] == "edsm"
    assert report.find_best(make_light(make_record("sm"))) is None


@pytest.mark.parametrize(
    ("value", "grade"), [(0.0, "good"), (0.002, "good"), (0.005, "fair"), (0.02, "bad"), (None, "")]
)
def test_grades(value, grade):
    assert report.get_grade("misclassified_fraction", value) == grade
    assert report.get_grade("mae", value) == ""


def test_table_has_a_line_per_record():
    lines = table.format_table([make_record("sm", 0.0123), make_record("edsm", None)]).splitlines()
    assert len(lines) == 3
    assert len({line.find("wrong %") + len("wrong %") for line in lines[:1]}) == 1
    assert "1.2300" in lines[1] and "edsm" in lines[2] and " - " in lines[2]
