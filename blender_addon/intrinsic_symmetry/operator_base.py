# SPDX-License-Identifier: GPL-3.0-or-later
"""What all operators of this add-on have in common."""

import re

import bpy
import intrinsym

from . import assembly, carry, counterparts, mesh_data, stored_map

#: A sentence that says that nothing happened: "0 vertices selected", "mask: 0 of 8 values changed".
_NOTHING = re.compile(r"(.*: )?0 ")
#: Advice of the library that is none in Blender: "; export the geometry again", ", or check how it was exported".
_OF_FILES = re.compile(r"(;|, or) (export|check .*export).*")


class MeshOperator:
    """An operator on the active mesh, and on those that are in edit mode with it. `run` does the work on one, in object
    mode, and returns a sentence for the user, or raises; mesh problems and the library's errors are reported in their
    own words."""

    bl_options = {"REGISTER", "UNDO"}
    #: Whether it works on the active object alone, whatever is in edit mode with it or shares its map.
    one_object = False
    #: Whether it works on each object by itself, whatever shares its map.
    each_alone = False
    #: Whether it works on the shape that is shown: that of the active shape key.
    on_shown_shape = False
    #: Whether it leaves the mesh as it is.
    only_reads = False

    @classmethod
    def poll(cls, context):
        problem = mesh_data.why_not(context, cls.only_reads)
        problem = problem or cls.lacks(context, context.active_object) or cls._all_empty(context)
        if problem:
            cls.poll_message_set(problem)
        return problem is None

    @classmethod
    def lacks(cls, _context, _object):
        """What an object lacks for this operator, in words, or nothing."""
        return None

    @classmethod
    def is_empty(cls, _object):
        """Why there is nothing to work on in an object, in words, or nothing."""
        return None

    @classmethod
    def _all_empty(cls, context):
        """Why there is nothing to work on in any of the objects."""
        objects = [*mesh_data.worked_on(context), *assembly.there(context.active_object)]
        problems = [cls.is_empty(object) for object in objects]
        return problems[0] if all(problems) else None

    def execute(self, context):
        mode = context.active_object.mode
        self.objects, self.warnings = mesh_data.worked_on(context)[: 1 if self.one_object else None], []
        done, problems = [], []
        with mesh_data.object_mode(context):
            for object in self.objects:
                try:
                    done.append(self._named(object, self._run_on(context, object, mode)))
                except (mesh_data.MeshProblem, intrinsym.IntrinsymError) as problem:
                    problems.append((object, problem))
        if not done:
            self.report({"ERROR"}, sentence(problems[0][1]))
            return {"CANCELLED"}
        for object, problem in problems:
            if not isinstance(problem, mesh_data.NothingSelected):
                self.warn(self._named(object, sentence(problem)))
        text = ". ".join(filter(None, [*done, *self.warnings]))
        if text:
            self.report({"WARNING" if self.warnings else "INFO"}, text)
        return {"FINISHED"}

    def _run_on(self, context, object, mode):
        """`run` on an object, or once on all that share its map."""
        missing = self.lacks(context, object) if object != self.objects[0] else None  # `poll` saw the active one
        if missing:
            raise mesh_data.MeshProblem(missing)
        if self.one_object or self.each_alone:
            return self.run(context, object, mode)
        self.members = members = assembly.members_of(object)
        if any(earlier in members for earlier in self.objects[: self.objects.index(object)]):
            return ""
        if self.on_shown_shape:
            self._say_other_shapes(members)
            self._say_multires(members)
        held = []
        with assembly.whole(members, self.objects if mode == "EDIT" else None, held) as body:
            if problem := self.is_empty(body):
                raise mesh_data.MeshProblem(problem)
            said = self.run(context, body, mode)
        self.leave(held, "hidden")
        return said

    def _say_other_shapes(self, members):
        """Of objects that share a map, the shape key of one is worked on in all."""
        name = mesh_data.shown_key(bpy.context.active_object)
        others = [each.name for each in members if each.data.shape_keys and mesh_data.shown_key(each) != name]
        if others:
            what = f'the shape key "{name}"' if name else "the basis"
            self.warn(f"Worked on {what} in all objects; another one is active in {counterparts.listed(others)}")

    def _say_multires(self, members):
        names = [each.name for each in members if mesh_data.has_multires(each)]
        if names:
            self.warn(f"The base mesh alone: the Multires detail of {counterparts.listed(names)} is not mirrored")

    def _named(self, object, text):
        """The text with the object's name, where several are worked on."""
        return f"{object.name}: {text}" if text and len(self.objects) > 1 else text or ""

    def warn(self, text):
        """Something that the user has to know besides what `run` returns."""
        self.warnings.append(text)

    def leave(self, names, why):
        """Says which groups or keys are left alone."""
        if names:
            self.warn(f"Left alone: {counterparts.listed(names)} ({why})")

    def fill(self, names):
        """Says which groups or keys of one side are copied onto the other, though their names say no side."""
        if names:
            self.warn(f"Copied onto the other side: {counterparts.listed(names)} (no side in the name)")


class MapOperator(MeshOperator):
    """An operator that needs a stored map; `run_with` is given it."""

    @classmethod
    def lacks(cls, _context, object):
        return stored_map.why_none(object)

    def run(self, context, object, mode):
        symmetry, carried = carry.loaded(object.data)
        said = self.run_with(symmetry, context, object, mode)
        staying = self.staying(object, mode) if self.on_shown_shape or _NOTHING.match(said) else ""
        return ". ".join(filter(None, [said, staying, self._untouched(symmetry), carried]))

    def staying(self, object, mode):
        """Which vertices do not change or are not selected, and why, in words."""
        return stay(mesh_data.changeable(object.data, mode), "hidden, masked or outside the paint selection")

    def _untouched(self, symmetry):
        """What share of the vertices a tool that trusts some and others not has not touched."""
        least = getattr(self, "minimum_confidence", None)
        if least is None:
            return ""
        share = ((symmetry.partner < 0) | (symmetry.confidence < least)).mean()
        certain = ", or none certain enough," if least else ""
        return f"{share:.1%} of the vertices have no mirror image{certain} and are not touched" if share else ""


def stay(free, why):
    """How many vertices stay, of which `free`, (vertices,), says how far each may change, in words."""
    count = int((free == 0).sum())
    return f"{count} vertices are {why}, and stay" if count else ""


def in_words(problem):
    """The text of an error, without what it says of files."""
    return _OF_FILES.sub("", str(problem))


def sentence(problem):
    """That with a capital letter."""
    text = in_words(problem)
    return text[:1].upper() + text[1:]
