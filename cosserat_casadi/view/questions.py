"""Questions of a browser, read from its bytes: whatever the bytes are, the outcome is a question or a refusal."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from pydantic import BaseModel, ConfigDict, FiniteFloat, ValidationError


class QuestionError(Exception):
    """The bytes are no question that is answered here."""


class Question(BaseModel):
    """Parts of a question.

    Attributes:
        inputs: stacked inputs; None for null, which JSON has in place of a number.
        position: a point in world axes, m.
        pose: the tip or the body that is led to it: {"rod": name} or {"body": name}.
    """

    model_config = ConfigDict(strict=True, frozen=True)

    inputs: list[FiniteFloat | None] = []
    position: tuple[FiniteFloat, FiniteFloat, FiniteFloat] | None = None
    pose: dict[str, str] = {}

    @classmethod
    def read(cls, content: bytes) -> Question:
        """A question from the JSON that was sent; one without content has no parts.

        Raises:
            QuestionError: it is no JSON object, or a part is not of its type.
        """
        try:
            return cls.model_validate_json(content or b"{}")
        except ValidationError as error:
            fault = error.errors(include_url=False, include_input=False)[0]
            part = fault["loc"][0] if fault["loc"] else "the question"
            raise QuestionError(f"{part}: {fault['msg']}") from None

    def all_inputs(self, count: int) -> list[float | None]:
        """The inputs, which must be so many.

        Raises:
            QuestionError: they are not.
        """
        if len(self.inputs) != count:
            raise QuestionError(f"inputs must be a list of {count}")
        return self.inputs

    def point(self, names: Mapping[str, Collection[str]]) -> tuple[dict[str, str], list[float]]:
        """The rod or body that is led, and where to, of a scene with these names of rods and bodies, by kind.

        Raises:
            QuestionError: a part is missing, or names nothing of the scene.
        """
        if self.position is None or len(self.pose) != 1:
            raise QuestionError("a position, and a pose that names one rod or one body, are asked for")
        ((kind, name),) = self.pose.items()
        if name not in names.get(kind, ()):
            raise QuestionError("pose names no rod and no body of the scene")
        return self.pose, list(self.position)
