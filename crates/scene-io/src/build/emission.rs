//! Media that emit. Mitsuba 3 has none: these properties of a `<medium>` are an extension of ours.
//!
//! ```xml
//! <medium type="heterogeneous">  ..
//!   <volume name="emission" type="gridvolume"> .. </volume>      j by a grid [W/(m^3 sr)]
//!   <volume name="temperature" type="gridvolume"> .. </volume>   or a glowing gas: j = sigma_a B(T), T = offset + scale x grid [K]
//!   <float name="temperature_scale" value="1200"/> <float name="temperature_offset" value="300"/>
//!   <string name="ramp" value="0: 0 0 0; 0.5: 1 0.2 0; 1.5: 6 4 2"/>   or colours of j by the grid's values, instead of B
//!   <float name="emission_scale" value="1"/>                     multiplies j
//! </medium>
//! <medium type="homogeneous"> ..  <rgb name="emission" value="1, 0.5, 0.2"/>
//! ```

use super::Builder;
use super::texture::Range;
use crate::diagnostic::At;
use crate::query::Query;
use manylight_math::{Spectrum, Vec3};
use manylight_scene::{Glow, Grid, Medium, MediumError, Volume};

/// What a medium emits, as its file says.
pub(super) struct Fire {
    j: Option<Source>,
    scale: f32,
    at: At,
}

enum Source {
    Volume(Volume),
    Temperature { grid: Grid, scale: f64, offset: f64, ramp: Option<Ramp> },
}

/// Colours by value, ascending.
struct Ramp(Vec<(f32, Spectrum)>);

impl Ramp {
    /// `value: r g b; value: r g b; ..`
    fn parse(text: &str) -> Option<Ramp> {
        let stop = |part: &str| {
            let (value, colour) = part.split_once(':')?;
            let numbers: Vec<f32> = colour
                .split(|c: char| c == ',' || c.is_whitespace())
                .filter(|x| !x.is_empty())
                .map(|x| x.parse().ok())
                .collect::<Option<_>>()?;
            let [r, g, b] = numbers[..] else { return None };
            let (value, colour) = (value.trim().parse::<f32>().ok()?, Spectrum(Vec3::new(r, g, b)));
            (value.is_finite() && colour.is_valid()).then_some((value, colour))
        };
        let stops: Vec<_> = text.split(';').filter(|p| !p.trim().is_empty()).map(stop).collect::<Option<_>>()?;
        (!stops.is_empty() && stops.windows(2).all(|s| s[0].0 < s[1].0)).then_some(Ramp(stops))
    }
    /// Linear between stops, the same beyond them.
    fn at(&self, value: f32) -> Spectrum {
        let next = self.0.partition_point(|s| s.0 <= value);
        match (next.checked_sub(1).map(|i| self.0[i]), self.0.get(next)) {
            (Some((a, x)), Some(&(b, y))) => Spectrum::lerp(x, y, (value - a) / (b - a)),
            (Some((_, x)), None) | (None, Some(&(_, x))) => x,
            (None, None) => Spectrum::BLACK,
        }
    }
}

