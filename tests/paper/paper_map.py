"""Writes docs/paper.md: every equation of the paper with its file, function and test, from the tables in the sources
and from what is listed here by hand. Fails where a file, function or test that it names is not there.

    paper_map.py docs/paper.md
"""
import pathlib
import re
import sys
import textwrap

ROOT = pathlib.Path(__file__).resolve().parents[2]
EQUATIONS = 74

IDENTITIES, RELATIONS, OPERATORS, DENSE, PLACES = (
    f"src/reference/{name}.hpp" for name in ("identities", "operator_relations", "operators", "dense", "places"))
ARM, SWEEPS, SPACE, RESOLVED, PLANT, TASK = (
    f"src/recursion/{name}.hpp"
    for name in ("arm", "sweeps", "operational_space", "resolved_acceleration", "forward_dynamics", "task"))
MAP, PSI, HINGE, JOINT = (f"src/spatial/{name}.hpp" for name in ("map", "psi", "hinge", "joint"))
LAW = "src/control/law.cpp"
COMMAND = "src/control/command.cpp"
CHART = "src/control/coordinates.hpp"

# File: short name, name of the test.
TESTS = {
    "tests/paper/paper_test.cpp": {
        "proof": "over exact fractions every identity and every recursion holds, and every printed error shows",
        "bounds": "on the shipped arms every statement stays within its bound",
    },
    "tests/recursion/exact.cpp": {
        "sweeps": "the four sweeps are the definitions: Omega, Lambda, c, g, c + g, F, T",
        "plant": "the operator inverse of the mass matrix is M^-1: joint and tip accelerations, energies",
        "commanded": "the torque of the sweeps accelerates the tip as commanded, in every independent row",
        "print": "section 4.3 as printed, without a_g on the right of (68), is wrong by exactly Lambda a_g",
        "null space": "joint torques known beforehand move the arm within itself and leave the tip's "
            "acceleration alone",
        "bead": "a bead on a turning rod: the sliding joint feels 2 w x h qd",
    },
    "tests/reference/exact_laws.cpp": {
        "kinematics": "tip pose, J qd and Jdot qd are the pose and its first two derivatives",
        "energy": "M is the matrix of the kinetic energy",
        "potential": "G is the gradient of the potential energy",
        "Lagrange": "C of Newton-Euler is C of Lagrange",
        "motion": "forward dynamics leaves no residual in the equation of motion",
        "six links": "six links: Lambda, c and g satisfy their definitions, and the law (2) for any tip force",
    },
    "tests/reference/multi_dof.cpp": {
        "free body": "one free body: Lambda, c and g are those of the body moved to the tip",
        "moving base": "an arm on a moving base is a longer arm whose first joint moves the base",
    },
    "tests/spatial/maps.cpp": {
        "shifts": "phi moves forces, its star motions, and shifts form a group",
        "hinges": "a hinge is a row of six numbers",
        "bodies": "a rigid body is its 6 x 6 inertia",
        "psi": "psi = phi (1 - G H) acts and moves inertias and compliances as a 6 x 6 matrix",
    },
    "tests/control/coordinates_test.cpp": {
        "Pi": "y, Pi, its inverse and Pi. agree with the differentiated coordinates",
        "chart": "beta. = u = Pi v + Pi. yd makes ydd = v",
    },
    "tests/verification/claims_test.cpp": {
        "claims": "every step claim passes at ordinary states and fails ten bounds away",
    },
    "tests/recursion/operations_test.cpp": {
        "linear cost": "Every recursion is linear in n exactly, from one link on, and takes no square root",
        "sweep count": "Sweeps along the arm: four, three, three, two; four for resolved acceleration",
    },
    "tests/simulation/sampled_test.cpp": {
        "delay": "a delay costs the first order of the period, with extrapolation the second; without one (5) is exact",
        "samples": "a sampled run says how many sweeps each sample took, and judges the law at its samples",
        "alike": "resolved acceleration and operational space control move the tip alike",
    },
    "tests/mutation/test_mutations.py": {
        "faults": "test_every_fault_is_caught_as_named",
    },
}

