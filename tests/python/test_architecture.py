# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The import rules of ARCHITECTURE.md, read from the sources."""

import ast
import re
import subprocess

import pytest

NATIVE_MODULE = "shadow_core"


def tracked(root, *patterns):
    """Files that are in the repository, or would be added to it."""
    command = ["git", "-C", str(root), "ls-files", "-co", "--exclude-standard", *patterns]
    names = subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()
    return sorted(root / name for name in set(names) if (root / name).is_file())


def imported_modules(path):
    """Absolute names of what a Python file imports anywhere in it; relative imports begin with dots."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"), str(path))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            prefix = "." * node.level + (node.module or "")
            yield prefix
            if node.module is None:
                yield from (prefix + alias.name for alias in node.names)
        elif isinstance(node, ast.Call) and node.args and isinstance(node.args[0], ast.Constant):
            name = getattr(node.func, "attr", getattr(node.func, "id", ""))
            if name in ("import_module", "__import__") and isinstance(node.args[0].value, str):
                yield node.args[0].value


def imports(path, package):
    return any(re.fullmatch(rf"\.*{package}(\..*)?", name) for name in imported_modules(path))


def test_imports_are_found_wherever_they_stand(tmp_path):
    source = tmp_path / "a.py"
    source.write_text(
        "import os.path as p\nfrom . import names\nfrom ..b import c\ndef f():\n    import bpy.types\n"
        "    importlib.import_module('gpu')\n"
    )
    assert list(imported_modules(source)) == ["os.path", ".", ".names", "..b", "bpy.types", "gpu"]
    assert imports(source, "bpy") and imports(source, "gpu") and not imports(source, "bmesh")


@pytest.fixture(scope="module")
def python_files(root):
    files = tracked(root, "*.py")
    assert len(files) > 20
    return files


def test_only_these_modules_import_blender(root, python_files):
    users_allowed = [root / "addon", root / "test_scenes", root / "tests" / "blender"]
    free = [root / "addon" / "compare", root / "addon" / "snapshot.py", root / "addon" / "names.py"]
    users = [
        path
        for path in python_files
        if any(imports(path, name) for name in ("bpy", "bmesh", "gpu", "mathutils", "idprop"))
    ]
    assert users
    for path in users:
        assert any(path.is_relative_to(folder) for folder in users_allowed), f"{path} imports Blender"
        assert not any(path.is_relative_to(folder) for folder in free), f"{path} must do without Blender"


def names_the_native_module(path):
    """Imports it, or holds its name as a string (to load it by path)."""
    if imports(path, NATIVE_MODULE):
        return True
    nodes = ast.walk(ast.parse(path.read_text(encoding="utf-8")))
    return any(isinstance(node, ast.Constant) and node.value == NATIVE_MODULE for node in nodes)


def test_one_file_of_the_add_on_loads_the_native_module(root, python_files):
    users = [path for path in python_files if names_the_native_module(path)]
    assert [path for path in users if path.is_relative_to(root / "addon")] == [root / "addon" / "bridge.py"]
    for path in users:
        assert path.relative_to(root).parts[0] in ("addon", "tests", "scripts"), f"{path} imports {NATIVE_MODULE}"
    assert not any(imports(path, NATIVE_MODULE) for path in python_files if path.is_relative_to(root / "test_scenes"))


def test_measures_and_snapshots_stand_alone(root, python_files):
    """NumPy, the standard library and each other; nothing of the add-on that may lead to Blender."""
    addon = root / "addon"
    plain = [path for path in python_files if path.parent == addon / "compare" or path == addon / "snapshot.py"]
    assert len(plain) > 5
    for path in plain:
        depth = len(path.relative_to(addon).parts)  # as many dots lead to the add-on's own modules
        for name in imported_modules(path):
            dots = len(name) - len(name.lstrip("."))
            assert dots <= depth, f"{path} reaches out of the add-on: {name}"
            if dots == depth:
                assert name.lstrip(".").split(".")[0] in ("snapshot", "names", ""), f"{path} imports {name}"
            assert not name.startswith(("bpy", NATIVE_MODULE, "addon"))


# --- C++: which module may include which, from the table in ARCHITECTURE.md ---

BELOW = {
    "base": set(),
    "scene": {"base"},
    "context": {"base"},
    "gl": {"context", "base"},
    "frame": {"gl", "scene", "base", "engine", "context"},
    "lights": {"frame", "scene", "base"},
    "engine": {"base", "scene", "context", "gl"},
    "visibility": {"engine", "lights", "frame", "scene", "base"},
    "stages": {"engine", "gl", "lights", "frame", "scene", "base"},
    "techniques": {"stages", "visibility", "engine", "gl", "lights", "frame", "scene", "base"},
    "session": {"techniques", "stages", "engine", "gl", "context", "lights", "frame", "scene", "base"},
    "truth": {"lights", "frame", "scene", "base"},
    "io": set(),
    "cli": {"io", "truth"},
    "bindings": set(),
    "include": set(),
}
INCLUDE = re.compile(r'^\s*#\s*include\s*(?:"([^"]+)"|<([^>]+)>)', re.MULTILINE)


def native_files(root):
    files = [path for path in tracked(root, "native/*.h", "native/*.cpp") if path.suffix in (".h", ".cpp")]
    assert len(files) > 30
    return files


def includes(path):
    for quoted, angled in INCLUDE.findall(path.read_text(encoding="utf-8")):
        yield quoted or angled


def module_of(root, path):
    return path.relative_to(root / "native").parts[0]


def test_every_native_module_is_in_the_table(root):
    modules = {module_of(root, path) for path in native_files(root)}
    assert modules <= set(BELOW)
    text = (root / "ARCHITECTURE.md").read_text(encoding="utf-8")
    for module in modules:
        assert f"`native/{module}/" in text, f"ARCHITECTURE.md does not name native/{module}/"


def test_native_modules_include_only_what_is_below_them(root):
    wrong = []
    for path in native_files(root):
        module = module_of(root, path)
        for name in includes(path):
            first = name.split("/")[0]
            if "/" in name and first in BELOW and first != module and first not in BELOW[module]:
                wrong.append(f"{path.relative_to(root)} includes {name}")
    assert wrong == []


def test_the_truth_shares_nothing_with_what_it_judges(root):
    """Facing, casting and occlusion are restated in native/truth/; common are plain data and the light's samples."""
    judged = re.compile(r"(visibility|stages|techniques|engine)/|lights/(facing|receiver_scan|view_casters|map_fit)")
    files = [path for path in native_files(root) if module_of(root, path) == "truth"]
    assert files
    assert [f"{p.name}: {name}" for p in files for name in includes(p) if judged.match(name)] == []


