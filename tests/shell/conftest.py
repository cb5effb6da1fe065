"""The course's package, as a learner lays it out."""

from pathlib import Path

import pytest

from sim.packages import Packages, find_packages

_SETUP = """
from setuptools import setup

setup(
    name="unit5_pkg",
    packages=["unit5_pkg"],
    data_files=[("share/unit5_pkg/launch", ["launch/exercise51.launch.py"])],
    entry_points={"console_scripts": [
        "callback_groups_examples = unit5_pkg.callback_groups_examples:main",
        "exercise51 = unit5_pkg.exercise51:main",
    ]},
)
"""
_MANIFEST = "<package><name>unit5_pkg</name><version>0.1.0</version></package>\n"


@pytest.fixture
def packages(tmp_path: Path) -> Packages:
    root = tmp_path / "src" / "unit5_pkg"
    for name, text in {
        "package.xml": _MANIFEST,
        "setup.py": _SETUP,
        "launch/exercise51.launch.py": "",
        "unit5_pkg/__init__.py": "",
        "unit5_pkg/callback_groups_examples.py": "",
        "unit5_pkg/exercise51.py": "",
    }.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return find_packages(tmp_path / "src")
