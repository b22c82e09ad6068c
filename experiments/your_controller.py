"""A controller of your own: operational space control (4) from the terms that each question carries (law.terms: true)."""
import json
import sys

import numpy as np

json.loads(sys.stdin.readline())  # what does not change: the arm, its joints, the task rows, the gains
print(json.dumps({"protocol": 1}), flush=True)

for line in sys.stdin:
    now = json.loads(line)
    M, C, G, J, Jdot_qd, u = (np.array(now[name]) for name in ("M", "C", "G", "J", "Jdot_qd", "u"))
    Minv_Jt = np.linalg.solve(M, J.T)
    Omega = J @ Minv_Jt                                            # J M^-1 J^T
    F = np.linalg.solve(Omega, u - Jdot_qd + Minv_Jt.T @ (C + G))  # Lambda u + c + g
    print(json.dumps({"torque": (J.T @ F).tolist()}), flush=True)
