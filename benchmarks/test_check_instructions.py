"""The instruction check fails on a rise of 4 %, passes one of 2 %, and says how to accept a new count."""

import pathlib
import subprocess
import sys
import tempfile

CHECK = pathlib.Path(__file__).with_name("check_instructions")
KEPT = "[a build]\nfour_sweeps random7 10000\ndense random7 200000\n"


def check(measured, *options):
    with tempfile.TemporaryDirectory() as folder:
        files = {name: pathlib.Path(folder, name) for name in ("kept", "measured")}
        files["kept"].write_text(KEPT)
        files["measured"].write_text(measured)
        command = [sys.executable, CHECK, "build/dev/bench_core", "--kept", files["kept"],
                   "--measured", files["measured"], *options]
        done = subprocess.run(command, capture_output=True, text=True)
        return done.returncode, done.stdout, files["kept"].read_text()


def expect(what, condition, output):
    if not condition:
        sys.exit(f"{what}\n{output}")


code, output, _ = check(KEPT)
expect("the same counts pass", code == 0, output)
code, output, _ = check(KEPT.replace("10000", "10200"))
expect("a rise of 2 % passes", code == 0 and "+2.0%" in output, output)
code, output, _ = check(KEPT.replace("10000", "10400"))
expect("a rise of 4 % fails", code == 1, output)
expect("the call is named", "four_sweeps       random7       10400  kept     10000    +4.0%  TOO MANY" in output, output)
expect("only that one", output.count("TOO MANY") == 1, output)
expect("the way out is told", "benchmarks/check_instructions build/dev/bench_core --accept" in output, output)
code, output, _ = check(KEPT.replace("dense random7 200000\n", ""))
expect("a call that is no longer counted fails", code == 1 and "dense" in output, output)
code, output, _ = check(KEPT + "new random7 5\n")
expect("a call without a kept count fails", code == 1 and "kept   nothing" in output, output)
code, output, _ = check(KEPT.replace("a build", "another"))
expect("another build's counts are not used", code == 1, output)
code, output, kept = check(KEPT.replace("10000", "10400"), "--accept")
expect("accepting keeps the new count", code == 0 and "10400" in kept and "10000" not in kept, output + kept)