# Equation, statement, file, function, tests: the code that is the equation, where the tables below have it not.
BY_HAND = [
    (1, "beta = Pi ydot", CHART, "CoordinateChart::velocity", "Pi"),
    (1, "u = Pi v + Pidot ydot, so that yddot = v", CHART, "CoordinateChart::command", "chart"),
    (1, "u within the law", COMMAND, "Controller::decide_in_coordinates", "faults"),
    (1, "yddot = v along a run: claim `coordinates`", "src/verification/coordinate_check.hpp", "judge_chart", "faults"),
    (2, "Lambda(0) beta_dot + c(0) + g(0) = F(0)", DENSE, "task_terms", "six links"),
    (3, "T = J* F(0)", SWEEPS, "sweep_torques", "proof, sweeps"),
    (3, "T = J* F(0) by the definition", DENSE, "task_force", "six links"),
    (4, "F_c(0) = Lambda(0) u + c(0) + g(0), one solve", LAW, "Controller::tip_force", "claims, faults"),
    (4, "F_c(0) by the definition", DENSE, "task_force", "six links, sweeps"),
    (5, "beta_dot = u: claim `linearization`", "src/verification/claims.cpp", "assess", "commanded, six links, claims"),
    (6, "M, C, G of Newton and Euler", DENSE, "joint_space", "energy, Lagrange, potential"),
    (6, "thdd = M^-1 (T - C - G + J* F)", DENSE, "forward_dynamics", "motion"),
    (7, "beta = J thd", DENSE, "kinematics", "kinematics"),
    (8, "beta_dot = J thdd + Jdot thd", DENSE, "kinematics", "kinematics"),
    (8, "solved for thdd", RESOLVED, "solve_square", "proof, alike"),
    (9, "beta = (omega; xdot) of the tip, angular rows first", PLACES, "point_motion", "kinematics"),
    (9, "spaces of such vectors", MAP, "Motion", "shifts"),
    (10, "beta_dot + J M^-1 (C + G) - Jdot thd = J M^-1 T", DENSE, "mobility", "six links"),
    (11, "Omega(0) = J M^-1 J*", DENSE, "mobility", "six links, sweeps"),
    (12, "Lambda(0) = Omega(0)^-1", DENSE, "task_terms", "six links"),
    (12, "Omega(0) factored on the task rows", TASK, "TaskFactor", "sweeps"),
    (13, "F(0) = Lambda(0) J M^-1 T, so J M^-1 (T - J* F) = 0: claim `null_space`", "src/verification/claims.cpp",
     "assess", "null space, claims"),
    (14, "c(0) = Lambda(0) (J M^-1 C - Jdot thd)", DENSE, "task_terms", "six links, sweeps"),
    (15, "g(0) = Lambda(0) J M^-1 G", DENSE, "task_terms", "six links, sweeps"),
    (16, "T by the definition", DENSE, "task_force", "six links, sweeps"),
    (17, "H(k)", HINGE, "Hinge", "hinges"),
    (17, "H(k) of a placed arm", ARM, "BasicArmBuilder::set_axes", "sweeps"),
    (17, "H as a matrix", OPERATORS, "fill_geometry", "proof"),
    (18, "phi(k,k-1)", MAP, "Shift", "shifts"),
    (18, "E_phi as a matrix", OPERATORS, "fill_geometry", "proof"),
    (19, "phi(i,j)", OPERATORS, "shift", "proof"),
    (20, "M(k)", MAP, "RigidInertia", "bodies"),
    (20, "M as a matrix", OPERATORS, "fill_geometry", "proof"),
    (21, "B* = [phi*(1,0), 0, ..., 0]", OPERATORS, "fill_geometry", "proof"),
    (21, "B* of a vector", SWEEPS, "velocity_at_tip", "proof"),
    (22, "E = [0, ..., 0, phi(n+1,n)]", OPERATORS, "fill_geometry", "proof"),
    (22, "a + E* a_g", SWEEPS, "bias_with_ground", "proof"),
    (23, "phi by forward substitution", OPERATORS, "propagated", "proof"),
    *[(n, f"{symbol} as a matrix", OPERATORS, "fill_articulated", "proof")
      for n, symbol in ((24, "P"), (25, "D"), (26, "G"), (27, "K"), (28, "E_psi"))],
    (29, "psi by forward substitution", OPERATORS, "propagated", "proof"),
    *[(n, f"{symbol}, one line of the recursion", SWEEPS, "articulate", "proof")
      for n, symbol in ((30, "D(k)"), (31, "G(k)"), (32, "K(k+1,k)"))],
    (33, "psi(k+1,k), kept as its factors", PSI, "Psi", "psi"),
    (34, "W: psi(n+1,n)", OPERATORS, "fill_articulated", "proof"),
    (35, "psi(i,j)", OPERATORS, "articulated_shifts", "proof"),
    (38, "the columns of J, for resolved acceleration", RESOLVED, "ResolvedAcceleration::gather_jacobian", "proof"),
    *[(n, f"{term} by Newton-Euler recursion", RESOLVED, "ResolvedAcceleration::sweep_forces", "proof")
      for n, term in ((42, "M thdd"), (43, "C"), (44, "G"), (45, "M thdd + C + G"))],
    (46, "Jdot thd by recursion", RESOLVED, "ResolvedAcceleration::sweep", "proof"),
    (48, "2 w x v of a sliding joint", SWEEPS, "bias_acceleration", "bead"),
    (51, "accelerations of the plant", PLANT, "BasicForwardDynamics::accelerations", "plant"),
    (57, "Omega as a matrix", OPERATORS, "fill_articulated", "proof"),
    (61, "Lambda(0) from the sweeps", LAW, "Controller::terms_of", "claims, faults"),
    (65, "the right side", SPACE, "BasicOperationalSpace::right_side_of_c", "sweeps"),
    (72, "the right side", SPACE, "BasicOperationalSpace::right_side_of_g", "sweeps"),
]

