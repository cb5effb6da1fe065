"""Packages: what is read from their files without building them, and where they are looked for."""

from pathlib import Path, PurePosixPath

import pytest

from sim.packages import PackageError, UnknownPackageError, find_packages
from sim.packages.errors import UnknownExecutableError
from sim.packages.setup_file import EntryPoint
from tests.launch.fakes import make_package
from tests.support.nobody import close


def _with_setup(tmp_path: Path, text: str) -> Path:
    root = make_package(tmp_path)
    (root / "setup.py").write_text(text)
    return root


def test_entry_points_and_share_files_are_read_from_a_course_setup_file(tmp_path: Path) -> None:
    root = make_package(tmp_path)
    (root / "launch" / "a.launch.py").touch()
    package = find_packages(root).package("unit5_pkg")
    entry = package.executables["exercise51"]
    assert isinstance(entry, EntryPoint)
    assert (entry.module, entry.function) == ("unit5_pkg.exercise51", "main")
    assert package.launch_files == ["a.launch.py"]
    assert set(package.share_files) == {
        PurePosixPath("package.xml"),
        PurePosixPath("launch/a.launch.py"),
        PurePosixPath("config/speeds.yaml"),
    }


@pytest.mark.parametrize("place", ["", "src", "src/unit5_pkg", "src/unit5_pkg/unit5_pkg/exercise51.py"])
def test_packages_are_found_from_anywhere_in_a_workspace(tmp_path: Path, place: str) -> None:
    make_package(tmp_path)
    make_package(tmp_path, "other_pkg")
    assert find_packages(tmp_path / place).names == ["other_pkg", "unit5_pkg"]


def test_a_folder_of_somebody_elses_alone_holds_no_packages(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    make_package(tmp_path)
    (tmp_path / "closed").mkdir()
    close(tmp_path / "closed", monkeypatch)
    assert find_packages(tmp_path).names == ["unit5_pkg"]


def test_the_first_of_two_packages_of_one_name_counts_and_it_is_told(tmp_path: Path) -> None:
    first, second = make_package(tmp_path / "a"), make_package(tmp_path / "b")
    found = find_packages([first, second])
    assert found.package("unit5_pkg").root == first
    assert found.notes == [f"package 'unit5_pkg' is in {first} and in {second}; the first one counts"]


def test_the_share_folder_holds_what_is_installed_and_nothing_else(tmp_path: Path) -> None:
    root = make_package(tmp_path)
    (root / "config" / "map.png").touch()
    package = find_packages(root).package("unit5_pkg")
    share = package.share
    assert (share / "config" / "speeds.yaml").read_text().startswith("/**")
    assert not (share / "config" / "map.png").exists()
    package.close()
    assert not share.exists()


def test_a_launch_file_that_is_not_installed_is_told_as_such(tmp_path: Path) -> None:
    root = make_package(tmp_path)
    (root / "launch" / "odd.py").touch()
    package = find_packages(root).package("unit5_pkg")
    with pytest.raises(PackageError, match=r"odd\.py is there, but the package does not install it"):
        package.launch_file("odd.py")


def test_scripts_of_a_cmake_package_are_executables(tmp_path: Path) -> None:
    root = make_package(tmp_path)
    (root / "setup.py").unlink()
    (root / "scripts").mkdir()
    (root / "scripts" / "talker.py").touch()
    (root / "CMakeLists.txt").write_text(
        "project(unit5_pkg)  # its name\nament_python_install_package(${PROJECT_NAME})\n"
        "install(PROGRAMS\n  scripts/talker.py\n  DESTINATION lib/${PROJECT_NAME}\n)\n"
        "install(DIRECTORY config\n  DESTINATION share/${PROJECT_NAME}/)\n"
    )
    package = find_packages(root).package("unit5_pkg")
    assert package.executable("talker.py").path == root / "scripts" / "talker.py"
    assert set(package.share_files) == {PurePosixPath("config/speeds.yaml")}


def test_lists_that_are_built_up_and_setup_cfg_are_read(tmp_path: Path) -> None:
    root = _with_setup(
        tmp_path,
        "import os, glob\nimport setuptools\nname = 'unit5_pkg'\n"
        "files = [('share/' + name, ['package.xml'])]\n"
        "files += [('share/%s/config' % name, [os.path.join('config', f) for f in os.listdir('config')])]\n"
        "files.append((f'share/{name}/x', glob.glob('*.xml')))\n"
        "secret = open('nowhere').read()\n"
        "setuptools.setup(name=name, data_files=files, long_description=secret, scripts=['bin/tool'])\n",
    )
    (root / "setup.cfg").write_text(
        "[options.entry_points]\nconsole_scripts =\n a = unit5_pkg.exercise51:main\n"
    )
    package = find_packages(root).package("unit5_pkg")
    assert set(package.executables) == {"a", "tool"}
    assert {str(place) for place in package.share_files} == {
        "package.xml",
        "config/speeds.yaml",
        "x/package.xml",
    }


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (
            "from setuptools import setup\nx = ask()\nsetup(entry_points=x)\n",
            r"setup\.py:2: ask\(\) cannot be read",
        ),
        ("setup(\n entry_points={'console_scripts': ['a = b']})\n", r"setup\.py:2: the entry point 'a = b'"),
        ("setup(\n", r"setup\.py:1: '\(' was never closed"),
        ("x = 1\n", "does not call setup"),
    ],
)
def test_a_setup_file_that_cannot_be_read_is_told_with_its_line(
    tmp_path: Path, text: str, sentence: str
) -> None:
    package = find_packages(_with_setup(tmp_path, text)).package("unit5_pkg")
    with pytest.raises(PackageError, match=sentence):
        _ = package.executables


def test_a_setup_file_is_never_run(tmp_path: Path) -> None:
    root = _with_setup(tmp_path, "open('/nonexistent/x', 'w')\nraise SystemExit\nsetup(name='unit5_pkg')\n")
    assert find_packages(root).package("unit5_pkg").executables == {}


def test_unknown_names_are_told_with_those_that_are_known(tmp_path: Path) -> None:
    packages = find_packages(make_package(tmp_path))
    with pytest.raises(UnknownPackageError, match="Package 'x' not found; known packages: unit5_pkg"):
        packages.package("x")
    with pytest.raises(UnknownExecutableError, match=r"No executable found.*known executables: exercise51"):
        packages.package("unit5_pkg").executable("x")


@pytest.mark.parametrize(
    ("manifest", "note"),
    [
        ('<!DOCTYPE p [<!ENTITY a "b">]><package><name>&a;</name></package>', "DOCTYPE"),
        ("<package><name>a</package>", "package.xml:1: this is not XML"),
        ("<package/>", "needs <package> with a <name>"),
    ],
)
def test_a_manifest_that_cannot_be_read_leaves_its_package_out(
    tmp_path: Path, manifest: str, note: str
) -> None:
    root = make_package(tmp_path)
    (root / "package.xml").write_text(manifest)
    found = find_packages(root)
    assert found.names == []
    assert note in found.notes[0]
