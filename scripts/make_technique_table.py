#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes docs/techniques.md from the core's descriptors (`shadowcore info --json FILE`).

scripts/make_technique_table.py INFO.json [docs/techniques.md]
"""

import json
import sys
from pathlib import Path

root = Path(__file__).resolve().parent.parent


def describe_range(parameter: dict) -> str:
    kind = parameter["type"]
    if kind == "bool":
        return "on, off"
    if kind == "enum":
        return ", ".join(f"`{item['id']}`" for item in parameter["items"])
    unit = f" {parameter['unit']}" if parameter["unit"] else ""
    step = f", steps of {parameter['step']:g}" if kind == "int" and parameter["step"] > 1 else ""
    return f"{parameter['min']:g} … {parameter['max']:g}{unit}{step}"


def describe_default(parameter: dict) -> str:
    value = parameter["default"]
    if isinstance(value, bool):
        return "on" if value else "off"
    return f"`{value:g}`" if isinstance(value, float) else f"`{value}`"


def make_page(techniques: list[dict]) -> str:
    lines = [
        "# The techniques",
        "",
        "Made by `make docs` from the descriptors in `native/techniques/`; don't edit it by hand.",
        "",
        "| technique | what it does | lights | limits |",
        "| --- | --- | --- | --- |",
    ]
    for info in techniques:
        lights = ", ".join(kind.lower() for kind in info["lights"])
        page = f"[{info['label']}](techniques/{info['id']}.md) (`{info['id']}`)"
        lines.append(f"| {page} | {info['summary']} | {lights} | {info['limits']} |")
    for info in techniques:
        lines += ["", f"## {info['label']} (`{info['id']}`)", ""]
        lines += [f"Source: {info['reference']} ([references](references.bib)).", ""]
        lines += ["| parameter | default | range | meaning |", "| --- | --- | --- | --- |"]
        for parameter in info["parameters"]:
            shared = " (shared by all techniques that have it)" if parameter["shared"] else ""
            lines.append(
                f"| `{parameter['id']}` | {describe_default(parameter)} | {describe_range(parameter)} "
                f"| {parameter['help']}{shared} |"
            )
        outputs = "; ".join(f"`{output['id']}`: {output['help']}" for output in info["outputs"])
        lines += ["", f"Outputs: {outputs}."]
    return "\n".join(lines) + "\n"


def main() -> int:
    if len(sys.argv) not in (2, 3):
        print(__doc__, file=sys.stderr)
        return 2
    document = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    page = Path(sys.argv[2]) if len(sys.argv) == 3 else root / "docs" / "techniques.md"
    page.write_text(make_page([info for info in document["techniques"] if not info["test_only"]]), encoding="utf-8")
    print(f"[docs] {page}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