# What the paper says in words. The same columns.
IN_WORDS = [
    ("section 2", "recursive operational space control: Lambda, c, g and F_c, then T = J* F_c", LAW,
     "Controller::operational_space", "sweeps, commanded"),
    ("section 2", "resolved acceleration control", LAW, "Controller::resolved_acceleration", "alike"),
    ("section 2", "hybrid: resolved acceleration at every sample, Lambda, c and g at every N-th", "src/control/law.hpp",
     "Sampling", "samples"),
    ("section 2", "a mobile base is link n, with six velocities against the ground", JOINT, "Joint",
     "proof, free body"),
    ("section 2", "a base that moves as prescribed", ARM, "Ground", "proof, moving base"),
    ("section 3.1", "z = phi y, tip to base", RESOLVED, "ResolvedAcceleration::sweep_forces", "proof"),
    ("section 3.1", "alpha = phi* s, base to tip", RESOLVED, "ResolvedAcceleration::sweep", "proof"),
    ("section 3.1", "z = psi y, tip to base", SWEEPS, "bias_step", "proof"),
    ("section 3.1", "alpha = psi* s, base to tip", SWEEPS, "compliance_step", "proof"),
    ("section 3.2", "a and b during the recursion of V", SWEEPS, "velocity_step", "proof"),
    ("section 4.1", "Lambda(0) in two sweeps", SWEEPS, "sweep_compliance", "sweep count, linear cost"),
    ("section 4.2", "c(0) in three sweeps", SPACE, "BasicOperationalSpace::right_side_of_c", "sweeps, linear cost"),
    ("section 4.2", "old velocity terms: one sweep less", SWEEPS, "sweep_compliance_and_velocities",
     "sweep count, samples, delay"),
    ("section 4.3", "g(0) from P, D, psi alone: a sweep of its own, which runs after sweep 2", SWEEPS, "sweep_gravity",
     "sweeps, linear cost"),
    ("section 5", "T in four sweeps", SPACE, "BasicOperationalSpace", "sweep count, samples"),
    ("section 5", "old F_c: sweeps 2 and 4 in one", SWEEPS, "sweep_articulated_and_torques",
     "sweep count, samples, delay"),
    ("section 5", "both old: two sweeps, in link frames, where phi, H and M need no sweep", SPACE,
     "BasicOperationalSpace::begin_sample", "sweep count, samples, delay"),
]

