# SPDX-License-Identifier: GPL-3.0-or-later
"""What the network says of each eigenfunction of a mesh, and what the user says: even, odd or neither."""

import bpy

#: Identifier, name, help; and what the core takes for a known sign.
JUDGEMENTS = (
    ("UNJUDGED", "-", "Not judged: the network and the search decide"),
    ("EVEN", "Even", "The function is its own mirror image"),
    ("ODD", "Odd", "The function is the negative of its mirror image"),
    ("NEITHER", "Neither", "The function is neither even nor odd; the search decides"),
)
_SIGNS = {"EVEN": 1, "ODD": -1, "UNJUDGED": 0, "NEITHER": 0}


class IntrinsicSymmetryEigenfunction(bpy.types.PropertyGroup):
    """One eigenfunction, counted from 1 by rising eigenvalue, the constant left out."""

    even: bpy.props.FloatProperty(name="Even", description="Probability of even, says the network")
    odd: bpy.props.FloatProperty(name="Odd", description="Probability of odd, says the network")
    neither: bpy.props.FloatProperty(name="Neither", description="Probability of neither, says the network")
    judgement: bpy.props.EnumProperty(
        name="Judgement", description="What you see; it overrules the network", items=JUDGEMENTS
    )


def of(mesh):
    """The collection of a mesh; empty before its first detection."""
    return mesh.intrinsic_symmetry_eigenfunctions


def known_signs(mesh):
    """1 even, -1 odd, 0 unknown, from the first eigenfunction on; empty where nothing is known."""
    signs = [_SIGNS[entry.judgement] for entry in of(mesh)]
    return signs if any(signs) else []


def active(mesh):
    """The eigenfunction that is shown, or nothing."""
    number, entries = mesh.intrinsic_symmetry_eigenfunction, of(mesh)
    return entries[number - 1] if 1 <= number <= len(entries) else None


def judged(mesh):
    """Eigenfunctions, counted from 1, to even, odd or neither; those that were judged."""
    entries = enumerate(of(mesh), start=1)
    return {number: entry.judgement.lower() for number, entry in entries if entry.judgement != "UNJUDGED"}


def make_entries(mesh, count):
    """At least as many entries as eigenfunctions."""
    while len(of(mesh)) < count:
        of(mesh).add()


def take_predictions(mesh, report):
    """Keeps the network's answers of a detection's report; of a sign that the user knew it says nothing."""
    signs = report.signs
    make_entries(mesh, len(signs))
    for entry, sign in zip(of(mesh), signs):
        if _SIGNS[entry.judgement] == 0:
            entry.even, entry.odd, entry.neither = sign.even, sign.odd, sign.neither


def network_says(entry):
    """Its likeliest answer and the probability, as text; empty without a network."""
    answers = {"even": entry.even, "odd": entry.odd, "neither": entry.neither}
    best = max(answers, key=answers.get)
    return f"{best} {answers[best]:.0%}" if answers[best] > 0 else ""


def register():
    bpy.utils.register_class(IntrinsicSymmetryEigenfunction)
    bpy.types.Mesh.intrinsic_symmetry_eigenfunctions = bpy.props.CollectionProperty(
        type=IntrinsicSymmetryEigenfunction
    )
    bpy.types.Mesh.intrinsic_symmetry_eigenfunction = bpy.props.IntProperty(
        name="Eigenfunction", description="The one that is shown, counted from 1 by rising eigenvalue", default=1, min=1
    )


def unregister():
    del bpy.types.Mesh.intrinsic_symmetry_eigenfunction
    del bpy.types.Mesh.intrinsic_symmetry_eigenfunctions
    bpy.utils.unregister_class(IntrinsicSymmetryEigenfunction)
