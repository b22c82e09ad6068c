"""All figures by name: each takes an open Result and returns a matplotlib Figure."""
from motion import condition, energy, joints, tip
from numerics import global_error, residuals, solver

FIGURES = {
    "joints": joints,
    "tip": tip,
    "residuals": residuals,
    "energy": energy,
    "solver": solver,
    "condition": condition,
    "global_error": global_error,
}
