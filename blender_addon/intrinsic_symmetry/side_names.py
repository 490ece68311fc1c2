# SPDX-License-Identifier: GPL-3.0-or-later
"""Left and right in names of vertex groups, bones and shape keys, as the common rigs and programs write them.

Where a name has both sides, the last one decides (`Hair_R_end.L` is of the left), as in Blender; but if nothing lies
between them, such as in `Eyes_L_R`, the name is of both and has none.
"""

import re

from . import preferences
from .mesh_data import MeshProblem

#: Bytes of the longest name that Blender keeps; what is longer is cut off.
_MOST_BYTES = 63
#: The words of the left, and those of the right in the same place.
LEFT = "left", "lft", "l", "左", "ひだり", "ヒダリ", "ﾋﾀﾞﾘ"
RIGHT = "right", "rgt", "r", "右", "みぎ", "ミギ", "ﾐｷﾞ"

#: How each convention writes a side; what surrounds the word tells it from the same letters elsewhere.
_CONVENTIONS = (
    # A word or a letter between separators, or at an end. Blender: Arm.L, l_arm, arm-Right.001. Rigify:
    # DEF-upper_arm.L.001. Auto-Rig Pro: arm_stretch.l. Unreal: upperarm_l. VRM and VRoid: J_Bip_L_UpperArm.
    # Source: ValveBiped.Bip01_L_UpperArm. 3ds Max: Bip01 L UpperArm. Daz Genesis 9: l_upperarm. Others: Arm_Lft.
    r"(?<![^\W_])(?i:left|right|lft|rgt|[lr])(?![^\W_])",
    # A word with a capital. Mixamo: mixamorig:LeftArm. MotionBuilder: Character1_LeftArm. ARKit: eyeBlinkLeft.
    r"(?<![A-Z])(?:Left|Right|Lft|Rgt)(?![a-z])",
    # The beginning or the end of the whole name. Blender: leftarm, armright, ARMLEFT; not cleft, leftover, upright, Copyright.
    r"^(?i:left(?!over)|right)",
    r"(?i:(?<!c)left|(?<![bf])(?<!up)(?<!copy)right)$",
    # A small letter before a word. Daz and Poser: lShldr, rThighBend.
    r"(?<![^\W_])[lr](?=[A-Z])",
    # A capital before or after a word. CAT: CATRigLArm. Others: LArm, EyeBlinkL, HandR_01.
    r"(?<![A-Z])[LR](?=[A-Z][a-z])",
    r"(?<=[a-z])[LR](?![A-Za-z])",
    # A capital after a number, where an exporter took the dot away or spelt it. three.js: Palm1L. FBX: LegFBXASC046L.
    r"(?<=\d)[LR](?![^\W_])",
    # Japanese, as in MMD, and Chinese: 左腕, ウィンク右, ひだり腕.
    r"左|右|ひだり|みぎ|ヒダリ|ミギ|ﾋﾀﾞﾘ|ﾐｷﾞ",
)
_ANY = re.compile("|".join(_CONVENTIONS))
#: A capital before a small letter, at the beginning of a word: Lhand, HandLfinger. Lip and Roll begin so, too, and have no side.
_CAPITAL = re.compile(r"(?<![A-Z])[LR](?=[a-z])")


def side(name, names=()):
    """1 for a name of the left, -1 for one of the right, 0 for one without a side. Lhand has one if Rhand is among `names`."""
    return _read(name)[0] or _read_beside(name, names)[0]


def flip(name):
    """The name of the other side; the same name where it has no side."""
    return _read(name)[1]


def counterpart(name, names):
    """The name of the other side as it stands among `names`. Of a name that says its side twice, both may change or the
    last one alone (Hair_R_end.R and Hair_R_end.L). Exporters number every name (Leg_L_019 and Leg_R_022), so one that
    differs in the last number will do, if it is the only one."""
    last, other = _read(name, last_only=True)[1], flip(name)
    if other == name:
        return _read_beside(name, names)[1]
    if last in names:
        return last
    if other in names:
        return other
    there, own = ([each for each in names if _plain(each) == _plain(given)] for given in (other, name))
    return there[0] if len(there) == len(own) == 1 else other


def counterpart_columns(names):
    """(names,) the number of each name's counterpart; -1 where that is not among them."""
    number = {name: column for column, name in enumerate(names)}
    return [number.get(counterpart(name, names), -1) for name in names]


def written_otherwise(made, names):
    """Those of the `made` names that one of `names` without a counterpart differs from in capitals, separators, the place of
    the side or a last number alone: arm.R beside Arm.R, where there is no Arm.L."""
    lone = {(side(name), _bare(name)) for name in names if counterpart(name, names) not in names} if made else set()
    return [name for name in made if (side(name), _bare(name)) in lone]


def is_too_long(name):
    """Whether Blender would cut a name."""
    return len(name.encode()) > _MOST_BYTES


def refuse_too_long(names):
    """Raises MeshProblem where Blender would cut one of the names."""
    for name in filter(is_too_long, names):
        raise MeshProblem(f'"{name}" is too long for Blender: shorten the name')


def _bare(name):
    """A name without its side, capitals, separators and a last number."""
    return re.sub(r"[\W_]", "", _ANY.sub("", re.sub(r"[._ ]\d+$", "", name))).casefold()


def _plain(name):
    return re.sub(r"_\d+$", "", name)


def _read(name, last_only=False):
    """(side, flipped name): by the user's own words, or else by the conventions."""
    left, right = preferences.own_side_words()
    found = 0, name
    if left and right:
        own = re.compile(f"{re.escape(left)}|{re.escape(right)}")
        found = _flipped(own, (left,), (right,), name, last_only)
    return found if found[0] else _flipped(_ANY, LEFT, RIGHT, name, last_only)


def _read_beside(name, names):
    """(side, flipped name) of a name that begins a word as Lhand does, if the other one is among `names` and has no side
    of its own, as Right beside Light; else 0 and the name."""
    for match in reversed(list(_CAPITAL.finditer(name))):
        other = name[: match.start()] + ("R" if match[0] == "L" else "L") + name[match.end() :]
        if other in names and not _read(other)[0]:
            return 1 if match[0] == "L" else -1, other
    return 0, name


def _flipped(pattern, lefts, rights, name, last_only):
    other = dict(zip(lefts + rights, rights + lefts))
    matches = list(pattern.finditer(name))
    if not matches:
        return 0, name
    words = [match[0] if match[0] in other else match[0].lower() for match in matches]
    sides = [1 if word in lefts else -1 for word in words]
    if len(set(sides)) == 2:
        if not re.search(r"[^\W_]", name[matches[-2].end() : matches[-1].start()]):
            return 0, name
        last_only = True
    flipped = name
    for match, word in list(zip(matches, words))[::-1][: 1 if last_only else None]:
        new = other[word] if word == match[0] else _with_capitals_of(match[0], other[word])
        flipped = flipped[: match.start()] + new + flipped[match.end() :]
    return sides[-1], flipped


def _with_capitals_of(model, word):
    return word.upper() if model.isupper() else word.capitalize()
