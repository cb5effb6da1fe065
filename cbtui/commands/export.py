"""``cbtui export``: converts a recording for trace viewers, spreadsheets and paper."""

import argparse
from functools import partial
from pathlib import Path

from cbtui.commands.options.outputs import add_force, check_outputs, file_or_stream
from cbtui.commands.options.values import moment, whole_number
from cbtui.commands.run import add_chain
from cbtui.runs.recorded.exporting import FORMATS, WIDTH, ExportError, ExportRequest, export
from cbtui.text.output import complain


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument("file", metavar="FILE.mcap", help="a recording")
    for name, (metavar, about) in FORMATS.items():
        parser.add_argument(f"--{name}", metavar=metavar, type=file_or_stream, help=about)
    parser.add_argument("--from", dest="start", metavar="S", type=moment, help="where the picture begins (0)")
    parser.add_argument("--to", dest="end", metavar="S", type=moment, help="where it ends (the run's end)")
    add_chain(parser)
    parser.add_argument("--width", metavar="PIXELS", type=whole_number, help=f"how wide it is ({WIDTH})")
    add_force(parser)


def export_command(options: argparse.Namespace) -> int:
    """Export; returns the exit code: 0 on success, 2 for wrong arguments or a file in the way."""
    from cbtui.runs.recorded.reading_progress import batches_with_progress
    from sim.recording import RecordingError, read

    source = Path(options.file)
    try:
        request = _request(options, source)
        recording = read(source)
        export(partial(batches_with_progress, recording), request)
    except (ExportError, RecordingError) as error:
        complain(str(error))
        return 2
    for path in request.outputs.values():
        complain(f"wrote {path}")
    if recording.damage:
        complain(f"{source}: {recording.damage}")
    return 0


def _request(options: argparse.Namespace, source: Path) -> ExportRequest:
    """Return the export that the options ask for.

    Raises:
        ExportError: no output is named, or the options contradict each other.
    """
    from sim.export.svg import NARROWEST, WIDEST

    given = {name: getattr(options, name) for name in FORMATS}
    outputs = {name: Path(path) for name, path in given.items() if path is not None}
    if not outputs:
        raise ExportError(
            f"name what to write, such as --svg lanes.svg; choose from --{', --'.join(FORMATS)}"
        )
    check_outputs({f"--{name}": path for name, path in outputs.items()}, [source], force=options.force)
    placed = [options.start, options.end, options.width]
    if "svg" not in outputs and any(value is not None for value in placed):
        raise ExportError("--from, --to and --width are for the picture; add --svg OUT.svg")
    if options.chains and not {"markdown", "svg"} & outputs.keys():
        raise ExportError(
            "--chain is for report and picture; add --markdown OUT.md or --svg OUT.svg, or use cbtui info"
        )
    start = 0.0 if options.start is None else options.start
    if options.end is not None and options.end <= start:
        raise ExportError(f"a picture from {start:g} to {options.end:g} s is empty; give --to a later time")
    width = WIDTH if options.width is None else options.width
    if not NARROWEST <= width <= WIDEST:
        raise ExportError(f"a picture cannot be {width} pixels wide; give {NARROWEST} to {WIDEST}")
    return ExportRequest(outputs, start, options.end, width, chains=options.chains)