impl<'a> Builder<'a> {
    /// Reads what a medium emits. `None`: it is wrong, which is in the report.
    pub(super) fn fire(&mut self, q: &Query<'a>) -> Option<Fire> {
        let at = q.object.plugin_at;
        let mut fire = Fire { j: None, scale: 1.0, at };
        let of_temperature = ["temperature_scale", "temperature_offset", "ramp"];
        let (emission, temperature) = (q.has("emission"), q.has("temperature"));
        if emission && temperature {
            q.error("a medium emits by an `emission` or by a `temperature`: leave one out");
            q.ignore(&["emission", "temperature", "emission_scale"]);
            q.ignore(&of_temperature);
            return None;
        }
        if !temperature && let Some(name) = of_temperature.into_iter().find(|n| q.has(n)) {
            q.error(format!("`{name}` needs a `temperature`, a <volume> of type=\"gridvolume\""));
            q.ignore(&of_temperature);
            return None;
        }
        if !emission && !temperature {
            if q.has("emission_scale") {
                q.error("`emission_scale` needs an `emission` or a `temperature` to multiply");
                q.ignore(&["emission_scale"]);
                return None;
            }
            return Some(fire);
        }
        fire.scale = match q.float_at("emission_scale") {
            Some((x, at)) if x < 0.0 => {
                self.report.error(at, "`emission_scale` must not be negative");
                1.0
            }
            found => found.map_or(1.0, |(x, _)| x as f32),
        };
        if emission {
            fire.j = Some(Source::Volume(self.coefficient(q, "emission", 0.0, Range::Any)?));
            return Some(fire);
        }
        let (scale, offset) = (q.float("temperature_scale", 1.0), q.float("temperature_offset", 0.0));
        let ramp = q.text("ramp").map(|(text, at)| {
            let ramp = Ramp::parse(text);
            if ramp.is_none() {
                let like = "`ramp` must be colours by ascending values, such as `0: 0 0 0; 0.5: 1 0.2 0; 1.5: 6 4 2`";
                self.report.error(at, like);
            }
            ramp
        });
        match self.coefficient(q, "temperature", 0.0, Range::Any)? {
            Volume::Grid(grid) if grid.is_gray() => {
                fire.j = Some(Source::Temperature { grid, scale, offset, ramp: ramp.flatten() });
                Some(fire)
            }
            Volume::Grid(_) => {
                q.error("a `temperature` has one channel");
                None
            }
            Volume::Constant(_) => {
                q.error("a `temperature` is a <volume> of type=\"gridvolume\", of a `heterogeneous` medium");
                None
            }
        }
    }

    /// A medium that emits.
    pub(super) fn lit(&mut self, medium: Medium, fire: Fire) -> Option<Medium> {
        let made = match (medium, fire.j) {
            (medium, None) => Ok(medium),
            (Medium::Homogeneous(m), Some(Source::Volume(Volume::Constant(j)))) => {
                m.emitting(j * fire.scale).map(Medium::from)
            }
            (Medium::Heterogeneous(m), Some(Source::Volume(Volume::Grid(grid)))) => {
                Glow::new(grid, fire.scale).map(|g| Medium::from(m.emitting(g)))
            }
            (Medium::Heterogeneous(m), Some(Source::Temperature { grid, scale, offset, ramp })) => {
                let glow = match ramp {
                    Some(ramp) => grid.made(|_, v| ramp.at(v.mean())).and_then(|j| Glow::new(j, fire.scale)),
                    None => grid
                        .made(|_, v| Spectrum::gray((offset + scale * f64::from(v.mean())).max(0.0) as f32))
                        .and_then(|kelvins| Glow::glowing(&kelvins, |p| m.absorption(p), fire.scale)),
                };
                glow.map(|g| Medium::from(m.emitting(g)))
            }
            (Medium::Heterogeneous(_), Some(Source::Volume(Volume::Constant(_)))) => {
                self.report
                    .error(fire.at, "the `emission` of a `heterogeneous` medium is a <volume> of type=\"gridvolume\"");
                return None;
            }
            // A homogeneous medium's coefficients are no grids: said where they were read.
            (Medium::Homogeneous(_), Some(_)) => return None,
        };
        match made {
            Ok(m) => Some(m),
            Err(MediumError::Coefficients) => {
                self.report.error(fire.at, MediumError::Emission.to_string());
                None
            }
            Err(e) => {
                self.report.error(fire.at, e.to_string());
                None
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ramps_are_linear_between_their_stops() {
        let ramp = Ramp::parse("0.5: 0 0 0; 1: 1, 0.5, 0;").unwrap();
        for (value, red) in [(0.0, 0.0), (0.5, 0.0), (0.75, 0.5), (1.0, 1.0), (9.0, 1.0)] {
            assert!((ramp.at(value).0 - Vec3::new(red, 0.5 * red, 0.0)).length() < 1e-6, "{value}");
        }
        for wrong in
            ["", "1", "1: 2 3", "1: 2 3 x", "1: 0 0 0; 1: 1 1 1", "2: 0 0 0; 1: 1 1 1", "1: -1 0 0", "nan: 1 1 1"]
        {
            assert!(Ramp::parse(wrong).is_none(), "{wrong}");
        }
    }
}
