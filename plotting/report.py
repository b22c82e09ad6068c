#!/usr/bin/env python3
"""Makes a page of a run: report.py FILE.h5 [-o report.html]. One HTML file that opens without a network.

It shows the verdict, the moving arm, plots with one cursor, the configuration and where the file came from. The libraries in it
come from the Debian packages libjs-three and libjs-dygraphs. Exit codes: 0 made, 2 bad input, 4 the page cannot be written or a
library is missing.
"""
import argparse
import html
import json
import math
import os
import sys
from pathlib import Path

import h5py

import style
from report_data import page_data
from result import NotAResult, open_result

PARTS = Path(__file__).resolve().parent / "report"
LIBRARIES = Path(os.environ.get("OSCULATE_JAVASCRIPT", "/usr/share/javascript"))
FROM_PACKAGES = {
    "libjs-three": ("three/three.min.js", "three/examples/js/controls/OrbitControls.js", "three/examples/js/renderers/Projector.js",
                    "three/examples/js/renderers/SVGRenderer.js", "three/examples/js/lines/LineSegmentsGeometry.js",
                    "three/examples/js/lines/LineGeometry.js", "three/examples/js/lines/LineMaterial.js",
                    "three/examples/js/lines/LineSegments2.js", "three/examples/js/lines/Line2.js"),
    "libjs-dygraphs": ("dygraphs/dygraph.min.js",),
}
OURS = ("data.js", "player.js", "shapes.js", "scene.js", "plots.js", "start.js")
WORDS = {1: ("pass", "✓ pass"), 0: ("fail", "✗ FAIL"), -1: ("none", "not applicable")}


class NoLibrary(Exception):
    """A library is not installed. The message names its package."""


def libraries():
    """The texts of all libraries, and of their style sheets. Raises NoLibrary."""
    def text(package, name):
        try:
            return (LIBRARIES / name).read_text(encoding="utf-8")
        except OSError:
            raise NoLibrary(f"{LIBRARIES / name} is missing. Install the Debian package {package}: "
                            f"sudo apt-get install --no-install-recommends {package}") from None

    scripts = [text(package, name) for package, names in FROM_PACKAGES.items() for name in names]
    return scripts, text("libjs-dygraphs", "dygraphs/dygraph.min.css")


def licences():
    """What the packages say of the copyright of the libraries that go into the page, folded."""
    pieces = []
    for package in FROM_PACKAGES:
        path = Path("/usr/share/doc") / package / "copyright"
        try:
            pieces.append(folded(f"licence of {package}", path.read_text(encoding="utf-8"), str(path).lstrip("/")))
        except OSError:  # a machine without /usr/share/doc: the page names the licences all the same
            continue
    return "".join(pieces)


def escaped(value):
    return html.escape(str(value))


def size(value):
    """A residual or a bound in three figures."""
    return "–" if math.isnan(value) else f"{value:.2e}"


def verdict_table(result):
    rows = []
    for row in result.verdicts().values():
        kind, word = WORDS[row.result]
        if row.result == -1:
            rows.append(f'<tr class="none"><th scope="row">{escaped(row.claim)}</th><td data-label="equation">{escaped(row.equation)}</td>'
                        f'<td class="why" colspan="4">{escaped(row.reason)}</td><td class="outcome none">{word}</td></tr>')
            continue
        when = (f'<button type="button" class="when" data-time="{row.at_time!r}" data-claim="{escaped(row.claim)}" '
                f'title="show this instant">{row.at_time:.4f} s</button>') if math.isfinite(row.at_time) else "–"
        rows.append(f'<tr class="{kind}"><th scope="row">{escaped(row.claim)}</th><td data-label="equation">{escaped(row.equation)}</td>'
                    f'<td class="number" data-label="worst">{size(row.worst)}</td><td class="number" data-label="bound">{size(row.bound)}</td>'
                    f'<td class="number" data-label="when">{when}</td><td class="number" data-label="undecided">{row.undecided_steps}</td>'
                    f'<td class="outcome {kind}">{word}</td></tr>')
    if not rows:
        return '<p class="note">The file has no verdict: the run was not finished, or nothing was checked.</p>'
    heads = (("claim", ""), ("equation", ""), ("worst residual", "number"), ("bound", "number"), ("when", "number"), ("undecided steps", "number"),
             ("result", ""))
    head = "".join(f'<th scope="col" class="{kind}">{name}</th>' for name, kind in heads)
    note = ""
    if result.verdict == "as_expected":
        note = '<p class="note">The experiment expects this outcome: see expect in the configuration.</p>'
    elif result.verdict == "fail" and result.status == "complete" and all(row.result != 0 for row in result.verdicts().values()):
        note = '<p class="note">No claim fails, but what the experiment expects did not come: see expect in the configuration.</p>'
    return note + f'<table class="verdict"><caption class="hidden">Verdict by claim</caption><thead><tr>{head}</tr></thead><tbody>{"".join(rows)}</tbody></table>'


def summary(result):
    """Number of claims by outcome, in words."""
    results = [row.result for row in result.verdicts().values()]
    parts = [f"{results.count(value)} {word}" for value, word in ((1, "pass"), (0, "fail"), (-1, "not applicable")) if value in results]
    return ", ".join(parts) if parts else "no verdict"