# Place, as printed, what stands here, file, function, tests that show the print to be wrong.
MISPRINTS = [
    ("text after (1)", "beta_dot = Pi ydot + Pidot ydot; the goal ydot = v; beta_dot = ydot as special case",
     "beta_dot = Pi yddot + Pidot ydot; yddot = v; beta = ydot: dots are lost", CHART, "CoordinateChart::command", ""),
    ("section 2", "a mobile base is link 1", "link n: links count from the tip", JOINT, "Joint", ""),
    ("text before (14)", "(6) is compared with (13)", "(2) is", DENSE, "task_terms", ""),
    ("text after (16)", "F(0) is computed from (4)", "F_c(0) is", LAW, "Controller::tip_force", ""),
    ("(17)", "H* is 6n x 6n", "6n x n; 6n x m with m joint velocities", OPERATORS, "fill_geometry", ""),
    ("text after (18), (19)", "l~ is a three-vector", "l is; l~ is the 3 x 3 matrix of l x", MAP, "Shift", ""),
    ("text after (33)", "(33) holds from k = 1", "psi(1,0) = phi(1,0): link 0 has no joint", SWEEPS,
     "sweep_articulated", ""),
    ("text after (40)", "phi takes H* thd to V", "phi* does", SWEEPS, "velocity_step", "proof"),
    ("(46)", "J thd on the left", "Jdot thd", RESOLVED, "ResolvedAcceleration::sweep", "proof"),
    ("text before (60)", "derived from (11), (51), (52)", "from (11), (38), (51), (53)", IDENTITIES,
     "tip_compliance_long", ""),
    ("text after (68)", "the right side of (72)", "of (65)", SWEEPS, "compliance_at_tip", ""),
    ("(73)", "eta, the name that (67) has given away", "eta_g", SWEEPS, "sweep_gravity", ""),
    ("section 4.3", "for c(0) + g(0) only a(n) changes", "a_g is also added on the right of (68); "
     "without it c(0) + g(0) is wrong by Lambda(0) a_g", SWEEPS, "compliance_at_tip", "proof, print, faults"),
]

# On how many of the arms of `--exact --arms 1` the two sides of the printed forms differ; test_paper_map.py runs it.
EXACT_ARMS = 22
PRINTED_NOT_ZERO = (22, 21, 22, 22)


class Wrong(Exception):
    """A source is not what this file takes it for, or does not have what is named here."""


def source(name):
    path = ROOT / name
    if not path.is_file():
        raise Wrong(f"no file {name}")
    return path.read_text()


def code(text):
    """Without comments and preprocessor lines."""
    return re.sub(r"//[^\n]*|^#[^\n]*", "", text, flags=re.M)


def definition(name):
    """Pattern of the line that begins a type or function."""
    head = r"^[ \t]*(?:template <[^\n]*> )?(?:(?:constexpr|inline|static|explicit) )*"
    result = r"(?!(?:return|else|throw|case|new)\b)[A-Za-z_][\w:]*(?:<[^;{}()]*>)?[ &*]+"
    kind = r"(?:struct|class|enum class|using)\s+" + name + r"\b(?!\s*;)"
    return re.compile(f"{head}(?:{kind}|{result}{name}\\()", re.M)


