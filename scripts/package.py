#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the two zips that Blender installs: the extension (4.2 and later) and the add-on (before 4.2).

    scripts/package.py [--out DIR]        (default: out/package)

Both hold the same files: the add-on, the native module, the shaders and the licence. The extension has its manifest at
the top of the zip; the add-on lies in a folder and has no manifest. The version is CMakeLists.txt's in both. The
contents are sorted and carry one date, so that the same sources give the same bytes.
"""

import argparse
import os
import re
import sys
import tempfile
import zipfile
from pathlib import Path

root = Path(__file__).resolve().parent.parent
build = Path(os.environ.get("SHADOW_LAYERS_BUILD", root / "build" / "release")).resolve()
kPackageName = "shadow_layers"  # folder of the legacy zip, id of the extension
kLeftOut = re.compile(r"(^|/)(__pycache__|\..*)(/|$)|\.(pyc|pyi|blend1?)$")
kDate = (2026, 1, 1, 0, 0, 0)


class PackageError(Exception):
    """The text names what is missing and the remedy."""


def read_version() -> str:
    text = (root / "CMakeLists.txt").read_text(encoding="utf-8")
    match = re.search(r"^project\(\w+ VERSION (\d+\.\d+\.\d+)", text, re.M)
    if not match:
        raise PackageError("CMakeLists.txt has no line 'project(NAME VERSION x.y.z ...)'")
    return match[1]


def find_module() -> Path:
    modules = sorted((build / "python").glob("shadow_core*.so"))
    if len(modules) != 1:
        raise PackageError(f"{build / 'python'} holds {len(modules)} native modules, one is needed: run 'make build'")
    return modules[0]


def with_version(name: str, text: str, version: str) -> str:
    """The text of a file with the product's version written in, where it states one."""
    numbers = ", ".join(version.split("."))
    patterns = {
        "__init__.py": (r'("version": )\([^)]*\)', rf"\g<1>({numbers})"),
        "blender_manifest.toml": (r'(?m)^(version = )"[^"]*"', rf'\g<1>"{version}"'),
    }
    if name not in patterns:
        return text
    changed, count = re.subn(*patterns[name], text)
    if count != 1:
        raise PackageError(f"addon/{name} states the version {count} times, once is right")
    return changed


def collect(version: str) -> dict[str, bytes]:
    """Contents by path inside the add-on's folder."""
    files: dict[str, bytes] = {}
    for folder, prefix in ((root / "addon", ""), (root / "shaders", "shaders/")):
        for path in sorted(folder.rglob("*")):
            inside = path.relative_to(folder).as_posix()
            if path.is_file() and not kLeftOut.search(inside):
                data = path.read_bytes()
                if not prefix and inside in ("__init__.py", "blender_manifest.toml"):
                    data = with_version(inside, data.decode("utf-8"), version).encode("utf-8")
                files[prefix + inside] = data
    module = find_module()
    files[f"native/{module.name}"] = module.read_bytes()
    files["LICENSE"] = (root / "LICENSE").read_bytes()
    for needed in ("__init__.py", "blender_manifest.toml", "shaders/shared/conventions.h"):
        if needed not in files:
            raise PackageError(f"{needed} is missing in the sources; the package would not work")
    return files


def write_zip(path: Path, files: dict[str, bytes]) -> None:
    """The zip under its final name only when it is whole."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.NamedTemporaryFile(dir=path.parent, prefix=f".{path.name}.", delete=False) as half:
        try:
            with zipfile.ZipFile(half, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
                for name in sorted(files):
                    entry = zipfile.ZipInfo(name, kDate)
                    entry.compress_type = zipfile.ZIP_DEFLATED
                    entry.external_attr = 0o644 << 16
                    archive.writestr(entry, files[name])
            os.chmod(half.name, 0o644)
            os.replace(half.name, path)
        except BaseException:
            Path(half.name).unlink(missing_ok=True)
            raise


def make_packages(out: Path) -> tuple[Path, Path]:
    """Writes both zips into `out` and returns (extension, legacy). Raises PackageError."""
    version = read_version()
    files = collect(version)
    extension = out / f"{kPackageName}-{version}-linux-x64.zip"
    legacy = out / f"{kPackageName}-{version}-linux-x64-blender-3.4.zip"
    write_zip(extension, files)
    write_zip(
        legacy, {f"{kPackageName}/{name}": data for name, data in files.items() if name != "blender_manifest.toml"}
    )
    return extension, legacy


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=root / "out" / "package", help="folder (default: out/package)")
    options = parser.parse_args()
    try:
        packages = make_packages(options.out)
    except (PackageError, OSError) as error:
        print(f"[package] error: {error}", file=sys.stderr)
        return 1
    for package in packages:
        print(f"[package] {package} ({package.stat().st_size / 1e6:.1f} MB)")
    return 0


if __name__ == "__main__":
    sys.exit(main())
