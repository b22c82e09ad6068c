#!/usr/bin/env python3
"""A hyper-redundant arm of any length as a URDF file, and an experiment with it.

    make_chain.py N FOLDER        writes FOLDER/chainN.urdf and FOLDER/chainN.yaml

Like chain60.urdf: axes y x y x ..., links that become lighter outward; here 10 m and 20 kg whatever N. It hangs from the
ceiling in a gentle bend. Every joint has a motor of 0.02 kg m^2: without them the damping torque meets next to no
inertia near the tip, and 200 links take six times as many right-hand sides.
"""
import pathlib
import sys

LENGTH = 10.0       # m
MASS = 20.0         # kg
TAPER = 0.2         # mass of the last link over that of the first
RADIUS = 0.03       # m, of the rods
BEND = (3.6, 0.6)    # rad, N times the angle of a joint about y and about x in the inner half ...
TWIST = (3.0, -1.2)  # ... and in the outer half


def masses(n):
    """Linear from the base to the tip, kg."""
    weights = [1 + (TAPER - 1) * i / max(1, n - 1) for i in range(n)]
    total = sum(weights)
    return [MASS * w / total for w in weights]


def urdf(n):
    length = LENGTH / n
    lines = ['<?xml version="1.0"?>', f'<!-- Made by make_chain.py {n}. SI units. -->', f'<robot name="chain{n}">',
             '<link name="l0"/>']
    for i, m in enumerate(masses(n), 1):
        axis = "0 1 0" if i % 2 else "1 0 0"
        start = 0 if i == 1 else length
        across, along = m / 12 * (3 * RADIUS**2 + length**2), m * RADIUS**2 / 2
        lines.append(f'<joint name="j{i}" type="continuous"><parent link="l{i - 1}"/><child link="l{i}"/>'
                     f'<origin xyz="0 0 {start:.12g}"/><axis xyz="{axis}"/></joint>')
        lines.append(f'<link name="l{i}"><inertial><origin xyz="0 0 {length / 2:.12g}"/><mass value="{m:.12g}"/>'
                     f'<inertia ixx="{across:.12g}" iyy="{across:.12g}" izz="{along:.12g}" ixy="0" ixz="0" iyz="0"/>'
                     '</inertial></link>')
    lines += [f'<joint name="end" type="fixed"><parent link="l{n}"/><child link="tip"/>'
              f'<origin xyz="0 0 {length:.12g}"/></joint>', '<link name="tip"/>', '</robot>']
    return "\n".join(lines) + "\n"


def listed(values, width=12):
    rows = [", ".join(f"{x:.12g}" for x in values[i:i + width]) for i in range(0, len(values), width)]
    return "[" + ",\n      ".join(rows) + "]"


def yaml(n):
    half = n // 2
    q = [(BEND if i < half else TWIST)[i % 2] / n for i in range(n)]
    every = 10**9  # the dense side costs n^3: it checks the first state and the last
    return f"""# {n} joints, hanging, and six task rows: the tip draws a figure, damping in the null space keeps the chain quiet.
# Made by models/make_chain.py. Checked at the start and at the end only. Expected: all claims pass, null_space too.
name: chain{n}
model:
  {{urdf: chain{n}.urdf, base: l0, tip: tip, gravity: [0, 0, 9.80665],
   armature: {listed([0.02] * n, 20)}}}   # kg m^2
initial:
  q: {listed(q)}
reference: {{type: lissajous, amplitude: [0.1, 0.1, 0.1, 0.3, 0.3, 0.2], period: [3, 4, 5, 4, 3, 5]}}
controller:
  law: operational_space
  gains: {{stiffness: 100, damping: 20}}
  null_space: {{damping: 0.05}}   # N m s/rad
integrator: {{rtol: 1e-8, atol: 1e-10}}
duration: 0.5
output: {{interval: 0.05}}
verify: {{every: {every}}}
expect: {{}}
"""


def main(arguments):
    if len(arguments) != 2 or not arguments[0].isdigit() or int(arguments[0]) < 6:
        sys.exit(__doc__.strip() + "\n\nN is a number from 6 on.")
    n, folder = int(arguments[0]), pathlib.Path(arguments[1])
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"chain{n}.urdf").write_text(urdf(n))
    (folder / f"chain{n}.yaml").write_text(yaml(n))


if __name__ == "__main__":
    main(sys.argv[1:])
