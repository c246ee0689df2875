"""Tables handed from one compiled function to another by their address.

A table is a named tuple of arrays, and a compiled function takes each array of each table as seven
arguments: compiling the calls would take longer than compiling the arithmetic.
"""

from numba import types
from numba.core import cgutils
from numba.core.typing.templates import AttributeTemplate, infer_getattr
from numba.extending import intrinsic, lower_getattr_generic, models, register_model


class Reference(types.Type):
    """The numba type of a table's address; its attributes are those of the table."""

    def __init__(self, table):
        self.table = table
        super().__init__(name=f"Reference({table.name})")


@register_model(Reference)
class _ReferenceModel(models.PrimitiveModel):
    def __init__(self, manager, kind):
        super().__init__(manager, kind, manager[kind.table].get_value_type().as_pointer())


@infer_getattr
class _Fields(AttributeTemplate):
    key = Reference

    def generic_resolve(self, reference, name):
        fields = reference.table.fields
        return reference.table[fields.index(name)] if name in fields else None


@lower_getattr_generic(Reference)
def _field(context, builder, kind, address, name):
    place = kind.table.fields.index(name)
    return builder.load(cgutils.gep_inbounds(builder, address, 0, place))


@intrinsic
def by_reference(typing_context, table):
    """The table on the stack of the calling function, to be handed on."""

    def code(context, builder, sig, args):
        return cgutils.alloca_once_value(builder, args[0])

    return Reference(table)(table), code
