"""Operational space control of serial arms: every term at given states, torques, verified runs, and a judge of logged torques.

SI units and radians. Joints base to tip. Six-vectors angular part first, in the base link's frame, about the tip point;
accelerations are ordinary ones. The classes are described in docs/python.md.
"""
from osculate._core import (
    Chain,
    Claim,
    Coefficient,
    ConfigError,
    Doubt,
    Error,
    Experiment,
    FileError,
    Finding,
    Judgement,
    LogError,
    ModelError,
    Run,
    SingularArm,
    Stopped,
    Terms,
    TermSide,
    judge,
    version,
)

__all__ = [
    "Chain",
    "Claim",
    "Coefficient",
    "ConfigError",
    "Doubt",
    "Error",
    "Experiment",
    "FileError",
    "Finding",
    "Judgement",
    "LogError",
    "ModelError",
    "Run",
    "SingularArm",
    "Stopped",
    "TermSide",
    "Terms",
    "judge",
    "version",
]
