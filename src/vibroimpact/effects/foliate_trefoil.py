"""A hole of three lobes, see foliate_obstacle."""

from .foliate_obstacle import lobed

EFFECT = lobed(3, "foliate_trefoil", "a trefoil, as of broached support plates")
