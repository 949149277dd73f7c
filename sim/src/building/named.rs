//! The buildings that scenarios are named after.

use fieldwalk::geometry::Point2;

use crate::building::{Aisle, Building, GridBuilding, OpenBuilding, Rectangle};

fn aisles(list: &[(f64, f64)]) -> Vec<Aisle> {
    list.iter().map(|&(centre_m, width_m)| Aisle { centre_m, width_m }).collect()
}

impl Building {
    /// The office of 60 × 40 m: a ring of corridors 1.6 m wide, narrower ones of 0.7 to 1.2 m through it, rooms on
    /// both sides, one open hall.
    ///
    /// # Source
    /// Extent and corridor widths of the test bed of mass-centred 2019; the layout is ours (the paper's is a
    /// small picture).
    pub fn office() -> Self {
        GridBuilding::office().build()
    }

    /// An office of 60 × 40 m with nothing but narrow corridors: 1.6 m around, 0.7 m through.
    ///
    /// # Source
    /// Extent and the two widths of the test bed of mass-centred 2019; the layout is ours.
    pub fn corridors() -> Self {
        GridBuilding {
            name: "corridors".into(),
            columns: aisles(&[(6.0, 1.6), (22.0, 0.7), (38.0, 0.7), (54.0, 1.6)]),
            rows: aisles(&[(6.0, 1.6), (15.3, 0.7), (24.7, 0.7), (34.0, 1.6)]),
            halls: Vec::new(),
            ..GridBuilding::office()
        }
        .build()
    }

    /// An open hall of 60 × 30 m with columns along its long sides.
    ///
    /// # Source
    /// The area, 1800 m², of the hall of iBILL 2017; the shape is ours: long enough for clusters 50 m apart.
    pub fn hall() -> Self {
        let column = |k: u32| {
            let x_m = 3.75 + 7.5 * f64::from(k % 8);
            Point2::new(x_m, if k < 8 { 0.4 } else { 29.6 })
        };
        OpenBuilding {
            name: "hall".into(),
            width_m: 60.0,
            height_m: 30.0,
            rooms: vec![Rectangle::new(0.0, 0.0, 60.0, 30.0)],
            doors: Vec::new(),
            door_width_m: 1.8,
            lane_m: 6.0,
            is_crossed_askew: true,
            columns: (0..16).map(column).collect(),
            ceiling_m: 6.0,
        }
        .build()
    }

    /// An office of 20.5 × 16 m: one large room and two smaller ones.
    ///
    /// # Source
    /// Extent and number of rooms of the test bed of Kwak 2018; where its walls stand is ours.
    pub fn card_office() -> Self {
        let column =
            |k: u32| Point2::new([0.2, 7.0, 13.7, 20.3][k as usize % 4], [0.2, 15.8][k as usize / 4]);
        OpenBuilding {
            name: "card-office".into(),
            width_m: 20.5,
            height_m: 16.0,
            rooms: vec![
                Rectangle::new(0.0, 0.0, 12.5, 16.0),
                Rectangle::new(12.5, 0.0, 20.5, 8.5),
                Rectangle::new(12.5, 8.5, 20.5, 16.0),
            ],
            doors: vec![
                (Point2::new(12.5, 4.5), false),
                (Point2::new(12.5, 12.0), false),
                (Point2::new(17.0, 8.5), true),
            ],
            door_width_m: 0.95,
            lane_m: 3.2,
            is_crossed_askew: false,
            columns: (0..8).map(column).collect(),
            ceiling_m: 2.7,
        }
        .build()
    }

    /// A ring of corridors 1.8 m wide about a block of rooms, 67 × 12 m.
    ///
    /// # Source
    /// The extent of the ring of Song 2014; its width and the rooms inside are ours.
    pub fn ring() -> Self {
        GridBuilding {
            name: "ring".into(),
            width_m: 67.0,
            height_m: 12.0,
            columns: aisles(&[(0.9, 1.8), (66.1, 1.8)]),
            rows: aisles(&[(0.9, 1.8), (11.1, 1.8)]),
            halls: Vec::new(),
            has_outer_rooms: false,
            ..GridBuilding::office()
        }
        .build()
    }

    /// A shopping mall of 120 × 80 m: ways 8 to 12 m wide between shops, high ceilings, columns far apart.
    ///
    /// # Source
    /// Ours, after the plans of the malls of indoor-location-competition-20.
    pub fn mall() -> Self {
        GridBuilding {
            name: "mall".into(),
            width_m: 120.0,
            height_m: 80.0,
            columns: aisles(&[(14.0, 8.0), (60.0, 10.0), (106.0, 8.0)]),
            rows: aisles(&[(14.0, 8.0), (40.0, 12.0), (66.0, 8.0)]),
            room_width_m: 9.0,
            door_width_m: 3.0,
            span_m: 8.4,
            ceiling_m: 4.5,
            halls: Vec::new(),
            lifts: vec![[0, 0], [1, 0], [0, 1], [1, 1]],
            stairs: None,
            has_outer_rooms: true,
        }
        .build()
    }

    /// A storey of 40 × 24 m: a ring of corridors, rooms on both sides, stairs to the next storey.
    pub fn storey_with_stairs() -> Self {
        GridBuilding {
            name: "two-floors".into(),
            width_m: 40.0,
            height_m: 24.0,
            columns: aisles(&[(5.0, 1.6), (35.0, 1.6)]),
            rows: aisles(&[(5.0, 1.6), (19.0, 1.6)]),
            halls: Vec::new(),
            lifts: Vec::new(),
            stairs: Some([0, 0]),
            ..GridBuilding::office()
        }
        .build()
    }
}

impl GridBuilding {
    /// The description of [`Building::office`].
    pub fn office() -> Self {
        Self {
            name: "office".into(),
            width_m: 60.0,
            height_m: 40.0,
            columns: aisles(&[(6.0, 1.6), (30.0, 1.2), (54.0, 1.6)]),
            rows: aisles(&[(6.0, 1.6), (15.0, 0.9), (25.0, 0.7), (34.0, 1.6)]),
            room_width_m: 4.5,
            door_width_m: 0.9,
            span_m: 7.5,
            ceiling_m: 2.9,
            halls: vec![[1, 1]],
            lifts: vec![[0, 0]],
            stairs: None,
            has_outer_rooms: true,
        }
    }
}
