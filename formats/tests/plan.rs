//! Floor plans, worked by hand.

use fieldwalk::floor_plan::{FloorPlan, Georeference, Polygon, Unit};
use fieldwalk::geometry::{Point2, Segment};
use fieldwalk_formats::geojson_plan::{read_ilc_plan, read_plan, write_plan};
use proptest::prelude::*;

const ILC_INFO: &[u8] = include_bytes!("fixtures/floor_info.json");
const ILC_MAP: &[u8] = include_bytes!("fixtures/geojson_map.json");

fn points(coordinates: &[(f64, f64)]) -> Vec<Point2> {
    coordinates.iter().map(|&(x, y)| Point2::new(x, y)).collect()
}

/// A plan with one outline and further features, as JSON.
fn collection(member: &str, outline: &str, features: &str) -> String {
    format!(
        r#"{{"type": "FeatureCollection"{member}, "features": [
            {{"type": "Feature", "properties": {{"kind": "outline"}},
              "geometry": {{"type": "Polygon", "coordinates": [{outline}]}}}}
            {features}
        ]}}"#
    )
}

const SQUARE: &str = "[[0, 0], [20, 0], [20, 10], [0, 10], [0, 0]]";

#[test]
fn the_collections_plan_spans_its_extent() {
    // 1 degree is 80 m along x and 50 m along y.
    let plan = read_ilc_plan(ILC_INFO, ILC_MAP).unwrap();
    assert_eq!((plan.width_m, plan.height_m), (80.0, 50.0));
    assert_eq!(plan.outline.len(), 1);
    assert_eq!(plan.outline[0].rings, [points(&[(0.0, 0.0), (80.0, 0.0), (80.0, 50.0), (0.0, 50.0)])]);
    assert_eq!(
        plan.units,
        [Unit {
            name: "Shop".into(),
            walkable: false,
            polygon: Polygon { rings: vec![points(&[(20.0, 25.0), (40.0, 25.0), (40.0, 37.5)])] },
        }]
    );
    let georeference = plan.georeference.unwrap();
    assert_eq!(georeference.latitude_longitude_deg(Point2::new(20.0, 25.0)), (50.5, 10.25));
}

#[test]
fn a_plan_in_metres_is_taken_as_it_is() {
    let features = r#",
        {"type": "Feature", "properties": {"category": "corridor", "name": {"de": "Gang"}},
         "geometry": {"type": "Polygon", "coordinates": [[[1, 1], [5, 1], [5, 2], [1, 1]]]}},
        {"type": "Feature", "properties": {"category": "elevator"}, "feature_type": "unit",
         "geometry": {"type": "Polygon", "coordinates": [[[6, 1], [7, 1], [7, 2], [6, 1]]]}},
        {"type": "Feature", "properties": {"category": "fountain"},
         "geometry": {"type": "Polygon", "coordinates": [[[6, 1], [7, 1], [7, 2], [6, 1]]]}},
        {"type": "Feature", "properties": {"kind": "wall"},
         "geometry": {"type": "LineString", "coordinates": [[0, 5], [4, 5], [4, 9]]}},
        {"type": "Feature", "properties": {"kind": "pathway"},
         "geometry": {"type": "MultiLineString", "coordinates": [[[1, 1], [2, 2]], [[3, 3], [4, 4]]]}},
        {"type": "Feature", "properties": null, "geometry": null}"#;
    let text = collection(r#", "fieldwalk": {"frame": "metres"}"#, SQUARE, features);
    let plan = read_plan(text.as_bytes()).unwrap();
    assert_eq!((plan.width_m, plan.height_m, plan.georeference), (20.0, 10.0, None));
    let units: Vec<_> = plan.units.iter().map(|unit| (unit.name.as_str(), unit.walkable)).collect();
    assert_eq!(units, [("Gang", true), ("", false)]);
    assert_eq!(plan.walls.len(), 2);
    assert_eq!(plan.walls[1], Segment { a: Point2::new(4.0, 5.0), b: Point2::new(4.0, 9.0) });
    assert_eq!(plan.pathways, [points(&[(1.0, 1.0), (2.0, 2.0)]), points(&[(3.0, 3.0), (4.0, 4.0)])]);
}

#[test]
fn degrees_span_the_given_extent() {
    let text = collection(r#", "fieldwalk": {"width_m": 40, "height_m": 30}"#, SQUARE, "");
    let plan = read_plan(text.as_bytes()).unwrap();
    assert_eq!(plan.outline[0].rings[0][2], Point2::new(40.0, 30.0));
    let expected = Georeference {
        origin_latitude_deg: 0.0,
        origin_longitude_deg: 0.0,
        latitude_deg_per_m: 10.0 / 30.0,
        longitude_deg_per_m: 0.5,
    };
    assert_eq!(plan.georeference, Some(expected));
}

#[test]
fn degrees_alone_are_projected_on_the_ellipsoid() {
    // A degree at latitude 60: 55.80 km along the parallel, 111.41 km along the meridian.
    let outline = "[[20, 59.9995], [20.001, 59.9995], [20.001, 60.0005], [20, 60.0005], [20, 59.9995]]";
    let plan = read_plan(collection("", outline, "").as_bytes()).unwrap();
    assert!((plan.width_m - 55.800).abs() < 0.001, "{}", plan.width_m);
    assert!((plan.height_m - 111.412).abs() < 0.001, "{}", plan.height_m);
}

#[test]
fn a_footprint_bounds_a_floor_that_has_no_outline_of_its_own() {
    let feature = |kind: &str, size: u32| {
        format!(
            r#"{{"type": "Feature", "feature_type": "{kind}", "properties": {{"category": "unspecified"}},
               "geometry": {{"type": "Polygon", "coordinates": [[[0,0],[{size},0],[{size},{size}],[0,0]]]}}}}"#
        )
    };
    let plan_of = |features: &[String]| {
        let features = features.join(",");
        let text = format!(
            r#"{{"type": "FeatureCollection", "fieldwalk": {{"frame": "metres"}}, "features": [{features}]}}"#
        );
        read_plan(text.as_bytes()).unwrap()
    };
    assert_eq!(plan_of(&[feature("footprint", 9)]).width_m, 9.0);
    let both = plan_of(&[feature("footprint", 9), feature("level", 7)]);
    assert_eq!((both.width_m, both.outline.len()), (7.0, 1));
}

