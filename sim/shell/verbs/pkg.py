"""``ros2 pkg``: lists packages and their contents."""

from __future__ import annotations

from argparse import Namespace
from xml.etree import ElementTree

from sim.files.untrusted import read_text
from sim.shell.parser import LineParser
from sim.shell.programs import known_packages, package
from sim.shell.session import CommandFailed, ShellSession
from sim.shell.verbs.verb import ShellCommand, Verb, no_arguments

_MANIFEST = "package.xml"
_CREATE_OPTIONS = (
    "package-format",
    "description",
    "license",
    "destination-directory",
    "build-type",
    "maintainer-email",
    "maintainer-name",
    "node-name",
    "library-name",
)


def _add_package(parser: LineParser) -> None:
    parser.argument("package_name", help="The package name", completer=known_packages)


def _list(session: ShellSession, _: Namespace) -> None:
    session.say_each(session.starter.packages().names)


def _add_prefix(parser: LineParser) -> None:
    _add_package(parser)
    parser.flag("--share", help="Show share directory for the package instead of the prefix")


def _prefix(session: ShellSession, arguments: Namespace) -> None:
    chosen = package(session, arguments.package_name)
    session.say(str(chosen.share if arguments.share else chosen.prefix))


def _add_executables(parser: LineParser) -> None:
    parser.argument(
        "package_name", nargs="?", help="Only list executables of this package", completer=known_packages
    )
    parser.flag("--full-path", help="Show the full path of the executable")


def _executables(session: ShellSession, arguments: Namespace) -> None:
    wanted = arguments.package_name
    names = session.starter.packages().names if wanted is None else [wanted]
    for chosen in (package(session, name) for name in names):
        for executable in sorted(chosen.executables):
            path = chosen.executable(executable).path if arguments.full_path else None
            session.say(f"{chosen.name} {executable}" if path is None else str(path))


def _add_xml(parser: LineParser) -> None:
    _add_package(parser)
    parser.add_argument("-t", "--tag", help="The XML tag to output, e.g. version")


def _xml(session: ShellSession, arguments: Namespace) -> None:
    path = package(session, arguments.package_name).root / _MANIFEST
    manifest = read_text(path)
    if arguments.tag is None:
        session.say(manifest.rstrip("\n"))
        return
    try:
        found = ElementTree.fromstring(manifest).findall(arguments.tag)
    except ElementTree.ParseError as error:
        raise CommandFailed(f"{path}: this is not XML: {error}") from None
    if not found:
        raise CommandFailed(f"No '{arguments.tag}' in the package.xml of '{arguments.package_name}'")
    for each in found:
        session.say((each.text or "").strip())


def _add_create(parser: LineParser) -> None:
    parser.argument("package_name", help="The package name")
    for name in _CREATE_OPTIONS:
        parser.add_argument(f"--{name}", help="What the package is to be like")
    parser.add_argument("--dependencies", nargs="+", help="List of dependencies")


def _create(_session: ShellSession, _: Namespace) -> None:
    raise NotImplementedError(
        "ros2 pkg create is not carried out here: make the folder with package.xml and setup.py yourself, "
        "or create it on a ROS 2 machine; it then runs here without colcon"
    )


PKG = ShellCommand(
    "pkg",
    "Various package related sub-commands",
    (
        Verb("create", "Create a new ROS 2 package", _add_create, _create),
        Verb("executables", "Output a list of package specific executables", _add_executables, _executables),
        Verb("list", "Output a list of available packages", no_arguments, _list),
        Verb("prefix", "Output the prefix path of a package", _add_prefix, _prefix),
        Verb("xml", "Output the XML of the package manifest or a specific tag", _add_xml, _xml),
    ),
)
