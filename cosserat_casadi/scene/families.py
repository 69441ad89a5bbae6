"""Open families of records: kinds of loads, actuators, supports, joints and others that a word tells apart.

A kind is registered once. Unions, the words in error messages, references, inputs, the JSON schema and the reference
page are made from the family on demand, so that a kind that is registered late is treated like any other.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Generic, TypeVar, cast, get_args, get_origin

from pydantic import BaseModel, GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationError
from pydantic.fields import FieldInfo
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.scene.faults import Fault, Table, shown
from cosserat_casadi.scene.records import Record, refusal, restated
from cosserat_casadi.spelling import likely_meant

Member = TypeVar("Member", bound=Record)


class Family(Generic[Member]):
    """Records in one list or under one key of a scene that a word tells apart.

    It annotates a type: ``Annotated[LoadRecord, LOADS]`` is any record that is registered with ``LOADS``.

    Attributes:
        table: key of their list, such as "loads".
        key: the key of the word, such as "kind".
        default: the word of a table without one; None if it must have one.
        records: the record of each word, in the order in which they were registered.
    """

    def __init__(self, table: str, key: str = "kind", default: str | None = None) -> None:
        self.table = table
        self.key = key
        self.default = default
        self.records: dict[str, type[Member]] = {}

    def register(self, record: type[Member]) -> type[Member]:
        """Add a kind; decorates the class of its record.

        Raises:
            ValueError: another record has the same word, or the record does not have one word.
        """
        word = word_of(record, self.key)
        if word in self.records:
            first = self.records[word].__name__
            raise ValueError(f"{self.table} have a {self.key} {word!r} already: {first}")
        self.records[word] = record
        return record

    def record_of(self, given: Table) -> type[Member] | None:
        """The record of a table, by its word; None if the word is faulty or missing."""
        word = given.get(self.key, self.default)
        if not isinstance(word, str):
            return None
        return self.records.get(word)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        # A union would be frozen when the class of the scene is made; a function asks the family each time.
        return core_schema.no_info_plain_validator_function(self._validated)

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        # Only this description is a union: it is made from the kinds that are registered now.
        choices = {word: _referable(record) for word, record in self.records.items()}
        union = core_schema.tagged_union_schema(choices, discriminator=_no_word)
        return handler(union)

    def _validated(self, value: Any) -> Member:
        # A scene may be built from records in Python as well as from tables.
        if isinstance(value, BaseModel):
            given = getattr(value, self.key, self.default)
        elif isinstance(value, Mapping):
            given = value.get(self.key, self.default)
        else:
            raise refusal([Fault((), f"must be a table, got {shown(value)}")])
        word = self._known_word(given)
        record = self.records[word]
        try:
            return record.model_validate(value)
        except ValidationError as error:
            # The mark tells a reader of the location in which record it goes on.
            mark = f"⟨{word}⟩"
            raise restated(error, below=(mark,)) from None

    def _known_word(self, word: Any) -> str:
        if isinstance(word, str) and word in self.records:
            return word
        choices = ", ".join(repr(known) for known in self.records)
        remedy = likely_meant(word, self.records) if isinstance(word, str) else ""
        fault = Fault((self.key,), f"must be one of {choices}, got {shown(word)}", remedy)
        if word is None:
            fault = Fault((self.key,), "missing", f"one of {choices}")
        raise refusal([fault])


def _no_word(value: Any) -> None:
    """Discriminator of a union that serves as a description and is never evaluated."""


def word_of(record: type[Record], key: str = "kind") -> str:
    """The word that tells a record apart in its family.

    Raises:
        ValueError: the record does not have one word.
    """
    field = record.model_fields.get(key)
    # The word is the only value of a Literal, so that pydantic refuses all others.
    words = () if field is None else get_args(field.annotation)
    if len(words) != 1:
        raise ValueError(f"{record.__name__} needs a field {key} with one word, such as Literal['spring']")
    return str(words[0])


class Kinds(dict[str, Any]):
    """The mechanics of the kinds of one family, or of several families with different words, by word.

    Looking up a kind that is registered with the scene format alone raises a `SceneError`.
    """

    def __init__(self, *families: Family[Any]) -> None:
        super().__init__()
        self.families = families

    def add(self, family: Family[Any], member: type[Kind]) -> None:
        """Make a kind known, to the scene format and to the mechanics.

        Args:
            family: the family that its record joins, if it is not in it yet.
            member: the class of the kind.

        Raises:
            ValueError: another class has the same word.
        """
        known = self.get(member.kind)
        if known is not None and type(known) is not member:
            raise ValueError(f"{member.kind!r} is the word of {type(known).__name__} already")
        if family.records.get(member.kind) is not member.record:
            family.register(member.record)
        self[member.kind] = member()

    def __missing__(self, word: str) -> Any:
        for family in self.families:
            if word in family.records:
                raise without_mechanics(family, word)
        raise KeyError(word)


def without_mechanics(family: Family[Any], word: str) -> SceneError:
    """The refusal of a kind that the scene format knows and the mechanics do not."""
    problem = f"{family.key} = {word!r} is read, but nothing says what it does: its mechanics are not registered"
    return SceneError(Problem(family.table, problem, "register the class of its mechanics, as docs/extending.md shows"))


class Kind:
    """A class of the mechanics that stands for one record of a family.

    Attributes:
        record: the record of the scene.
        kind: its word.
        family: the family of the record.
        kinds: the mechanics of that family.
    """

    record: ClassVar[Any]
    kind: ClassVar[str]
    family: ClassVar[Family[Any]]
    kinds: ClassVar[Kinds]

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        if "record" in vars(cls):
            cls.kind = word_of(cls.record, cls.family.key)


KindType = TypeVar("KindType", bound=type[Kind])


def register(member: KindType) -> KindType:
    """Make a kind of any family known, to the scene format and to the mechanics; decorates the class of its mechanics.

    Raises:
        ValueError: another class has the same word.
    """
    member.kinds.add(member.family, member)
    return member


def _referable(record: type[Record]) -> CoreSchema:
    """The core schema of a record under the name by which a JSON schema refers to it, instead of repeating it."""
    schema: Any = dict(record.__pydantic_core_schema__)
    # Pydantic drops the name of a schema that nothing refers to yet, and shortens "module.Name:id" to "Name".
    schema["ref"] = f"{record.__module__}.{record.__qualname__}:{id(record)}"
    return cast(CoreSchema, schema)


def contents_of(field: FieldInfo) -> Family[Any] | type[Record] | None:
    """Kind of the tables under a field: one record, a family of records, or None for a field without tables."""
    return _contents(field.annotation)


def _contents(annotation: Any) -> Family[Any] | type[Record] | None:
    if isinstance(annotation, type) and issubclass(annotation, Record):
        return annotation
    if get_origin(annotation) is Annotated:
        for entry in annotation.__metadata__:
            if isinstance(entry, Family):
                return entry
    # The records in optional values, lists and unions stand one level down.
    for argument in get_args(annotation):
        contents = _contents(argument)
        if contents is not None:
            return contents
    return None
