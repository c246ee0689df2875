"""The JSON schema of a configuration, for editors and for other programs."""

from typing import Any

from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue
from pydantic_core import core_schema, to_jsonable_python

from .declared_keys import examples_of, meaning_of, unit_of
from .schema import Config


def json_schema() -> dict[str, Any]:
    """Return the JSON schema (draft 2020-12) of a configuration.

    Every key has a description, and every number its `unit`.
    """
    schema = Config.model_json_schema(schema_generator=_WithUnits)
    return {"$schema": GenerateJsonSchema.schema_dialect, "title": "vibroimpact study", **schema}


class _WithUnits(GenerateJsonSchema):
    """Pydantic's JSON schema with units and examples of keys, no titles."""

    def field_title_should_be_set(self, schema: Any) -> bool:
        """Return False: a title made of the key's name says nothing new."""
        return False

    def model_schema(self, schema: core_schema.ModelSchema) -> JsonSchemaValue:
        """Return the JSON schema of a section, with the unit and the examples of each key."""
        section = super().model_schema(schema)
        section.pop("title", None)
        section["description"] = meaning_of(schema["cls"])
        for name, field in schema["cls"].model_fields.items():
            key = section["properties"][name]
            if unit := unit_of(name, field):
                key["unit"] = unit
            if examples := examples_of(field):
                key["examples"] = to_jsonable_python(examples)
        return section