def scalars(result, *groups):
    """Rows (long name, value with unit) of the single numbers in groups of the file."""
    for group in groups:
        if group not in result:
            continue
        for name, data in result.file[group].items():
            if data.shape != () or h5py.check_string_dtype(data.dtype):
                continue
            value, path = float(data[()]), f"{group}/{name}"
            if math.isfinite(value):
                unit = style.unit_text(result.unit(path) or "")
                yield result.long_name(path) or path, f"{value:.6g} {'' if unit == '1' else unit}".strip(), path


def pairs(rows):
    body = "".join(f'<tr><th scope="row">{escaped(name)}</th><td>{escaped(value)}</td><td class="path">/{escaped(path)}</td></tr>'
                   for name, value, path in rows)
    return f'<table class="pairs"><tbody>{body}</tbody></table>' if body else '<p class="note">Nothing here: the run was not finished.</p>'


def provenance(result):
    """Versions, machine and command as a table; experiment and model as texts."""
    rows, texts = [], []
    group = result.file.get("provenance", {})
    for name, data in group.items():
        if data.shape != () or not h5py.check_string_dtype(data.dtype):
            continue
        path = f"provenance/{name}"
        value, long_name = result.read(path), result.long_name(path) or name
        if "\n" in value.strip():
            texts.append((long_name, value, path))
        else:
            rows.append((long_name, value, path))
    return rows, texts


def folded(name, text, path, is_open=False):
    return (f'<details{" open" if is_open else ""}><summary>{escaped(name)} <span class="path">/{escaped(path)}</span></summary>'
            f'<pre tabindex="0">{escaped(text.rstrip())}</pre></details>')


def palette():
    """The colours of the figures for the style sheet."""
    names = ("BLACK", "ORANGE", "SKY", "GREEN", "YELLOW", "BLUE", "VERMILION", "PURPLE", "GREY")
    return ":root{" + "".join(f"--{name.lower()}:{getattr(style, name)};" for name in names) + "}"


def page(result, refresh=None):
    """The page of an open run as one text. With `refresh` the browser loads it again after so many seconds. Raises NoLibrary."""
    scripts, library_style = libraries()
    data, remarks, distance = page_data(result)
    data["live"] = refresh is not None
    if distance is not None and distance > 1e-6:
        remarks.insert(0, f"The drawn tip is up to {distance:.2g} m from the recorded one: the model in the file is not the arm that moved.")
    rows, texts = provenance(result)
    created = next((value for _, value, path in rows if path == "provenance/created"), "")
    joints = len(result.read("joint")) if "joint" in result else 0
    facts = [f"{data['end'] - data['start']:.6g} s simulated", f"{joints} joints", f"{len(result.read('step'))} steps", created]
    outcome = style.outcome(result)
    good = result.status == "complete" and result.verdict in ("pass", "as_expected")
    body = {
        "title": escaped(result.title), "outcome": escaped(outcome), "outcome-kind": "good" if good else "bad",
        "facts": " · ".join(escaped(fact) for fact in facts if fact), "file": escaped(result.path.name), "summary": escaped(summary(result)),
        "verdict": verdict_table(result), "remarks": "".join(f"<li>{escaped(remark)}</li>" for remark in remarks),
        "measured": pairs(scalars(result, "measured", "global_error", "analytic_response")), "timing": pairs(scalars(result, "timing")),
        "configuration": "".join(folded(*text, is_open=text[2] == "provenance/experiment") for text in texts), "provenance": pairs(rows), "licences": licences(),
        "refresh": f'<meta http-equiv="refresh" content="{refresh}">' if refresh else "",
        "palette": palette(), "style": library_style + (PARTS / "page.css").read_text(encoding="utf-8"),
        "data": json.dumps(data, separators=(",", ":"), allow_nan=False).replace("</", "<\\/"),
        "scripts": "\n".join(f"<script>{text.replace('</script', '<' + chr(92) + '/script')}</script>"
                             for text in (*scripts, *((PARTS / name).read_text(encoding="utf-8") for name in OURS))),
    }
    pieces = (PARTS / "page.html").read_text(encoding="utf-8").split("{{")
    return pieces[0] + "".join(body[name] + rest for name, rest in (piece.split("}}", 1) for piece in pieces[1:]))


def write(path, text):
    """Writes beside the target and renames, so that a reader never sees half a page. Raises OSError."""
    path = Path(path)
    part = path.with_name(path.name + ".part")
    try:
        part.write_text(text, encoding="utf-8")
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="report.py", description="Make a page of a run: verdict, moving arm, plots, configuration.")
    parser.add_argument("file", metavar="FILE.h5", help="result file of a run")
    parser.add_argument("-o", "--output", metavar="PAGE.html", help="the page (default: FILE.html)")
    options = parser.parse_args(arguments)
    source = Path(options.file)
    target = Path(options.output) if options.output else source.with_suffix(".html")
    if target.exists() and source.exists() and target.samefile(source):
        parser.error(f"{target} is the result file itself: give another name with -o")
    try:
        with open_result(source) as result:
            if result.kind != "run":
                raise NotAResult(f"{source}: the file of a sweep, which has no motion to show. Draw it with plot.py, or give the file of a run.")
            text = page(result)
        write(target, text)
    except NotAResult as error:
        print(f"report.py: {error}", file=sys.stderr)
        return 2
    except NoLibrary as error:
        print(f"report.py: {error}", file=sys.stderr)
        return 4
    except OSError as error:
        print(f"report.py: {target}: cannot write the page ({error.strerror or error}). Choose another place with -o.", file=sys.stderr)
        return 4
    print(target)
    return 0


if __name__ == "__main__":
    sys.exit(main())
