"""A hole of six lobes, see foliate_obstacle."""

from .foliate_obstacle import lobed

EFFECT = lobed(6, "foliate_hexafoil", "a hexafoil, as of broached support plates")
