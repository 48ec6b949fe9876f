"""Error against run time of a scene, judged by the path that knows all of it."""

from rocking_cli import Method, cosine, load_structures, parse_grid, sine
from rocking_cli.motions.biaxial import with_vertical
from rocking_cli.reports.work_precision import work_precision
from rocking_cli.spectra.scene import PulseScene


def test_a_scene_whose_weight_varies_is_judged_by_a_path_that_knows_it():
    motion = with_vertical(sine(), cosine(), 0.4)
    scene = PulseScene(
        tuple(load_structures("configs/block.yaml")),
        parse_grid("a_g=0.3g:0.6g:6,f_g=1:2:4"),
        motion,
        Method(),
    )
    (line,) = work_precision(scene, sample=6, scipy=0)
    assert line["cells"] > 0
    assert line["misjudged"] == 0
    assert line["largest_difference"] < min(1e-9, line["error_bound"])
