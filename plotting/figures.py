"""All figures by name: each takes an open Result, or an open Sweep, and returns a matplotlib Figure.

A function raises NotApplicable, with the reason, where the file holds nothing that its figure could show.
"""
from measured import cross_coupling, error_growth, frequency_response, poles
from motion import condition, energy, joints, tip
from numerics import global_error, residuals, solver
from situations import contact, departure, manipulability, self_motion
from style import NotApplicable  # noqa: F401  for who calls the figures
from sweeps import comparison, slopes

FIGURES = {
    "joints": joints,
    "tip": tip,
    "residuals": residuals,
    "energy": energy,
    "solver": solver,
    "condition": condition,
    "global_error": global_error,
    "manipulability": manipulability,
    "departure": departure,
    "contact": contact,
    "self_motion": self_motion,
    "cross_coupling": cross_coupling,
    "error_growth": error_growth,
    "frequency_response": frequency_response,
    "poles": poles,
}

SWEEP_FIGURES = {
    "comparison": comparison,
    "slopes": slopes,
}
