"""Values of the parameters of an effect, as shares of their ranges."""

from vibroimpact.diagnosis.explanations import Term
from vibroimpact.effects.places import with_place
from vibroimpact.effects.registry import EFFECTS


def term_at(effect_id, location, share, sizes):
    """The Term of an effect whose parameters are at a share, 0 to 1, of their ranges."""
    values, shares = [], {}
    for parameter in EFFECTS[effect_id].parameters:
        low, high = parameter.low, parameter.high
        own = low * (high / low) ** share if parameter.log else low + (high - low) * share
        shares[parameter.name] = own
        over = shares[parameter.over] if parameter.over in shares else 1.0
        values.append(float(own * over * sizes[parameter.per]))
    return Term(effect_id, location, tuple(values))


def with_term(values, term):
    """The configuration in plain values with a Term."""
    return term.effect.apply(with_place(values, term.location), term.parameters, term.location)
