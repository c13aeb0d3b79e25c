//! Sampling of the unit square by a piecewise-constant table.

use crate::Cdf;
use manylight_math::Vec2;

/// A piecewise-constant density over the unit square, row by row: what environment maps are sampled by.
#[derive(Clone, Debug)]
pub struct Table2d {
    rows: Cdf,
    columns: Vec<Option<Cdf>>,
    width: usize,
    height: usize,
}

impl Table2d {
    /// `weights` are `width * height` values, row 0 first; row r covers y in [r, r + 1) / height. `None` if they do not
    /// fit the size, any is negative or NaN, or their sum is not positive and finite.
    pub fn new(width: usize, height: usize, weights: &[f64]) -> Option<Self> {
        if width == 0 || weights.len() != width * height || weights.iter().any(|w| !(*w >= 0.0)) {
            return None;
        }
        let columns: Vec<_> = weights.chunks(width).map(|row| Cdf::new(row.iter().copied())).collect();
        let rows = Cdf::new(columns.iter().map(|c| c.as_ref().map_or(0.0, Cdf::total)))?;
        Some(Table2d { rows, columns, width, height })
    }
    /// A point of the square and its density per unit area of the square.
    pub fn sample(&self, u: [f64; 2]) -> (Vec2, f32) {
        let (r, y) = self.rows.sample(u[0]);
        // A row without weight is never picked.
        let Some(column) = &self.columns[r] else { return (Vec2::ZERO, 0.0) };
        let (c, x) = column.sample(u[1]);
        let p = Vec2::new(((c as f64 + x) / self.width as f64) as f32, ((r as f64 + y) / self.height as f64) as f32);
        (p.min(Vec2::splat(1.0 - f32::EPSILON / 2.0)), self.density(r, c))
    }
    /// Density at a point of [0, 1)^2.
    pub fn pdf(&self, p: Vec2) -> f32 {
        let at = |x: f32, n: usize| ((x * n as f32) as usize).min(n - 1);
        self.density(at(p.y, self.height), at(p.x, self.width))
    }
    fn density(&self, r: usize, c: usize) -> f32 {
        let cells = (self.width * self.height) as f64;
        self.columns[r].as_ref().map_or(0.0, |column| (self.rows.pmf(r) * column.pmf(c) * cells) as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Purpose, Stream};
    use manylight_stats as stats;

    #[test]
    fn samples_follow_the_table_and_the_density_agrees() {
        let weights = [1.0, 0.0, 3.0, 2.0, 0.0, 0.0, 0.0, 0.0, 4.0, 4.0, 1.0, 1.0];
        let table = Table2d::new(4, 3, &weights).unwrap();
        let mut s = Stream::new(1, [0; 3], Purpose::TEST);
        let mut seen = [0u64; 12];
        for _ in 0..100_000 {
            let (p, pdf) = table.sample([s.next_f64(), s.next_f64()]);
            let cell = (p.y * 3.0) as usize * 4 + (p.x * 4.0) as usize;
            assert!((pdf - table.pdf(p)).abs() < 1e-6 && (pdf as f64 - weights[cell] / 16.0 * 12.0).abs() < 1e-5);
            seen[cell] += 1;
        }
        let expected: Vec<f64> = weights.iter().map(|w| w / 16.0 * 100_000.0).collect();
        assert!(stats::chi2_goodness_of_fit(&seen, &expected, 0).p_value > 0.001);
    }
    #[test]
    fn a_table_without_light_is_none() {
        assert!(Table2d::new(2, 1, &[0.0, 0.0]).is_none());
        assert!(Table2d::new(2, 2, &[1.0; 3]).is_none());
        assert!(Table2d::new(1, 1, &[f64::NAN]).is_none());
    }
}