LIBRARIES = {
    r"OpenImageIO/|tiny_gltf|tiny_obj_loader|zip\.h|nlohmann/": {"io", "cli"},
    r"CLI/": {"cli"},
    r"pybind11/|Python\.h": {"bindings"},
    r"glad/": {"gl", "engine", "context"},
    r"xxhash": {"base"},
    r"embree": {"truth"},
    r"tbb/|GL/gl\.h|EGL/": {"nowhere"},
}


def test_libraries_are_used_in_their_modules_only(root):
    wrong = []
    for path in native_files(root):
        for name in includes(path):
            for pattern, modules in LIBRARIES.items():
                if re.match(pattern, name) and module_of(root, path) not in modules:
                    wrong.append(f"{path.relative_to(root)} includes {name}")
    assert wrong == []


def test_io_cli_and_bindings_see_public_headers_only(root):
    for path in native_files(root):
        module = module_of(root, path)
        if module not in ("io", "cli", "bindings", "include"):
            continue
        for name in includes(path):
            first = name.split("/")[0]
            assert first not in BELOW or first in (module, "include") or first in BELOW[module], (
                f"{path} includes {name}"
            )


def technique_ids(root):
    return sorted(path.name for path in (root / "native" / "techniques").iterdir() if path.is_dir())


def test_a_technique_never_meets_another(root):
    ids = technique_ids(root)
    assert {"sm", "pcf", "edsm", "probe"} <= set(ids)
    for path in native_files(root):
        parts = path.relative_to(root / "native").parts
        for name in includes(path):
            match = re.match(r"techniques/(\w+)/", name)
            if match:
                own = parts[0] == "techniques" and len(parts) == 3 and parts[1] == match[1]
                assert own or parts == ("techniques", "registry.cpp"), f"{path} includes {name}"


def test_shaders_of_a_technique_include_their_own_and_shared_ones(root):
    ids = technique_ids(root)
    shaders = [
        path
        for path in tracked(root, "shaders/*")
        if path.suffix in (".glsl", ".vert", ".frag", ".geom", ".comp", ".h")
    ]
    assert shaders
    for path in shaders:
        parts = path.relative_to(root / "shaders").parts
        for name in includes(path):
            match = re.search(r"techniques/(\w+)/", name)
            if match:
                assert parts[:2] == ("techniques", match[1]), f"{path} includes {name}"
            elif parts[0] in ("lib", "shared"):
                assert not re.match(r"(\.\./)*(frame|stages|techniques)/", name), f"{path} includes {name}"
        if parts[0] == "techniques":
            assert parts[1] in ids, f"{path} belongs to no technique"


