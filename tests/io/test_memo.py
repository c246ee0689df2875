"""Results kept by content: the same object for the same content, another for another, and no more
than a few.
"""

import numpy as np

from vibroimpact.config.reading import check_config
from vibroimpact.io.memo import MAX_ENTRIES, Memo, content_key
from vibroimpact.reduction.reduced_model import build_model
from vibroimpact.structure.tube import build_structure


def test_result_is_computed_once_and_the_oldest_dropped():
    kept, made = Memo(), []
    for key in (0, 0, *range(MAX_ENTRIES + 1), 0):
        kept.get(key, lambda key=key: made.append(key))
    assert made == [0, *range(1, MAX_ENTRIES + 1), 0]


def test_memo_keys_distinguish_contents_and_shapes():
    rows = np.arange(6.0)
    keys = {
        content_key("a", rows),
        content_key("b", rows),
        content_key("a", rows + 1.0e-9),
        content_key("a", rows.reshape(2, 3)),
    }
    assert len(keys) == 4 and content_key("a", rows.copy()) in keys


def test_structure_is_shared_between_support_laws(study_config):
    values = study_config.model_dump(mode="json")
    bare = build_structure(study_config)
    other = check_config(
        values | {"supports": [support | {"friction": 0.2} for support in values["supports"]]},
        "rubbing",
    )
    soft = check_config(
        values
        | {
            "structure": (
                values["structure"]
                | {
                    "root": {
                        "kind": "springs",
                        "translation_N_per_m": 1e6,
                        "rotation_N_m_per_rad": 1e3,
                    }
                }
            )
        },
        "soft",
    )
    assert build_structure(other).stiffness is bare.stiffness
    assert build_structure(soft).stiffness is not bare.stiffness
    assert (
        build_model(soft).omega[0]
        < 0.99 * build_model(other).omega[0]
        == 0.99 * build_model(study_config).omega[0]
    )
