"""What `import vibroimpact` offers."""

import subprocess
import sys
from pathlib import Path

import pytest

import vibroimpact

PACKAGE = Path(vibroimpact.__file__).parent


def test_importing_the_package_imports_nothing_else():
    code = "import sys, vibroimpact; assert not {'numpy', 'pydantic'} & set(sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True, cwd=PACKAGE.parent)


@pytest.mark.parametrize("name", vibroimpact.PUBLIC)
def test_every_public_name_is_there_and_documented(name):
    value = getattr(vibroimpact, name)
    assert value.__module__ == f"vibroimpact.{vibroimpact.PUBLIC[name]}"
    assert value.__doc__


def test_a_name_that_is_not_public_is_an_attribute_error():
    with pytest.raises(AttributeError, match="no attribute 'load_confg'"):
        _ = vibroimpact.load_confg
    assert set(dir(vibroimpact)) == set(vibroimpact.__all__)


def test_first_frequency_of_a_chain_from_the_public_names():
    stiffness, mass = 63165.46816697191, 1.0  # 40 Hz
    config = vibroimpact.check_config(
        {
            "study": "mine",
            "structure": {
                "kind": "chain",
                "masses": [{"name": "mass", "mass_kg": mass}],
                "springs": [{"between": ["ground", "mass"], "stiffness_N_per_m": stiffness}],
            },
            "excitation": {"kind": "none"},
            "grid": {"load_rms_N": [1.0], "gap_m": [1.0e-3], "seeds": 3},
            "record": {"duration_s": 20.0},
        },
        "mine",
    )
    model = vibroimpact.build_model(config)
    assert model.omega / (2.0 * 3.141592653589793) == pytest.approx([40.0], rel=1e-12)
    assert [case.seed for case in vibroimpact.all_cases(config.grid)] == [0, 1, 2]
