//! Scenes to be held against the truth in.

use crate::VerifyError;
use manylight_scene::Scene;
use manylight_scene_io::{LoadOptions, parse};

/// A scene, and what is known of it.
pub struct Place {
    /// What it is called.
    pub name: String,
    /// The scene; small images will do.
    pub scene: Scene,
    /// Is the geometry term bounded, so that unbounded lights have a finite variance too?
    pub bounded_g: bool,
    /// Are biases that vanish looked at here?
    pub for_knobs: bool,
    /// Radiance of each channel in paths of at most so many edges, where it is the same in every pixel and known.
    pub exact: Option<fn(u32) -> [f64; 3]>,
}

impl Place {
    /// A scene of which nothing is known.
    pub fn new(name: &str, scene: Scene) -> Place {
        Place { name: name.into(), scene, bounded_g: false, for_knobs: true, exact: None }
    }
    /// The four of this crate: a furnace, a bubble, a room, fog.
    pub fn standard() -> Result<Vec<Place>, VerifyError> {
        let place = |name: &str, text: &str| -> Result<Place, VerifyError> {
            let file = format!("{name}.xml");
            let loaded = parse(text, file.as_ref(), "".as_ref(), &LoadOptions::default());
            Ok(Place::new(name, loaded.map_err(|e| VerifyError::Scene(e.to_string()))?.scene))
        };
        Ok(vec![
            Place {
                bounded_g: true,
                for_knobs: false,
                exact: Some(furnace),
                ..place("furnace", include_str!("../scenes/furnace.xml"))?
            },
            Place { bounded_g: true, ..place("bubble", include_str!("../scenes/bubble.xml"))? },
            place("room", include_str!("../scenes/room.xml"))?,
            Place { for_knobs: false, ..place("fog", include_str!("../scenes/fog.xml"))? },
        ])
    }
}

/// e (1 - a^k) / (1 - a).
fn furnace(edges: u32) -> [f64; 3] {
    [(0.3, 0.7f64), (0.5, 0.5), (0.7, 0.3)].map(|(e, a)| {
        let power = if edges == u32::MAX { 0.0 } else { a.powi(edges as i32) };
        e * (1.0 - power) / (1.0 - a)
    })
}
