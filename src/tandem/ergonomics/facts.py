"""Facts about a task: numbers with units and the range in which a method takes them.

Each method has a model of its own, frozen and strict as the parts of a cell are. What is out of
range, unknown or missing is refused all at once, in sentences.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from difflib import get_close_matches
from functools import lru_cache
from typing import Annotated, Any, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError, validate_call
from pydantic.fields import FieldInfo

from tandem.errors import CellError, Fault

UNITS = {
    "deg": "degrees",
    "kg": "kg",
    "cm": "cm",
    "in": "in",
    "lb": "lb",
    "m": "m",
    "m/s": "m/s",
    "min": "min",
    "s": "s",
    "h": "h",
    "1/min": "per minute",
    "1/s": "per second",
    "1/day": "per work day",
    "%": "%",
    "kcal/min": "kcal/min",
    "kgf": "kgf",
    "": "",
}
"""Unit -> how a sentence says it."""


class FactsError(CellError):
    """Facts that a method refuses: out of its range, unknown, missing. Carries every fault."""


def fact(
    what: str,
    unit: str = "",
    low: float | None = None,
    high: float | None = None,
    *,
    above: float | None = None,
    default: Any = ...,
    cautious: Any = None,
    asked: bool = False,
    **named: Any,
) -> Any:
    """The field of a fact.

    Args:
      what: it is, for people.
      unit: it is counted in.
      low, high: the range, its ends included; `above` instead of `low` leaves the end out.
      default: what the published procedure takes when the fact is not stated.
      cautious: what to take where nothing is known, so that the score is rather too high.
      asked: a page that is signed must state it, although the procedure has a default.
    """
    return Field(
        default,
        ge=low,
        gt=above,
        le=high,
        description=what,
        json_schema_extra={"unit": unit, "cautious": cautious, "asked": asked or default is ...},
        **named,
    )


def about(field: FieldInfo) -> dict[str, Any]:
    """What `fact` keeps beside a field: `unit`, `cautious`, `asked`."""
    extra = field.json_schema_extra
    found = dict(extra) if isinstance(extra, dict) else {}
    return {"unit": "", "cautious": None, "asked": field.is_required(), **found}


class Facts(BaseModel):
    """The facts that one method takes. Frozen, strict, no unknown names."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)


F = TypeVar("F", bound=Facts)

Several = Annotated[tuple[F, ...], Field(min_length=1, strict=False)]
"""One or more of the same kind: the tasks of a job."""


def read(model: type[F], facts: Mapping[str, Any] | F, method: str) -> F:
    """The facts as the method's model. Raises FactsError with all that is wrong with them."""
    if isinstance(facts, model):
        return facts
    try:
        return model.model_validate(facts)
    except ValidationError as error:
        raise FactsError(refusals(error, model, method)) from error


@lru_cache
def _checked(function: Callable[..., Any]) -> Callable[..., Any]:
    checked = validate_call(config=ConfigDict(strict=True, allow_inf_nan=False))
    found: Callable[..., Any] = checked(function)
    return found


def call(function: Callable[..., Any], facts: Mapping[str, Any], method: str) -> Any:
    """The function of named numbers, called with facts. Raises FactsError as `read` does."""
    try:
        return _checked(function)(**facts)
    except ValidationError as error:
        raise FactsError(refusals(error, None, method)) from error


def refusals(
    error: ValidationError, model: type[Facts] | None, method: str, prefix: tuple[str, ...] = ()
) -> list[Fault]:
    """One sentence for each thing that is wrong, with value, range and remedy."""
    found, items = [], error.errors()
    for item in items:
        if item["type"] == "too_short" and any(
            other["loc"][: len(item["loc"])] == item["loc"] and other is not item for other in items
        ):
            continue  # what is wrong inside is told; an entry that is refused is an entry
        path = tuple(str(step) if not isinstance(step, int) else step for step in item["loc"])
        name = str(next((step for step in reversed(path) if isinstance(step, str)), "facts"))
        field = _field(model, path)
        message = _sentence(dict(item), name, field, _known(model, path), method)
        found.append(Fault(message, (*prefix, *path)))
    return found


def _model_at(model: type[Facts] | None, path: Iterable[str | int]) -> type[Facts] | None:
    """The model in which the last step of the path is a field."""
    for step in list(path)[:-1]:
        if model is None or isinstance(step, int):
            continue
        field = model.model_fields.get(str(step))
        inner = getattr(field.annotation, "__args__", (None,))[0] if field else None
        model = inner if isinstance(inner, type) and issubclass(inner, Facts) else None
    return model


