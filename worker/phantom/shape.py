"""The numbers that shape a phantom heart, and the bounds within which it is one."""

from dataclasses import dataclass, fields

from worker.phantom.bounds import require_within

_BOUNDS: dict[str, tuple[float, float]] = {
    "lv_radius_mm": (10.0, 40.0),
    "lv_apex_depth_mm": (30.0, 90.0),
    "base_height_mm": (0.0, 30.0),
    "wall_mm": (4.0, 20.0),
    "apex_wall_ratio": (0.4, 1.5),
    "rv_reach_mm": (12.0, 45.0),
    "rv_breadth_ratio": (0.9, 1.3),
    "rv_depth_ratio": (0.6, 0.9),
    "rv_gap_mm": (0.3, 5.0),
    "rv_edge_radius_mm": (1.0, 8.0),
    "radial_shortening": (0.0, 0.40),
    "longitudinal_shortening": (0.0, 0.30),
    "rv_shortening": (0.0, 0.50),
}


@dataclass(frozen=True)
class HeartShape:
    """Lengths at end-diastole, in mm, and how much of them is lost by end-systole.

    lv_radius_mm: short semi-axis of the LV cavity's ellipsoid.
    lv_apex_depth_mm: long semi-axis, from the widest level down to the apex.
    base_height_mm: how far above the widest level the flat base cuts the heart.
    wall_mm: LV wall thickness at the widest level; apex_wall_ratio: at the apex, relative to it.
    rv_reach_mm: RV cavity width from the septum to the free wall.
    rv_breadth_ratio: RV semi-axis along the septum, relative to the LV's outer radius.
    rv_depth_ratio: RV semi-axis towards the apex, relative to the LV's outer one.
    rv_gap_mm: tissue kept between LV epicardium and RV cavity.
    rv_edge_radius_mm: rounding where septum and free wall meet.
    radial_shortening, longitudinal_shortening: fraction of the LV cavity's radius and of its
        base-to-apex length lost by end-systole. rv_shortening: fraction of rv_reach_mm.
    """

    lv_radius_mm: float = 24.5
    lv_apex_depth_mm: float = 62.0
    base_height_mm: float = 22.0
    wall_mm: float = 9.0
    apex_wall_ratio: float = 0.7
    rv_reach_mm: float = 27.0
    rv_breadth_ratio: float = 1.12
    rv_depth_ratio: float = 0.85
    rv_gap_mm: float = 1.0
    rv_edge_radius_mm: float = 3.0
    radial_shortening: float = 0.29
    longitudinal_shortening: float = 0.15
    rv_shortening: float = 0.44

    def __post_init__(self) -> None:
        for item in fields(self):
            value = getattr(self, item.name)
            low, high = _BOUNDS[item.name]
            require_within(item.name, value, low, high)
        # A wider reach would take the RV's ellipsoid round the LV and out on its other side; a
        # higher base would leave next to no opening.
        widest = 1.1 * (self.lv_radius_mm + self.wall_mm)
        require_within("rv_reach_mm", self.rv_reach_mm, _BOUNDS["rv_reach_mm"][0], widest)
        require_within("base_height_mm", self.base_height_mm, 0.0, 0.8 * self.lv_apex_depth_mm)
