"""What happens to meshes of certain names before they are read: see intrinsym._isolated_main.TEST_HOOK."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path

import numpy as np

#: Names the folder through which a test and a mesh's process speak.
FOLDER = "INTRINSYM_TEST_FOLDER"


def before_mesh(name: str) -> None:
    """Does what the first word of the file's name says."""
    word = Path(name).stem.split("-")[0]
    if word in ACTIONS:
        ACTIONS[word](name)


def crash(_name: str) -> None:
    """As a defect in native code does."""
    os.kill(os.getpid(), signal.SIGSEGV)


def hang(_name: str) -> None:
    """As an endless loop that no callback interrupts."""
    while True:
        time.sleep(60)


def hungry(_name: str) -> None:
    """Takes memory until there is none."""
    taken = []
    while True:
        taken.append(np.ones(1_000_000))


def killed(name: str) -> None:
    """As the system does that lacks memory for another reason: the first time only."""
    if not said(name, "killed").exists():
        said(name, "killed").touch()
        os.kill(os.getpid(), signal.SIGKILL)


def gate(name: str) -> None:
    """Says which process of Ray works on the mesh, and waits until a test lets it go on."""
    reached = said(name, "reached")
    reached.with_suffix(".new").write_text(str(os.getppid()))
    reached.with_suffix(".new").rename(reached)
    while not said(name, "open").exists():
        time.sleep(0.02)


def said(name: str, what: str) -> Path:
    """A file about a mesh that tests and processes both see."""
    return Path(os.environ[FOLDER]) / f"{Path(name).stem}.{what}"


ACTIONS = {"crash": crash, "hang": hang, "hungry": hungry, "killed": killed, "gate": gate}