#[test]
fn unfit_plans_are_refused_with_a_remedy() {
    let flat = "[[0, 0], [20, 0], [0, 0]]";
    let metres = r#", "fieldwalk": {"frame": "metres"}"#;
    let cases = [
        ("".to_owned(), "not GeoJSON"),
        ("{".to_owned(), "not GeoJSON"),
        (r#"{"type": "Point", "coordinates": [1, 2]}"#.to_owned(), "collection"),
        (r#"{"type": "FeatureCollection", "features": []}"#.to_owned(), "no outline"),
        (
            r#"{"type": "FeatureCollection", "fieldwalk": {"frame": "metres", "width_m": 9, "height_m": 9},
            "features": [{"type": "Feature", "properties": {"kind": "outline"},
            "geometry": {"type": "Polygon", "coordinates": [[[0, 0]]]}}]}"#
                .to_owned(),
            "no outline",
        ),
        (collection("", flat, ""), "extent"),
        (collection(metres, flat, ""), "extent"),
        (collection("", "[[0, 0], [400, 0], [400, 100], [0, 0]]", ""), "out of range"),
        (collection(r#", "fieldwalk": {"frame": "feet"}"#, SQUARE, ""), "fieldwalk"),
        (
            collection(metres, "[[-10, -5], [10, -5], [10, 5], [-10, 5], [-10, -5]]", ""),
            "outside the floor frame",
        ),
        (
            collection(r#", "fieldwalk": {"frame": "metres", "width_m": 20, "height_m": 6}"#, SQUARE, ""),
            "over the stated",
        ),
        (collection(r#", "fieldwalk": {"width_m": -1, "height_m": 2}"#, SQUARE, ""), "extent"),
    ];
    for (text, message) in cases {
        let error = read_plan(text.as_bytes()).unwrap_err();
        assert!(error.message().contains(message) && !error.remedy().is_empty(), "{error}");
    }
    assert!(read_ilc_plan(b"{}", ILC_MAP).is_err());
    assert!(read_ilc_plan(ILC_INFO, br#"{"type": "FeatureCollection", "features": []}"#).is_err());
}

fn point() -> impl Strategy<Value = Point2> {
    (-1e3..1e3, -1e3..1e3).prop_map(|(x, y)| Point2::new(x, y))
}

fn polygon(point: impl Strategy<Value = Point2>) -> impl Strategy<Value = Polygon> {
    let ring = proptest::collection::vec(point, 3..7);
    proptest::collection::vec(ring, 1..3).prop_map(|rings| Polygon { rings })
}

fn plan() -> impl Strategy<Value = FloorPlan> {
    let unit = (".{0,8}", any::<bool>(), polygon(point())).prop_map(|(name, walkable, polygon)| Unit {
        name,
        walkable,
        polygon,
    });
    let georeference =
        (-90.0..90.0, -180.0..180.0, 1e-6..1e-4, 1e-6..1e-4).prop_map(|(lat, lon, lat_per_m, lon_per_m)| {
            Georeference {
                origin_latitude_deg: lat,
                origin_longitude_deg: lon,
                latitude_deg_per_m: lat_per_m,
                longitude_deg_per_m: lon_per_m,
            }
        });
    (
        // No outline stands out of its floor.
        (1e3..2e3, 1e3..2e3),
        proptest::collection::vec(polygon((0.0..1e3, 0.0..1e3).prop_map(|(x, y)| Point2::new(x, y))), 1..3),
        proptest::collection::vec(unit, 0..3),
        proptest::collection::vec((point(), point()).prop_map(|(a, b)| Segment { a, b }), 0..3),
        proptest::collection::vec(proptest::collection::vec(point(), 2..5), 0..3),
        proptest::option::of(georeference),
    )
        .prop_map(|((width_m, height_m), outline, units, walls, pathways, georeference)| FloorPlan {
            width_m,
            height_m,
            outline,
            units,
            walls,
            pathways,
            georeference,
        })
}

proptest! {
    #[test]
    fn a_plan_survives_being_written(plan in plan()) {
        prop_assert_eq!(read_plan(write_plan(&plan).as_bytes()).unwrap(), plan);
    }

    #[test]
    fn damaged_plans_are_read_without_panic(plan in plan(), at: prop::sample::Index, byte: u8) {
        let mut bytes = write_plan(&plan).into_bytes();
        let at = at.index(bytes.len());
        bytes[at] = byte;
        let _ = read_plan(&bytes);
        let _ = read_plan(&bytes[..at]);
        let _ = read_ilc_plan(ILC_INFO, &bytes);
        let _ = read_ilc_plan(&bytes, ILC_MAP);
    }
}
