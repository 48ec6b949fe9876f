"""Read exported fragility curves with the readers of OpenQuake or pelicun, and print
what they hold.

python readers.py openquake FILE.xml LEVEL... prints P of each structure, limit state
and level, as JSON; python readers.py pelicun FILE.csv LEVEL... the same through
pelicun's random variables. It imports nothing of this package: each program may stand
in an environment of its own.
"""

import json
import sys


def openquake(path, levels):
    from openquake.hazardlib import nrml
    from openquake.risklib.read_nrml import update_validators

    update_validators()
    model = nrml.to_python(path)
    return {
        f"{name} {limit}": [float(x) for x in function(levels)]
        for (_, name), functions in model.items()
        for limit, function in zip(
            model.limitStates, functions.build(model.limitStates), strict=True
        )
    }


def pelicun(path, levels):
    import numpy as np
    from pelicun import file_io, uq
    from pelicun.assessment import Assessment
    from pelicun.model.damage_model import _is_for_ds_model

    data = file_io.load_data(
        path,
        None,
        orientation=1,
        reindex=False,
        log=Assessment({"PrintLog": False}).log,
    )
    assert _is_for_ds_model(data)
    with open(path[:-4] + ".json", encoding="utf-8") as file:
        model = json.load(file)
    found = {}
    for name, row in data.iterrows():
        for limit in model[name]["LimitStates"]:
            family, first, second = (
                row[limit, "Family"],
                row[limit, "Theta_0"],
                row[limit].get("Theta_1"),
            )
            if family == "multilinear_CDF":
                theta = np.column_stack(
                    [
                        np.array(part.split(","), dtype=float)
                        for part in first.split("|")
                    ]
                )
            else:
                theta = np.array([float(first), float(second)])
            variable = uq.rv_class_map(family)(
                name="x", theta=theta, truncation_limits=np.full(2, np.nan)
            )
            found[f"{name} {limit}"] = [
                float(x) for x in variable.cdf(np.array(levels))
            ]
    return found


if __name__ == "__main__":
    print(
        json.dumps(
            {"openquake": openquake, "pelicun": pelicun}[sys.argv[1]](
                sys.argv[2], [float(x) for x in sys.argv[3:]]
            )
        )
    )