def _field(model: type[Facts] | None, path: tuple[str | int, ...]) -> FieldInfo | None:
    inner = _model_at(model, path)
    return inner.model_fields.get(str(path[-1])) if inner is not None and path else None


def _known(model: type[Facts] | None, path: tuple[str | int, ...]) -> list[str]:
    inner = _model_at(model, path)
    return list(inner.model_fields) if inner is not None else []


def span(field: FieldInfo | None) -> str:
    """The range of a field in words, such as "0 to 150 degrees"; empty when it has none."""
    if field is None:
        return ""
    ends: dict[str, float] = {}
    for rule in field.metadata:
        for end in ("ge", "gt", "le", "lt"):
            if getattr(rule, end, None) is not None:
                ends[end] = getattr(rule, end)
    unit = UNITS.get(about(field)["unit"], "")
    low = f"{ends['ge']:g}" if "ge" in ends else f"more than {ends['gt']:g}" if "gt" in ends else ""
    if "le" in ends:
        text = f"{low} to {ends['le']:g}" if low else f"at most {ends['le']:g}"
        text = text.replace("more than", "more than") if "gt" in ends else text
    else:
        text = low if "gt" in ends else f"{low} or more" if low else ""
    return f"{text} {unit}".strip() if text else ""


def shown(value: Any) -> str:
    """A value as a message shows it."""
    if isinstance(value, bool) or value is None:
        return "empty" if value is None else str(value).lower()
    if isinstance(value, int | float | str):
        return repr(value) if len(str(value)) <= 60 else f"{str(value)[:57]!r}..."
    return "a mapping" if isinstance(value, Mapping) else "a list"


def _sentence(
    item: dict[str, Any], name: str, field: FieldInfo | None, known: list[str], method: str
) -> str:
    kind, value, context = item["type"], item["input"], item.get("ctx", {})
    unit = UNITS.get(about(field)["unit"], "") if field else ""
    if kind in ("missing", "missing_argument", "missing_keyword_only_argument"):
        return _missing(name, field, method)
    if kind in ("extra_forbidden", "unexpected_keyword_argument"):
        near = get_close_matches(name, known, n=1, cutoff=0.6)
        hint = f"Did you mean {near[0]!r}?" if near else f"It knows {', '.join(known)}."
        return f"{method} knows no fact {shown(name)}. {hint if known else 'Leave it out.'}"
    if kind in ("greater_than", "greater_than_equal", "less_than", "less_than_equal"):
        bounds = span(field) or _bound(kind, context)
        said = f"{value:g} {unit}".strip() if isinstance(value, int | float) else shown(value)
        what = f" ({field.description})" if field and field.description else ""
        return f"{name} is {said}, but {method} takes {bounds}{what}. Correct it."
    if kind in ("literal_error", "enum"):
        return f"{name} is {shown(value)}, but must be {context.get('expected', 'another word')}."
    if kind == "bool_type":
        return f"{name} is {shown(value)}, but must be true or false."
    if kind in ("value_error", "assertion_error"):
        return f"{item['msg'].removeprefix('Value error, ')}"
    if kind in ("too_short", "tuple_type", "list_type"):
        return f"{name} is {shown(value)}, but a list with one entry at least is needed."
    if kind == "finite_number":
        return f"{name} is {shown(value)}, but must be a number. Write the number."
    in_unit = f" of {unit}" if unit else ""
    whole = "whole " if kind.startswith("int") else ""
    return f"{name} is {shown(value)}, but a {whole}number{in_unit} is needed. Write it in digits."


def _bound(kind: str, context: Mapping[str, Any]) -> str:
    words = {"gt": "more than", "ge": "at least", "lt": "less than", "le": "at most"}
    for end, word in words.items():
        if end in context:
            return f"{word} {context[end]:g}"
    return kind


def _missing(name: str, field: FieldInfo | None, method: str) -> str:
    if field is None:
        return f"{name} is missing, which {method} needs. State it."
    bounds = span(field)
    cautious = about(field)["cautious"]
    said = f" ({field.description}{f'; {bounds}' if bounds else ''})"
    way = "State it" if cautious is None else f"State it; a cautious value would be {cautious}"
    return f"{name} is missing, which {method} needs{said}. {way}."