def defines(text, name):
    """Whether the C++ text defines `name`, or declares it; `Class::member` in a header or beside one."""
    text = code(text)
    if "::" not in name:
        return bool(definition(name).search(text))
    if definition(name).search(text):
        return True
    kind, member = name.split("::")
    at = re.search(rf"^(?:struct|class) {kind}\b[^;]*?\{{", text, re.M)
    return bool(at and definition(member).search(text, at.end(), text.index("\n};", at.end())))


def has_test(text, file, name):
    if file.endswith(".py"):
        return f"def {name}(" in text
    cases = re.findall(r'TEST_CASE\(\s*((?:"[^"]*"\s*)+)[,)]', text)
    return name in [strings(case) for case in cases]


def strings(literals):
    """What adjacent C++ string literals say."""
    return "".join(re.findall(r'"([^"]*)"', literals))


def table(text, function, row):
    """The rows of `static const std::vector<...> table = {...};` in a function. row: pattern of one of them."""
    body = re.search(rf"& {function}\(\) \{{.*?table = \{{\n(.*?)\n  \}};", text, re.S)
    if not body:
        raise Wrong(f"no table in {function}()")
    rows = [m.groups() for m in re.finditer(row, body[1])]
    if not rows or len(rows) != len(re.findall(r'^      \{"', body[1], re.M)):
        raise Wrong(f"a row of {function}() is not understood")
    return rows


TEXT = r'((?:"[^"]*"\s*)+)'


def identities(function="identities"):
    """Equation, statement, file, function."""
    out = []
    pattern = rf"\{{{TEXT},\s*{TEXT},\s*(\w+)<S>(?:,\s*true)?\}}"
    for equation, statement, name in table(source(IDENTITIES), function, pattern):
        file = IDENTITIES if defines(source(IDENTITIES), name) else RELATIONS
        out.append((strings(equation), strings(statement), file, name))
    return out


def recursions():
    """The same; the function is the one that runs it."""
    out = []
    for found in table(source("src/paper/recursions.hpp"), "recursions", rf"\{{{TEXT},\s*{TEXT},\s*{TEXT},\s*\[\]"):
        equation, statement, name = map(strings, found)
        out.append((equation, statement, home(name), name))
    return out


def home(name):
    """The file of src/recursion or src/spatial that defines `name`."""
    files = [f"src/{layer}/{path.name}" for layer in ("recursion", "spatial")
             for path in sorted((ROOT / "src" / layer).glob("*.hpp")) if defines(path.read_text(), name)]
    if len(files) != 1:
        raise Wrong(f"{name} is defined in {files or 'no file'}")
    return files[0]


def printed_forms():
    """Equation and statement, in the order in which `osculate paper --exact` prints them."""
    more = re.findall(rf"out\.push_back\(\{{{TEXT},\s*{TEXT},\s*\"\w+\"\}}\)", source("src/paper/tables.cpp"))
    if len(more) != 1:
        raise Wrong("printed_forms() of src/paper/tables.cpp is not understood")
    return [row[:2] for row in identities("printed_errors")] + [tuple(map(strings, more[0]))]


def bounds():
    """Number of states; and constant, worst of every statement, identities first, as src/paper/bounds.hpp has them."""
    text = source("src/paper/bounds.hpp")
    states = re.search(r"measured_states = (\d+);", text)
    size = re.search(r"std::array<PaperBound, (\d+)>", text)
    rows = re.findall(r"^ *\{([\d.e+-]+), ([\d.e+-]+), \d+\},  // (.*)$", text, re.M)
    told = [f"{row[0]} {row[1]}" for row in identities() + recursions()]
    if not states or not size or len(rows) != int(size[1]) or [row[2] for row in rows] != told:
        raise Wrong("src/paper/bounds.hpp is not in the order of the tables; run ./dev bounds")
    return states[1], [row[:2] for row in rows]


