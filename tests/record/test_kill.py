"""Two hundred runs of the writer, each ended by SIGKILL at a random moment of creation, of recording or of the end.
Usage: test_kill.py WRITER"""
import hashlib
import os
import random
import subprocess
import sys
import tempfile
import time

from known_rows import STEP_CHUNK, TIME_CHUNK, check_fixed, check_other_readers, check_rows, open_file, recover

SEED = 20240611
RUNS = 200
FINITE_ROWS = 3010  # a part of a chunk remains for the end


def digest(path):
    with open(path, "rb") as file:
        return hashlib.sha256(file.read()).hexdigest()


def rows_told(path):
    with open(path + ".told") as told:
        lines = told.read().split("\n")[:-1]
    return int(lines[-1]) if lines else 0


def run_and_kill(writer, path, rows, pace_us, target, seconds):
    """Kills the writer `seconds` after it has told of `target` rows. Returns the number of rows it told of in the end."""
    with open(path + ".told", "w") as told:
        process = subprocess.Popen([writer, "run", path, str(rows), str(pace_us)], stdout=told)
    deadline = time.monotonic() + 60
    while rows_told(path) < target:
        assert process.poll() in (None, 0) and time.monotonic() < deadline, "the writer does not get on"
        time.sleep(0.001)
    time.sleep(seconds)
    process.kill()
    process.wait()
    return rows_told(path)


SLOW_PACE = 1_100_000  # 50 rows, then a rest that is longer than the second between writes


def plan(number, chance):
    """(rows, pace in microseconds for 50 rows, rows to wait for, seconds until the kill) of one run."""
    if number % 25 == 4:
        return 0, SLOW_PACE, 100, chance.uniform(0.0, 0.2)
    if number % 5 == 0:
        return 0, 0, 0, chance.uniform(0.0, 0.02)  # around the creation
    if number % 5 == 1:
        return FINITE_ROWS, 0, FINITE_ROWS - FINITE_ROWS % 50, chance.uniform(0.0, 0.02)  # around the end
    return 0, chance.choice([0, 300, 1000]), chance.choice([50, 200, 1000, 4000]), chance.uniform(0.03, 0.1)


def check_one(writer, path, told, kinds, readers_too, slow):
    target = path + ".recovered"
    if not os.path.exists(path):
        run = recover(writer, path, target)
        assert run.returncode == 4 and path in run.stderr, run
        assert ("stopped before its first row" in run.stderr) == os.path.exists(path + ".tmp"), run.stderr
        assert told == 0
        kinds["nothing yet"] += 1
        return
    before = digest(path)
    run = recover(writer, path, target)
    assert digest(path) == before, "recover changed its input"
    if run.returncode == 4 and "is a finished file (status complete)" in run.stderr:
        kinds["finished"] += 1
        with open_file(path) as file:
            assert file.attrs["status"] == "complete" and file.attrs["verdict"] == "pass"
            assert check_rows(file) == (FINITE_ROWS, (FINITE_ROWS + 2) // 3)
            assert len(file["verdict/claim"]) == 2
        return
    assert run.returncode == 0, run.stderr
    assert run.stdout.strip() == target
    with open_file(target) as file:
        assert file.attrs["status"] == "recovered" and "verdict" not in file.attrs
        check_fixed(file)
        rows, steps = check_rows(file)
    # Every chunk that was full when the writer told of it is there.
    assert rows >= told // TIME_CHUNK * TIME_CHUNK, (rows, told)
    assert steps >= told // 3 // STEP_CHUNK * STEP_CHUNK, (steps, told)
    if slow:  # chunks that are not full are written each second
        assert rows % TIME_CHUNK > 0 and rows > told - 50, (rows, told)
        kinds["slow"] += 1
    else:
        assert rows % TIME_CHUNK == 0 or rows == FINITE_ROWS, rows
    kinds["recovered"] += 1
    kinds["rows lost"] = max(kinds["rows lost"], told - rows)
    kinds["rows"] += rows
    if readers_too:
        check_other_readers(target)


def main(writer):
    chance = random.Random(SEED)
    kinds = {"nothing yet": 0, "finished": 0, "recovered": 0, "slow": 0, "rows": 0, "rows lost": 0}
    with tempfile.TemporaryDirectory() as directory:
        for number in range(RUNS):
            rows, pace_us, target, seconds = plan(number, chance)
            path = f"{directory}/run{number}.h5"
            told = run_and_kill(writer, path, rows, pace_us, target, seconds)
            try:
                check_one(writer, path, told, kinds, number % 20 == 3, pace_us == SLOW_PACE)
            except Exception:
                print(f"run {number}: {rows} rows, pace {pace_us} us, killed {seconds} s after {target} rows; told of {told}")
                raise
    print(f"seed {SEED}: {kinds}")
    assert sum(kinds[kind] for kind in ("nothing yet", "finished", "recovered")) == RUNS
    assert kinds["recovered"] >= RUNS * 3 // 5 and kinds["rows"] > RUNS * TIME_CHUNK


main(sys.argv[1])