def find_owners(root):
    """Of every file in a shared folder, the techniques that lead to it, by `#include` or by its path as text."""
    files = [
        path
        for path in [*tracked(root, "shaders/*"), *native_files(root)]
        if path.suffix in (".glsl", ".vert", ".frag", ".geom", ".comp", ".h", ".cpp")
    ]
    names = {}  # by every path that a file may be called by: whose text is read when it is used
    for path in files:
        inside = path.relative_to(root).parts[1:]
        names.setdefault("/".join(inside), set()).add(path)
        names.setdefault("/".join(inside[:-1]) + "/", set()).add(path)  # a folder that file names are put behind
        if inside[0] == "shared":
            names.setdefault("/".join(inside[1:]), set()).add(path)
    uses = {}
    for path in files:
        if path.name == "registry.cpp":
            continue
        quoted = re.findall(r'"([\w./]+(?:\.(?:glsl|vert|frag|geom|comp|h)|/))"', path.read_text(encoding="utf-8"))
        uses[path] = set().union(*(names.get(name, names.get(f"{path.parent.name}/{name}", set())) for name in quoted))
        if path.suffix == ".h" and path.with_suffix(".cpp") in files:
            uses[path].add(path.with_suffix(".cpp"))  # what a header declares is done there

    owners = {path: set() for path in files if path.relative_to(root).parts[1] in ("lib", "shared", "stages")}
    for technique in technique_ids(root):
        todo = [path for path in files if path.relative_to(root).parts[1:3] == ("techniques", technique)]
        met = set(todo)
        while todo:
            new = uses.get(todo.pop(), set()) - met
            met |= new
            todo += new
        for path in met & set(owners):
            owners[path].add(technique)
    return {path.relative_to(root).as_posix(): found for path, found in owners.items() if path.suffix != ".cpp"}


# Tools of their own right, with a page, a test and a benchmark: docs/distance-transform.md.
GENERAL_STAGES = re.compile(r"(shaders|native)/\w+/(distance_transform\w*|nearest_site\w*)[./]")


def test_what_one_technique_alone_uses_lies_in_its_folder(root):
    owners = find_owners(root)
    assert {"sm", "pcf", "edsm", "vsm"} <= owners["shaders/lib/projection_lib.glsl"]
    assert "edsm" in owners["shaders/shared/edge_map.h"] and "sm" not in owners["shaders/shared/edge_map.h"]
    assert owners["shaders/shared/nearest_site.h"] == {"edtsm"}
    wrong = {path: found for path, found in owners.items() if len(found) == 1 and not GENERAL_STAGES.match(path)}
    assert wrong == {}, "move them to techniques/<id>/"


def test_techniques_are_named_in_no_other_list(root):
    """UI, command lines and tools come from the descriptors: no product file beside the technique's own names it."""
    allowed = {"DEFAULT_TECHNIQUES"}  # which of those that are there a new scene begins with
    named = re.compile(r"""["'](edsm|pcf|probe)["']""")
    product = [*tracked(root, "addon/*.py"), *native_files(root)]
    wrong = []
    for path in product:
        parts = path.relative_to(root).parts
        if parts[:2] == ("native", "techniques"):
            continue
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            if any(name in line for name in allowed):
                continue
            if named.search(line) and not line.lstrip().startswith(("#", "//", "*", "///")):
                wrong.append(f"{path.relative_to(root)}:{number}: {line.strip()}")
    assert wrong == []


def test_every_technique_has_its_shaders_docs_and_one_line_each(root):
    registry = (root / "native" / "techniques" / "registry.cpp").read_text(encoding="utf-8")
    tolerances = (root / "tests" / "tolerances.toml").read_text(encoding="utf-8")
    for technique in technique_ids(root):
        assert len(re.findall(rf"make_{technique}\b", registry)) == 1, technique
        assert (root / "docs" / "techniques" / f"{technique}.md").is_file(), technique
        assert re.search(rf"\b{technique}\b", tolerances), technique


def test_every_source_file_begins_with_its_licence(root):
    for path in tracked(
        root,
        "*.py",
        "*.pyi",
        "*.cpp",
        "*.h",
        "*.glsl",
        "*.vert",
        "*.frag",
        "*.geom",
        "*.comp",
        "*.cmake",
        "*.sh",
        "*CMakeLists.txt",
    ):
        head = path.read_text(encoding="utf-8").splitlines()[:4]
        assert any("SPDX-FileCopyrightText" in line for line in head), path
        assert any("SPDX-License-Identifier: GPL-3.0-or-later" in line for line in head), path
