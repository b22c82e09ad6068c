"""Input that asks for too much, or is no file: a message at once, never a crash, a hang or a full memory."""
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import unittest

PROGRAM = os.environ["OSCULATE"]
ROOT = pathlib.Path(os.environ["OSCULATE_SOURCE_DIR"])
CIRCLE = ROOT / "experiments" / "puma560_circle.yaml"
WAYPOINTS = ROOT / "experiments" / "prismatic_arm_waypoints.yaml"
HOSTILE = ROOT / "tests" / "fuzz" / "corpus" / "result"
MEMORY = 2 << 30  # bytes that a call may take


def call(*arguments, limits={}):
    def limit():
        for what, bounds in {resource.RLIMIT_AS: (MEMORY, MEMORY), **limits}.items():
            resource.setrlimit(what, bounds)
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=60, errors="replace",
                          preexec_fn=limit)


def chain(joints):
    inertia = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    lines = ['<robot name="long"><link name="l0"/>']
    for i in range(1, joints + 1):
        lines.append(f'<link name="l{i}">{inertia}</link><joint name="j{i}" type="continuous"><parent link="l{i - 1}"/>'
                     f'<child link="l{i}"/><axis xyz="0 1 0"/></joint>')
    return "\n".join(lines) + "\n</robot>\n"


class Limits(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)

    def refused(self, *arguments, says, code=2):
        done = call(*arguments)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertIn(says, done.stderr)
        self.assertLess(len(done.stderr), 2000)
        return done

    def write(self, name, content):
        path = self.folder / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    def sparse(self, name, size):
        path = self.write(name, "")
        os.truncate(path, size)
        return path

    def changed(self, *sets):
        return ["check", CIRCLE, *sum((["--set", s] for s in sets), [])]

    def test_settings(self):
        for sets, says in ((["output.interval=1e-11"], "at most 1e8 instants"),
                           (["duration=1e12"], "at most 1e8 instants"),
                           (["controller.sampling={period: 1e-12}"], "at most 1e9 samples"),
                           ([f"sweep={{key: duration, values: {list(range(1, 2001))}}}"], "has 2000 runs, at most 1000"),
                           (["duration=1e400"], "does not fit in a double"),
                           ([f"initial.q=[{'0, ' * 300000}0]"[:120000] + "]"], "120")):
            if says == "120":
                self.assertEqual(call(*self.changed(*sets)).returncode, 2)
            else:
                self.refused(*self.changed(*sets), says=says)

    def test_text(self):
        good = CIRCLE.read_text().replace("../models", str(ROOT / "models"))
        for name, text, says in (("deep", "a: " + "[" * 50000, "not valid YAML"),
                                 ("maps", "{a: " * 5000, "not valid YAML"),
                                 ("deep_and_closed", "a: " + "[" * 100 + "]" * 100, "nested too deeply"),
                                 ("bomb", "a: &a [1]\n" + "".join(
                                     f"{chr(98 + i)}: &{chr(98 + i)} [{', '.join(['*' + chr(97 + i)] * 9)}]\n"
                                     for i in range(9)), "too many values"),
                                 ("list", good + f"\nmore: [{'0, ' * 300000}0]", "too many values"),
                                 ("nul", good + "\0", "control character (byte 0)"),
                                 ("latin", good.encode() + b"# caf\xe9\n", "byte 233 is not UTF-8"),
                                 ("surrogate", good.encode() + b"# \xed\xa0\x80\n", "is not UTF-8")):
            done = self.refused("check", self.write(name + ".yaml", text), says=says)
            self.assertIn(name + ".yaml:", done.stderr)
        for name, text in (("mark", b"\xef\xbb\xbf" + good.encode()), ("crlf", good.replace("\n", "\r\n"))):
            self.assertEqual(call("check", self.write(name + ".yaml", text)).returncode, 0, name)

    def test_large_files(self):
        large = self.sparse("large", 2 << 30)
        says = "has 2147483648 bytes, larger than "
        self.refused("check", large, says=says + "4 MB")
        self.refused(*self.changed(f"model.urdf={large}"), says=says + "64 MB")
        self.refused("info", large, says=says + "64 MB")
        self.refused("verify", WAYPOINTS, "--set", f"reference.file={large}", says=says + "64 MB")
        self.refused("terms", ROOT / "models" / "puma560.urdf", "--tip", "tool0", "--states", large, says=says + "64 MB")

    def test_what_is_no_file(self):
        pipe = self.folder / "pipe"
        os.mkfifo(pipe)
        for path, says in ((self.folder, "is a directory"), (pipe, "is a pipe or a device"), ("/dev/zero", "is a pipe or a device"),
                           (self.folder / "none", "no such file")):
            self.refused("check", path, says=f"{path}: {says}")
            self.refused("info", path, says=f"{path}: {says}")
            self.refused(*self.changed(f"model.urdf={path}"), says=f"{path}: {says}")
            self.refused("verify", WAYPOINTS, "--set", f"reference.file={path}", says=f"{path}: {says}")
            self.refused("recover", path, says=f"{path}: ", code=4)
            self.refused("judge", path, "--model", ROOT / "models" / "puma560.urdf", "--tip", "tool0", says=f"{path}: {says}")

    def test_many_joints(self):
        arm = self.write("arm.urdf", chain(5001))
        q = "[" + ", ".join(["0"] * 5001) + "]"
        text = f"model: {{urdf: {arm}, tip: l5001}}\ninitial: {{q: {q}}}\ncontroller: {{law: free}}\n"
        self.refused("check", self.write("x.yaml", text), says="has 5001 joints: at most 5000 are simulated")
        self.refused("terms", arm, "--tip", "l5001", "--q", "0", says="has 5001 joints: at most 5000")
        self.assertEqual(call("info", arm, "--base", "l0", "--tip", "l5001").returncode, 0)
        many = self.write("many.urdf", '<robot name="r">' + "".join(f'<link name="l{i}"/>' for i in range(10**6)) + "</robot>")
        self.refused("info", many, says="1000000 links, at most 200000 are read")

    def test_result_files_that_crash_the_library(self):
        files = sorted(HOSTILE.glob("raw_heap*"))
        self.assertGreater(len(files), 1)
        for file in files:
            out = self.folder / "out.h5"
            done = call("recover", file, "-o", out)
            self.assertEqual(done.returncode, 4, file)
            self.assertIn(f"{file}: ", done.stderr)
            self.assertFalse(out.exists())

    def test_result_files_that_take_what_reads_them_down(self):
        crashing, endless, good = HOSTILE / "raw_heap1", HOSTILE / "raw_endless", HOSTILE / "raw_killed"
        out = self.folder / "out"
        for file, says in ((crashing, "crashed the HDF5 library"), (endless, "came to no end")):
            for verb in (["diff", good, file], ["export", file, "--csv", out], ["replay", file],
                         ["resume", file, "-o", out], ["judge", file]):
                # Reading without end uses up the reader's second of processor time; the caller has its own.
                done = call(*verb, limits={resource.RLIMIT_CPU: (1, 10)})
                self.assertEqual(done.returncode, 4, (verb, done.stderr))
                self.assertIn(f"{file}: is damaged so that reading it {says}", done.stderr)
                self.assertFalse(out.exists())


if __name__ == "__main__":
    unittest.main()
