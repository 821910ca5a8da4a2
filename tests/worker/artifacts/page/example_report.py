"""Reports made by hand, with a number of their own in every place."""

from schemas.frame_report import (
    FrameReport,
    LeftVentricleReport,
    LevelReport,
    LossCurves,
    SegmentReport,
    SliceReport,
)
from schemas.measures import DistanceSummary, Histogram
from schemas.options import Options
from schemas.reference_report import (
    CurvatureDeviationReport,
    CurvatureReport,
    PlacementReport,
    PlanesReport,
    PointSetReport,
    ReferenceReport,
)
from schemas.report import Concern, FunctionReport, Provenance, Report
from schemas.surface_report import (
    EndReport,
    QualityReport,
    SimulationReport,
    SurfaceReport,
    ViewResiduals,
)
from schemas.vocabulary import Axes, Structure, View


def distances(mean: float = 0.25, *, p95: float = 0.5, largest: float = 1.75) -> DistanceSummary:
    return DistanceSummary(
        mean=mean, rms=1.2 * mean, p50=0.8 * mean, p90=0.9 * p95, p95=p95, max=largest, count=100
    )


EVEN = QualityReport(
    min_angle_deg=31.25,
    min_angle_p5_deg=40.0,
    min_angle_mean_deg=50.0,
    below_20_deg_percent=0.0,
    aspect_ratio_mean=1.06,
    aspect_ratio_p95=1.2,
    aspect_ratio_max=1.9,
    edge_mean_mm=1.95,
    edge_p5_mm=1.5,
    edge_p95_mm=2.5,
)
UNEVEN = EVEN.model_copy(update={"below_20_deg_percent": 27.5, "aspect_ratio_max": None})


def surface_report(**changes: object) -> SurfaceReport:
    spread = Histogram(bin_width_mm=0.1, counts=[40, 30, 15, 6, 4, 2] + [0] * 44, beyond=3)
    return SurfaceReport(
        volume_ml=123.4,
        area_cm2=56.7,
        watertight=True,
        vertices=10,
        faces=16,
        euler_number=2,
        components=1,
        manifold=True,
        self_intersecting_triangles=0,
        crossing_triangles={},
        simulation=SimulationReport(fit=False, reasons=["27.5 % are <slivers>."]),
        contour_residual_mm=distances(),
        contour_residual_by_view={
            "short_axis": ViewResiduals(summary_mm=distances(), histogram=spread),
            "long_axis": ViewResiduals(summary_mm=distances(0.37), histogram=spread),
        },
        contour_residual_by_region_mm={"apex": distances(0.81)},
        held_out_mm=None,
        held_out_by_view_mm={},
        deviation_mm=None,
        reference=None,
        quality=UNEVEN,
        quality_before_remeshing=None,
        remeshing_distance_mm=None,
        support_mm=distances(2.5, p95=6.25, largest=9.35),
        slice_gap_mm=8.0,
        beyond_slice_gap_percent=3.75,
        apex=EndReport(height_mm=4.15, support_max_mm=9.35, on_long_axis=False),
        base=None,
        files=["ED_lv_endo.stl"],
    ).model_copy(update=changes)


def slice_report(slice_id: str, view: View = View.SAX, **changes: object) -> SliceReport:
    return SliceReport(
        id=slice_id,
        view=view,
        shift_mm=(3.0, 4.0, 0.0),
        shift_deviation_mm=0.37,
        crossings=6,
        rotation_deg=0.0,
        contour_residual_mm={Structure.LV_ENDO: distances()},
        held_out_mm={},
        dice={Structure.LV_ENDO: 0.987},
    ).model_copy(update=changes)


def level_report(index: int, total: float) -> LevelReport:
    curve = [total * (2.0 - step / 10.0) for step in range(20)]
    return LevelReport(
        level=index,
        radius_mm=4.0,
        samples=9,
        bce=total,
        hinge=0.0,
        total=total,
        iterations=LossCurves(bce=curve, hinge=[0.0] * 10 + [3.0] * 10, total=curve),
    )


def left_ventricle_report(segments: int = 17) -> LeftVentricleReport:
    return LeftVentricleReport(
        long_axis_length_mm=91.5,
        sphericity=0.42,
        mid_area_cm2=15.0,
        wall_mass_g=None,
        wall_thickness_mm={
            n: SegmentReport(name=f"segment {n}", mean_mm=8.0 + n / 8, min_mm=7.0, max_mm=12.5)
            for n in range(1, segments + 1)
        }
        or None,
        not_measured={"wall_mass_g": "There is no lv_epi."},
    )


def frame_report(label: str = "ED", **changes: object) -> FrameReport:
    return FrameReport(
        label=label,
        time_ms=None,
        contour_noise_mm=0.456,
        surfaces={Structure.LV_ENDO: surface_report()},
        left_ventricle=left_ventricle_report(),
        slices=[slice_report("sax-00")],
        levels=[level_report(0, 0.5), level_report(1, 0.05)],
    ).model_copy(update=changes)


def reference_report(**changes: object) -> ReferenceReport:
    bend = CurvatureDeviationReport(
        mean_abs=0.0123,
        rms=0.02,
        p75_abs=0.018,
        p90_abs=0.03,
        reference_rms=0.05,
        above_p75_area_percent=24.6,
        mean_abs_by_region={"apex": 0.034, "free_wall": 0.011},
    )
    return ReferenceReport(
        volume_ml=120.0,
        volume_difference_percent=2.83,
        mean_mm=0.66,
        rms_mm=0.88,
        hausdorff95_mm=1.77,
        hausdorff_mm=4.44,
        to_reference_mm=distances(0.61),
        from_reference_mm=distances(0.71),
        by_region_mm={"septum": distances(0.59)},
        above_p90_area_percent=9.8,
        by_view={
            "short_axis": PlanesReport(
                planes=9, distance_mm=distances(0.53), dice_mean=0.961, dice_min=0.894
            )
        },
        point_set=PointSetReport(
            points=20000,
            chamfer_mm2=1.31,
            rms_chamfer_mm=0.81,
            hausdorff_mm=4.5,
            hausdorff50_mm=0.6,
            hausdorff90_mm=1.4,
            hausdorff95_mm=1.8,
            rmse_mm=0.9,
            mae_mm=0.7,
            optimal_threshold_mm=1.35,
        ),
        curvature=CurvatureReport(
            edge_mm=2.0, gaussian_per_mm2=bend, mean_per_mm=bend, gauss_bonnet_residual_rad=1e-12
        ),
        placement=PlacementReport(rotation_deg=1.5, translation_mm=(0.1, -0.2, 2.25)),
        not_measured={},
    ).model_copy(update=changes)


def report(*frames: FrameReport, **changes: object) -> Report:
    return Report(
        subject_id="case-01",
        axes=Axes.LPS,
        frames=list(frames) or [frame_report()],
        function=FunctionReport(
            lv_edv_ml=120.0,
            lv_esv_ml=48.0,
            lv_stroke_volume_ml=72.0,
            lv_ejection_fraction_percent=60.0,
        ),
        warnings=[],
        concerns=[
            Concern(severity="grave", text="ED lv_endo: the surface is not closed."),
            Concern(severity="notable", text="only 3 slices <script>alert('x')</script><!--"),
        ],
        timings_s={"fitting": 8.25},
        options=Options(),
        provenance=Provenance(
            software="neuralmri 0.1.0",
            python="3.11",
            libraries={"numpy": "2.4.6"},
            seed=0,
            threads=1,
            input_sha256="0" * 64,
        ),
    ).model_copy(update=changes)
