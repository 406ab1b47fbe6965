# SPDX-License-Identifier: GPL-3.0-or-later
"""What describes packages says the same as pyproject.toml, also where nobody builds it."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

if sys.version_info >= (3, 11):
    import tomllib
else:
    tomllib = pytest.importorskip("tomli")

ROOT = Path(__file__).resolve().parents[3]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
CI = ROOT / ".ci"

pytestmark = pytest.mark.skipif(not CI.is_dir(), reason="not the sources")

# Libraries of the core as Debian and conda-forge name them.
LIBRARIES = {
    "libcgal-dev": "cgal-cpp",
    "libeigen3-dev": "eigen",
    "libflann-dev": "flann",
    "libgmp-dev": "gmp",
    "liblz4-dev": "lz4-c",
    "libmpfr-dev": "mpfr",
    "libtbb-dev": "tbb-devel",
}


def section(name):
    """Requirements of the recipe, by name."""
    recipe = (CI / "conda" / "meta.yaml").read_text(encoding="utf-8")
    block = re.search(rf"(?m)^  {name}:\n((?:    - .*\n)+)", recipe)[1]
    rows = re.findall(r"(?m)^    - (\S+)(?: (\S+))?$", block)
    return {package: version for package, version in rows if package != "{{"}


def by_name(requirements):
    split = (re.match(r"([\w-]+)(.*)", entry) for entry in requirements)
    return {found[1]: found[2] for found in split}


def test_the_recipe_needs_what_the_package_needs():
    run = section("run")
    assert run.pop("python") == ""
    assert run == by_name(PROJECT["project"]["dependencies"])
    host = section("host")
    built_by = by_name(PROJECT["build-system"]["requires"])
    assert {name: host[name] for name in built_by} == built_by


def test_libraries_are_those_of_debian():
    script = (CI / "system-packages.sh").read_text(encoding="utf-8")
    wanted = set(re.findall(r"\blib\w+-dev\b", script)) - {"libgtest-dev"}
    assert wanted == set(LIBRARIES)
    host = section("host").keys() - by_name(PROJECT["build-system"]["requires"]).keys()
    assert host - {"python", "pip"} == set(LIBRARIES.values())
    wheels = (
        (CI / "wheel-libraries.sh")
        .read_text(encoding="utf-8")
        .split("conda-forge \\\n")
    )
    assert set(re.findall(r"[a-z][\w-]+", wheels[1])) == set(LIBRARIES.values())


def test_lowest_versions_of_libraries_are_those_of_cmake():
    cmake = (ROOT / "cpp" / "cmake" / "dependencies.cmake").read_text(encoding="utf-8")
    lowest = dict(re.findall(r"remanifold_find_package\(\w+ (\S+) ([\d.]+)", cmake))
    host = section("host")
    for package, version in lowest.items():
        assert host[LIBRARIES[package]] == f">={version}"
    stated = re.search(
        r"cmake_minimum_required\(VERSION (\d+\.\d+)",
        (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"),
    )
    assert section("build")["cmake"] == f">={stated[1]}"


def test_the_recipe_has_the_version_of_the_project():
    recipe = (CI / "conda" / "meta.yaml").read_text(encoding="utf-8")
    project = (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")
    version = re.search(r"(?s)project\([^)]*?\bVERSION\s+([\d.]+)", project)[1]
    assert f'"REMANIFOLD_VERSION", "{version}"' in recipe
    assert PROJECT["project"]["license"] in recipe


def test_wheels_are_built_for_every_python_that_is_tested():
    wheels = PROJECT["tool"]["cibuildwheel"]
    built = re.findall(r"cp3(\d+)-", wheels["build"])
    script = (CI / "wheel.sh").read_text(encoding="utf-8")
    tried = re.search(r"for minor in ([\d ]+); do", script)[1].split()
    assert built == tried
    assert PROJECT["project"]["requires-python"] == f">=3.{built[0]}"
    assert wheels["linux"]["archs"] == ["x86_64", "aarch64"]
    for system in ("linux", "macos", "windows"):
        into = re.search(r"wheel-libraries.sh (\S+)", wheels[system]["before-all"])[1]
        assert wheels[system]["environment"]["CMAKE_PREFIX_PATH"].startswith(into)


@pytest.mark.parametrize("script", sorted(CI.glob("*.sh")), ids=lambda path: path.name)
def test_scripts_can_be_read(script):
    subprocess.run(["bash", "-n", str(script)], check=True)
