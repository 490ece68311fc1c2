# SPDX-License-Identifier: GPL-3.0-or-later
"""What all operators of this add-on have in common."""

import intrinsym

from . import counterparts, mesh_data, stored_map


class MeshOperator:
    """An operator on the active mesh. `run` does the work in object mode and returns a sentence for the user, or
    raises; mesh problems and the library's errors are reported in their own words."""

    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        problem = mesh_data.why_not(context)
        if problem:
            cls.poll_message_set(problem)
        return problem is None

    def execute(self, context):
        mode = context.active_object.mode
        self.warnings = []
        try:
            with mesh_data.object_mode(context) as object:
                text = self.run(context, object, mode)
        except (mesh_data.MeshProblem, intrinsym.IntrinsymError) as problem:
            self.report({"ERROR"}, sentence(problem))
            return {"CANCELLED"}
        if text or self.warnings:
            self.report({"WARNING" if self.warnings else "INFO"}, ". ".join([text, *self.warnings]))
        return {"FINISHED"}

    def warn(self, text):
        """Something that the user has to know besides what `run` returns."""
        self.warnings.append(text)

    def leave(self, names, why):
        """Says which groups or keys are left alone."""
        if names:
            self.warn(f"Left alone: {counterparts.listed(names)} ({why})")


class MapOperator(MeshOperator):
    """An operator that needs a stored map; `run_with` is given it."""

    @classmethod
    def poll(cls, context):
        problem = mesh_data.why_not(context) or stored_map.why_none(context.active_object)
        if problem:
            cls.poll_message_set(problem)
        return problem is None

    def run(self, context, object, mode):
        return self.run_with(stored_map.load(object.data), context, object, mode)


def sentence(problem):
    """The text of an error with a capital letter."""
    text = str(problem)
    return text[:1].upper() + text[1:]
