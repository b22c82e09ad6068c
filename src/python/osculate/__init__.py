"""Operational space control of serial arms: every term at given states, torques, and verified runs.

SI units and radians. Joints base to tip. Six-vectors angular part first, in the base link's frame, about the tip point;
accelerations are ordinary ones. The classes are described in docs/python.md.
"""
from osculate._core import (
    Chain,
    Claim,
    ConfigError,
    Error,
    Experiment,
    FileError,
    ModelError,
    Run,
    SingularArm,
    Stopped,
    Terms,
    TermSide,
    version,
)

__all__ = [
    "Chain",
    "Claim",
    "ConfigError",
    "Error",
    "Experiment",
    "FileError",
    "ModelError",
    "Run",
    "SingularArm",
    "Stopped",
    "TermSide",
    "Terms",
    "version",
]