def study(name):
    value = re.search(rf"{name} = ([\d.]+);", source("tests/paper/paper_study.cpp"))
    if not value:
        raise Wrong(f"tests/paper/paper_study.cpp has no {name}")
    return value[1]


def numbers(equation):
    """[64, 65] of "(64), (65)"; none of a section, a range or "-"."""
    return [int(n) for n in re.findall(r"\d+", equation)] if re.fullmatch(r"\(\d+\)(, \(\d+\))*", equation) else []


def map_rows():
    """Numbered rows in order, rows in words, rows without a place: equation, statement, file, function, tests."""
    numbered, words, others = [(n, *row) for n, *row in BY_HAND], list(IN_WORDS), []
    for found, tests in ((recursions(), "proof, bounds"), (identities(), "proof, bounds")):
        for equation, *row in found:
            numbered += [(n, *row, tests) for n in numbers(equation)]
            if equation == "-":
                others.append((equation, *row, tests))
            elif not numbers(equation):
                words.append((equation, *row, tests))
    numbered.sort(key=lambda row: row[0])
    words.sort(key=lambda row: (not row[0].startswith("section"), row[0]))
    return [(f"({n})", *row) for n, *row in numbered], words, others


def quoted(statement):
    """In backticks where it has signs that Markdown would take for its own."""
    return f"`{statement}`" if re.search(r"[*=~^_]", statement) and "`" not in statement else statement


def shown(row):
    equation, statement, file, name, tests = row
    statement = re.sub(r"\bthe same(?! sweeps)", "T of (16)", statement)  # as the rows before it in their table
    return f"| {equation} | {quoted(statement)} | [{file.removeprefix('src/')}](../{file}) | `{name}` | {tests} |"


def lines(rows):
    return ["| equation | statement | file | function | test |", "|---|---|---|---|---|", *map(shown, rows)]


def paragraph(*words):
    return textwrap.fill(" ".join(words), 120, break_long_words=False, break_on_hyphens=False)


