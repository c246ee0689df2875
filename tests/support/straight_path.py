"""A straight tube or bar from the origin, as the section `structure` of a configuration."""


def straight_path(length, along, section, material, ends=("clamped", "free"), **keys):
    """length: m. along (3,). material: (Young's modulus in Pa, Poisson's ratio, kg/m³)."""
    names = ("young_modulus_Pa", "poisson_ratio", "density_kg_per_m3")
    return {
        "kind": "path",
        "section": section,
        "material": dict(zip(names, material, strict=True)),
        "start_m": [0.0, 0.0, 0.0],
        "start_direction": along,
        "segments": [{"kind": "straight", "length_m": length}],
        "start": {"kind": ends[0]},
        "end": {"kind": ends[1]},
    } | keys
