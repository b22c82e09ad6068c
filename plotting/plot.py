#!/usr/bin/env python3
"""Makes all figures of a result file of a run or a sweep: plot.py FILE.h5... [-o DIR] [--only NAME...] [--format png|pdf|svg...]

Of several runs each figure compares them, one line for each file. Figures that do not apply are left out; stderr says why. Exit codes: 0 made, 2 bad input (no result file, unknown figure, a
figure named with --only does not apply), 4 the output cannot be written.
"""
import argparse
import contextlib
import sys
from pathlib import Path

from compare import COMPARISONS, MOST
from figures import FIGURES, SWEEP_FIGURES, NotApplicable
from result import NotAResult, open_result

# No dates: the same data make the same file.
METADATA = {"pdf": {"CreationDate": None}, "svg": {"Date": None}, "png": {}}


def read_arguments(arguments):
    parser = argparse.ArgumentParser(prog="plot.py", description="Make the figures of a result file of osculate.")
    parser.add_argument("files", nargs="*", metavar="FILE.h5", help="result file of a run or a sweep, or files of several runs")
    parser.add_argument("-o", "--output", metavar="DIR", help="directory for the figures (default: FILE_figures, of several comparison_figures)")
    parser.add_argument("--only", nargs="+", action="extend", choices=[*FIGURES, *SWEEP_FIGURES], metavar="NAME", help="make only these figures")
    parser.add_argument("--format", nargs="+", action="extend", choices=METADATA, help="kinds of file (default: png pdf)")
    parser.add_argument("--list", action="store_true", help="print the names of the figures")
    options = parser.parse_args(arguments)
    if not options.files and not options.list:
        parser.error("give a result file (FILE.h5 before --only or --format), or --list")
    if len(options.files) > MOST:
        parser.error(f"{len(options.files)} files: more than {MOST} lines cannot be told apart. Give fewer.")
    return options


def make(known, what, of, directory, names, formats, leave_out):
    """Writes the named figures into `directory`: known[name](of). `what` says of what kind the figures are.

    Yields each path written; calls leave_out(name, reason). Raises OSError.
    """
    directory.mkdir(parents=True, exist_ok=True)
    for name in names:
        if name not in known:
            leave_out(name, f"it is not a figure of {what}")
            continue
        try:
            figure = known[name](of)
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
    sources = [Path(file) for file in options.files]
    default = sources[0].with_name("comparison_figures" if len(sources) > 1 else sources[0].stem + "_figures")
    directory = Path(options.output) if options.output else default
    left_out = []

    def leave_out(name, reason):
        left_out.append(name)
        print(f"plot.py: {name} left out: {reason}", file=sys.stderr)

    try:
        with contextlib.ExitStack() as opened:
            results = [opened.enter_context(open_result(source)) for source in sources]
            if len(results) == 1:
                of, what = results[0], f"a {results[0].kind}"
                known = SWEEP_FIGURES if of.kind == "sweep" else FIGURES
            else:
                of, what, known = results, "several runs", COMPARISONS
                for result in results:
                    if result.kind != "run":
                        raise NotAResult(f"{result.path}: the file of a sweep cannot be compared with others. Give files of runs only.")
            for path in make(known, what, of, directory, options.only or known, options.format or ["png", "pdf"], leave_out):
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
