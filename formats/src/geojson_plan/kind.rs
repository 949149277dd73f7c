//! What a feature of a plan stands for.

use geojson::{Feature, JsonValue};

/// The part of a floor plan that a feature draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Outline,
    /// The building's outline: bounds the floor where no outline of the floor itself is drawn.
    Footprint,
    Unit {
        walkable: bool,
    },
    Wall,
    Pathway,
    Other,
}

impl Kind {
    /// The kind by the most specific word that is known; a polygon that carries no word at all is a unit.
    pub(super) fn of(feature: &Feature) -> Self {
        let walkable = feature.property("walkable").and_then(JsonValue::as_bool);
        let words = words(feature);
        match words.iter().find_map(|word| Self::of_word(word)) {
            Some(Self::Unit { walkable: usual }) => Self::Unit { walkable: walkable.unwrap_or(usual) },
            Some(kind) => kind,
            None if words.is_empty() => Self::Unit { walkable: walkable.unwrap_or(false) },
            None => Self::Other,
        }
    }

    fn of_word(word: &str) -> Option<Self> {
        Some(match word.to_ascii_lowercase().as_str() {
            "outline" | "floor" | "level" => Self::Outline,
            "footprint" => Self::Footprint,
            "walkway" | "corridor" | "hallway" | "lobby" | "foyer" | "ramp" | "concourse" => {
                Self::Unit { walkable: true }
            }
            "unit" | "room" | "shop" | "office" | "kiosk" | "fixture" => Self::Unit { walkable: false },
            "wall" => Self::Wall,
            "pathway" => Self::Pathway,
            _ => return None,
        })
    }
}

/// The words that may name the kind, most specific first.
fn words(feature: &Feature) -> Vec<&str> {
    let properties = ["kind", "category", "feature_type", "type"].map(|key| feature.property(key));
    let member = feature.foreign_members.as_ref().and_then(|members| members.get("feature_type"));
    properties.into_iter().chain([member]).flatten().filter_map(JsonValue::as_str).collect()
}
