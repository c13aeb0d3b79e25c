//! Pixel filters, by importance sampling: each sample counts for its own pixel only, at a place drawn from the filter.
//!
//! The pixel is E[weight * L(centre + offset)], weight = sign(f) int|f| / int f (Ernst, Stamminger and Greiner 2006). Passes
//! of any pixel stay independent of its neighbours, and the estimate is unbiased (Mitsuba's is a ratio of two sums).

use manylight_math::Vec2;
use manylight_sampling::{Cdf, warp};

/// A pixel filter; separable. Widths in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Filter {
    /// The mean over the pixel.
    Box,
    /// Falls linearly to zero at `radius`.
    Tent {
        /// Half width.
        radius: f32,
    },
    /// exp(-x^2 / (2 stddev^2)), lowered to reach zero at four standard deviations.
    Gaussian {
        /// Standard deviation.
        stddev: f32,
    },
    /// Mitchell and Netravali 1988; half width 2.
    Mitchell {
        /// Blur.
        b: f32,
        /// Ringing.
        c: f32,
    },
    /// Mitchell with b = 0, c = 1/2.
    CatmullRom,
    /// Sinc in a sinc window of `lobes` pixels.
    Lanczos {
        /// Half width.
        lobes: f32,
    },
}

impl Filter {
    /// Half width. \[pixel\]
    pub fn radius(&self) -> f32 {
        match *self {
            Filter::Box => 0.5,
            Filter::Tent { radius } => radius,
            Filter::Gaussian { stddev } => 4.0 * stddev,
            Filter::Mitchell { .. } | Filter::CatmullRom => 2.0,
            Filter::Lanczos { lobes } => lobes,
        }
    }
    /// Value at a distance along one axis, not normalised.
    pub fn eval(&self, x: f32) -> f32 {
        let x = x.abs();
        if x > self.radius() {
            return 0.0;
        }
        match *self {
            Filter::Box => 1.0,
            Filter::Tent { radius } => 1.0 - x / radius,
            Filter::Gaussian { stddev } => {
                let g = |x: f32| (-x * x / (2.0 * stddev * stddev)).exp();
                (g(x) - g(4.0 * stddev)).max(0.0)
            }
            Filter::Mitchell { b, c } => mitchell(x, b, c),
            Filter::CatmullRom => mitchell(x, 0.0, 0.5),
            Filter::Lanczos { lobes } => sinc(x) * sinc(x / lobes),
        }
    }
}

fn mitchell(x: f32, b: f32, c: f32) -> f32 {
    let (x2, x3) = (x * x, x * x * x);
    (if x < 1.0 {
        (12.0 - 9.0 * b - 6.0 * c) * x3 + (-18.0 + 12.0 * b + 6.0 * c) * x2 + (6.0 - 2.0 * b)
    } else {
        (-b - 6.0 * c) * x3 + (6.0 * b + 30.0 * c) * x2 + (-12.0 * b - 48.0 * c) * x + (8.0 * b + 24.0 * c)
    }) / 6.0
}
fn sinc(x: f32) -> f32 {
    let t = std::f32::consts::PI * x;
    if t < 1e-4 { 1.0 } else { t.sin() / t }
}

/// Draws offsets from a filter.
#[derive(Clone, Debug)]
pub struct FilterSampler {
    filter: Filter,
    /// |f| on cells of a line, for the filters without a closed-form inverse.
    cells: Option<Cells>,
}

#[derive(Clone, Debug)]
struct Cells {
    cdf: Cdf,
    values: Vec<f32>,
    /// int |f| / int f along one axis.
    scale: f32,
}
const CELLS: usize = 1024;

impl FilterSampler {
    /// Tabulates a filter.
    pub fn new(filter: Filter) -> Self {
        if matches!(filter, Filter::Box | Filter::Tent { .. }) {
            return FilterSampler { filter, cells: None };
        }
        let r = filter.radius();
        let values: Vec<f32> =
            (0..CELLS).map(|i| filter.eval(((i as f32 + 0.5) / CELLS as f32 * 2.0 - 1.0) * r)).collect();
        let (sum, magnitude) = values.iter().fold((0.0f64, 0.0f64), |(s, m), &v| (s + v as f64, m + v.abs() as f64));
        let cells = Cdf::new(values.iter().map(|v| v.abs() as f64)).map(|cdf| Cells {
            cdf,
            values,
            scale: (magnitude / sum) as f32,
        });
        FilterSampler { filter, cells }
    }
    /// The filter.
    pub fn filter(&self) -> Filter {
        self.filter
    }
    /// An offset from the pixel's centre \[pixel\] and the weight of a sample there.
    pub fn sample(&self, u: Vec2) -> (Vec2, f32) {
        match (&self.cells, self.filter) {
            (Some(cells), _) => {
                let (x, a) = self.axis(cells, u.x);
                let (y, b) = self.axis(cells, u.y);
                (Vec2::new(x, y), a * b)
            }
            (None, Filter::Tent { radius }) => (Vec2::new(warp::tent(u.x), warp::tent(u.y)) * radius, 1.0),
            (None, _) => (u - 0.5, 1.0),
        }
    }
    fn axis(&self, cells: &Cells, u: f32) -> (f32, f32) {
        let (i, rest) = cells.cdf.sample(u as f64);
        let x = ((i as f64 + rest) / CELLS as f64 * 2.0 - 1.0) as f32 * self.filter.radius();
        (x, cells.values[i].signum() * cells.scale)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use manylight_sampling::{Purpose, Stream};

    const ALL: [Filter; 6] = [
        Filter::Box,
        Filter::Tent { radius: 1.0 },
        Filter::Gaussian { stddev: 0.5 },
        Filter::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 },
        Filter::CatmullRom,
        Filter::Lanczos { lobes: 3.0 },
    ];

    #[test]
    fn moments_of_the_samples_are_those_of_the_filter() {
        for filter in ALL {
            let sampler = FilterSampler::new(filter);
            let mut s = Stream::new(4, [0; 3], Purpose::TEST);
            let n = 400_000;
            let (mut mass, mut second, mut square) = (0.0f64, 0.0f64, 0.0f64);
            for _ in 0..n {
                let (p, w) = sampler.sample(s.next_2d());
                mass += w as f64;
                second += (w * p.x * p.x) as f64;
                square += ((w * p.x * p.x) as f64).powi(2);
            }
            let (mass, second, square) = (mass / n as f64, second / n as f64, square / n as f64);
            let steps = 20_000;
            let r = filter.radius();
            let (mut m0, mut m2) = (0.0f64, 0.0f64);
            for i in 0..steps {
                let x = ((i as f32 + 0.5) / steps as f32 * 2.0 - 1.0) * r;
                m0 += filter.eval(x) as f64;
                m2 += (filter.eval(x) * x * x) as f64;
            }
            let sigma = ((square - second * second) / n as f64).sqrt();
            // 12 comparisons at a family-wise 0.01: 3.35 standard errors.
            assert!((second - m2 / m0).abs() < 3.4 * sigma + 1e-4, "{filter:?}: {second} against {}", m2 / m0);
            assert!((mass - 1.0).abs() < 0.01, "{filter:?}: mass {mass}");
        }
    }
}