def page():
    numbered, words, others = map_rows()
    states, constants = bounds()
    about = identities() + recursions()
    out = [
        "# The paper, line by line", "",
        paragraph("Made by `tests/paper/paper_map.py` from the tables in the sources, kept true by",
                  "`tests/paper/test_paper_map.py`. Equations: Kreutz-Delgado, Jain and Rodriguez (1992). A star is",
                  "the adjoint, `thd` the joint velocities, `phi~` phi less one. To see the numbers of an arm:"), "",
        "    osculate paper MODEL.urdf [--tip LINK] [--states N] [--exact]", "",
        paragraph("It prints every statement of [the table of bounds](#bounds) with its worst residual over N random",
                  "states. With `--exact` it also evaluates each over fractions, where both sides must be equal to the",
                  "last digit, and ends with the [printed forms](#where-the-print-is-wrong) that are not. Exit code 1:",
                  "a statement does not hold, or a printed form that is wrong does."), "",
        "## Equations", "",
        paragraph("`recursion` and `control` run; `reference` judges, and shares no formula with them. Tests go by the",
                  "short names of [this list](#tests)."), "",
        paragraph("Beyond the paper: joints may have up to six velocities, motors inertia Jm, the base may move with",
                  "V(n+1), and the task may have fewer than six rows. Lambda(0) exists at full rank only, so what the",
                  "paper says of c(0) and g(0) is stated for Omega(0) c(0) and Omega(0) g(0)."), "",
        *lines(numbered), "", "## In words", "", *lines(words), "", "## Without a number", "", *lines(others), "",
        "## Tests", "", "| short | file | test |", "|---|---|---|",
        *[f"| {short} | [{file.removeprefix('tests/')}](../{file}) | {name} |"
          for file, tests in TESTS.items() for short, name in tests.items()], "",
        "## Where the print is wrong", "",
        paragraph("The last column names the tests that find the printed form to be wrong; where it has none, no test",
                  "evaluates that form."), "",
        "| place | as printed | here | file | function | shown by |", "|---|---|---|---|---|---|",
        *[f"| {place} | {wrong} | {right} | [{file.removeprefix('src/')}](../{file}) | `{name}` | {tests or '-'} |"
          for place, wrong, right, file, name, tests in MISPRINTS], "",
        f"Over exact fractions, on the {EXACT_ARMS} arms of `--exact --arms 1`:", "",
        "| place | as printed | not 0 on |", "|---|---|---|",
        *[f"| {equation} | {quoted(statement)} | {count} arms |"
          for (equation, statement), count in zip(printed_forms(), PRINTED_NOT_ZERO, strict=True)], "",
        "The text after (40) is right for one link, where phi = phi* = 1.", "",
        "## Bounds", "",
        paragraph(f"Measured by `./dev bounds` over {states} random states: one in three of an arm in `models/`, one",
                  "in three of a random arm of 1 to 8 revolute and prismatic joints, one in three of 1 to 5 joints of",
                  "all types. A residual is the largest |left - right| over the largest magnitude of the terms that",
                  "were added to make the two sides. `worst` is the largest residual seen, in units of eps; `bound` is",
                  f"{study('margin')} times the larger of that and {study('least_worst')}."),
        "", "| equation | statement | worst | bound |", "|---|---|---|---|",
        *[f"| {row[0]} | {quoted(row[1])} | {worst} | {constant} |"
          for row, (constant, worst) in zip(about, constants, strict=True)],
    ]
    return "\n".join(out) + "\n"


def faults_of(text):
    """What a page says that is not so: equations that are missing, files, functions and tests that do not exist."""
    out = []
    sections = dict(re.findall(r"^## ([^\n]*)\n(.*?)(?=^## |\Z)", text, re.M | re.S))
    if missing := {"Equations", "In words", "Without a number", "Tests", "Where the print is wrong"} - set(sections):
        return [f"no section {name}" for name in sorted(missing)]

    def rows(section):
        cells = [line.strip("| ").split(" | ") for line in sections[section].splitlines() if line.startswith("| ")]
        return cells[1:]

    tests = {}
    for short, link, name in rows("Tests"):
        tests[short] = file = link.split("](../")[1].rstrip(")")
        if not (ROOT / file).is_file() or not has_test((ROOT / file).read_text(), file, name):
            out.append(f"no test {name} in {file}")
    found = [int(row[0].strip("()")) for row in rows("Equations")]
    out += [f"equation ({n}) is missing" for n in range(1, EQUATIONS + 1) if n not in found]
    if found != sorted(found):
        out.append("equations are out of order")
    places = [row for section in ("Equations", "In words", "Without a number") for row in rows(section)]
    places += [row[2:] if len(row) > 3 else [] for row in rows("Where the print is wrong")]
    for row in filter(None, places):
        file, name = row[-3].split("](../")[1].rstrip(")"), row[-2].strip("`")
        if not (ROOT / file).is_file():
            out.append(f"no file {file}")
        elif not defines((ROOT / file).read_text(), name):
            out.append(f"no {name} in {file}")
        out += [f"no test called {short}" for short in row[-1].split(", ") if short not in tests and short != "-"]
    used = {short for row in filter(None, places) for short in row[-1].split(", ")}
    return out + [f"nothing is tested by {short}" for short in tests if short not in used]


def main():
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    try:
        text = page()
        faults = faults_of(text)
    except Wrong as wrong:
        faults = [str(wrong)]
    for fault in faults:
        print(f"paper_map: {fault}", file=sys.stderr)
    if faults:
        return 1
    pathlib.Path(sys.argv[1]).write_text(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
