"""The keys of the material of a tube: numbers, or the name of a metal.

A value that is left out becomes that of the named metal when the configuration is read, so that the
configuration as it runs holds the numbers.
"""

from functools import partial
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from pydantic import ConfigDict, Field, ValidationInfo, field_validator
from pydantic.config import JsonDict, JsonValue
from pydantic_core import PydanticCustomError

from .materials.solids import SOLIDS, solid_properties
from .quantities import NOT_GIVEN, Density, Poisson_ratio, Section, Temperature_C, Youngs_modulus_Pa

if TYPE_CHECKING:
    Metal: TypeAlias = str
else:
    Metal = Literal[tuple(SOLIDS)]
ROOM_TEMPERATURE_C = 20.0
OR_NAMED = "Null for that of the named metal."


def named_or_given(*keys: str, instead: str | None = None) -> ConfigDict:
    """Return the settings of a section whose defaults are looked up: its JSON schema states a name,
    or all of some keys, or a section that stands `instead` of them.
    """
    named: JsonDict = {"required": ["name"], "properties": {"name": {"type": "string"}}}
    choices: list[JsonValue] = [named, {"required": list(keys)}]
    if instead is not None:
        choices.append({"required": [instead], "properties": {instead: {"type": "object"}}})
    return ConfigDict(json_schema_extra={"anyOf": choices}, validate_default=True)


def named_temperature(value: Any, info: ValidationInfo, properties: Any) -> Any:
    """Return the temperature in °C of a named material: that given, 20 °C, or None without a name.

    properties: function of name and temperature that raises ValueError outside the known range.
    Raises PydanticCustomError with a sentence.
    """
    name = info.data.get("name")
    if name is None:
        if value is not None and "name" in info.data:
            raise PydanticCustomError("unused", "has no effect without a name: leave it out")
        return value
    value = ROOM_TEMPERATURE_C if value is None else value
    try:
        properties(name, value)
    except ValueError as error:
        raise PydanticCustomError("range", "is out of range: {why}", {"why": str(error)}) from None
    return value


def given_or_named(value: Any, info: ValidationInfo, properties: Any) -> Any:
    """Return a value, or that of the named material at its temperature if it is None.

    Raises PydanticCustomError if there is neither.
    """
    if value is not None or "name" not in info.data or "temperature_C" not in info.data:
        return value  # name or temperature are a problem of their own
    if info.data["name"] is None:
        raise PydanticCustomError(NOT_GIVEN, "is missing: give it, or a name whose value is taken")
    return getattr(properties(info.data["name"], info.data["temperature_C"]), str(info.field_name))


class Material(Section):
    """The linear elastic material of the tube: numbers, or a named metal. Numbers given next to a
    name replace those of the metal.
    """

    model_config = named_or_given("young_modulus_Pa", "poisson_ratio", "density_kg_per_m3")
    name: Metal | None = Field(
        None, description="Name of a metal; null for numbers.", examples=["inconel_600"]
    )
    temperature_C: Temperature_C | None = Field(
        None, description="Temperature of the named metal; null for 20 °C.", examples=[300.0]
    )
    young_modulus_Pa: Youngs_modulus_Pa | None = Field(
        None, description=f"Young's modulus. {OR_NAMED}", examples=[2.02e11]
    )
    poisson_ratio: Poisson_ratio | None = Field(
        None, description=f"Poisson's ratio. {OR_NAMED}", examples=[0.3]
    )
    density_kg_per_m3: Density | None = Field(
        None,
        description=f"Mass per volume of the material. {OR_NAMED} The mass of a fluid can be"
        " included here, or stated in structure.fluid.",
        examples=[8330.0],
    )

    _temperature = field_validator("temperature_C")(
        partial(named_temperature, properties=solid_properties)
    )
    _property = field_validator("young_modulus_Pa", "poisson_ratio", "density_kg_per_m3")(
        partial(given_or_named, properties=solid_properties)
    )
