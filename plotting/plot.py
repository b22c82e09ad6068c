#!/usr/bin/env python3
"""Makes all figures of a result file of a run or a sweep: plot.py FILE.h5 [-o DIR] [--only NAME...] [--format png|pdf|svg...]

Figures that do not apply are left out; stderr says why. Exit codes: 0 made, 2 bad input (no result file, unknown figure, a
figure named with --only does not apply), 4 the output cannot be written.
"""
import argparse
import sys
from pathlib import Path

from figures import FIGURES, SWEEP_FIGURES, NotApplicable
from result import NotAResult, open_result

# No dates: the same data make the same file.
METADATA = {"pdf": {"CreationDate": None}, "svg": {"Date": None}, "png": {}}


def read_arguments(arguments):
    parser = argparse.ArgumentParser(prog="plot.py", description="Make the figures of a result file of osculate.")
    parser.add_argument("file", nargs="?", metavar="FILE.h5", help="result file of a run or a sweep")
    parser.add_argument("-o", "--output", metavar="DIR", help="directory for the figures (default: FILE_figures)")
    parser.add_argument("--only", nargs="+", action="extend", choices=[*FIGURES, *SWEEP_FIGURES], metavar="NAME", help="make only these figures")
    parser.add_argument("--format", nargs="+", action="extend", choices=METADATA, help="kinds of file (default: png pdf)")
    parser.add_argument("--list", action="store_true", help="print the names of the figures")
    options = parser.parse_args(arguments)
    if options.file is None and not options.list:
        parser.error("give a result file (FILE.h5 before --only or --format), or --list")
    return options


def make(result, directory, names, formats, leave_out):
    """Writes the named figures into `directory`. Yields each path written; calls leave_out(name, reason). Raises OSError."""
    directory.mkdir(parents=True, exist_ok=True)
    known = SWEEP_FIGURES if result.kind == "sweep" else FIGURES
    for name in names:
        if name not in known:
            leave_out(name, f"it is not a figure of a {result.kind}")
            continue
        try:
            figure = known[name](result)
        except NotApplicable as reason:
            leave_out(name, reason)
            continue
        if figure.get_layout_engine() is not None:
            figure.draw_without_rendering()  # lays it out, once for all formats
            figure.set_layout_engine("none")
        for kind in formats:
            path = directory / f"{name}.{kind}"
            figure.savefig(path, metadata=METADATA[kind])
            yield path


def main(arguments=None):
    options = read_arguments(arguments)
    if options.list:
        print("\n".join([*FIGURES, *SWEEP_FIGURES]))
        return 0
    source = Path(options.file)
    directory = Path(options.output) if options.output else source.with_name(source.stem + "_figures")
    left_out = []

    def leave_out(name, reason):
        left_out.append(name)
        print(f"plot.py: {name} left out: {reason}", file=sys.stderr)

    try:
        with open_result(source) as result:
            names = options.only or (SWEEP_FIGURES if result.kind == "sweep" else FIGURES)
            for path in make(result, directory, names, options.format or ["png", "pdf"], leave_out):
                print(path)
    except NotAResult as error:
        print(f"plot.py: {error}", file=sys.stderr)
        return 2
    except OSError as error:
        reason = error.strerror or error
        print(f"plot.py: {directory}: cannot write the figures ({reason}). Choose another place with -o.", file=sys.stderr)
        return 4
    return 2 if options.only and left_out else 0


if __name__ == "__main__":
    sys.exit(main())
