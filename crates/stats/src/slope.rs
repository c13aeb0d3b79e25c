//! Convergence slopes.

use crate::chi2::chi2_upper;
use crate::{Moments, StatsError, normal_quantile};

/// One point of a line in logarithms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Work: runs, lights, seconds.
    pub x: f64,
    /// Error.
    pub y: f64,
    /// Standard error of y.
    pub std_error: f64,
}

impl Point {
    /// The root of a mean over replicates: RMSE from replicates of the MSE.
    pub fn root_of_mean(x: f64, squares: &Moments) -> Self {
        let y = squares.mean().sqrt();
        Point { x, y, std_error: 0.5 * squares.std_error() / y }
    }
}

/// A line log y = intercept + slope log x, by least squares weighted with 1 / Var(log y) = (y / std_error)^2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slope {
    /// -1/2 for Monte Carlo with finite variance, 0 on a bias floor.
    pub slope: f64,
    /// Log y at log x = 0.
    pub intercept: f64,
    /// Standard error of the slope: what the points' errors make it, or what their scatter about the line makes it if that
    /// is larger.
    pub std_error: f64,
    /// Probability of a scatter at least as large about a true line: below alpha, this is no straight line (a bias floor, an
    /// infinite variance). NaN of two points.
    pub straight_p: f64,
}

impl Slope {
    /// Of at least two points with positive coordinates and errors.
    pub fn new(points: &[Point]) -> Result<Self, StatsError> {
        let good = |p: &Point| [p.x, p.y, p.std_error].iter().all(|v| v.is_finite() && *v > 0.0);
        if let Some(index) = points.iter().position(|p| !good(p)) {
            return Err(StatsError::BadPoint { index });
        }
        let logs: Vec<[f64; 3]> = points.iter().map(|p| [p.x.ln(), p.y.ln(), (p.y / p.std_error).powi(2)]).collect();
        let sum = |f: &dyn Fn(f64, f64) -> f64| logs.iter().map(|[x, y, w]| w * f(*x, *y)).sum::<f64>();
        let weight = sum(&|_, _| 1.0);
        let (mean_x, mean_y) = (sum(&|x, _| x) / weight, sum(&|_, y| y) / weight);
        let spread = sum(&|x, _| (x - mean_x) * (x - mean_x));
        // Points at one x differ by rounding alone.
        if !(spread > 1e-20 * weight) {
            return Err(StatsError::NoSlope);
        }
        let slope = sum(&|x, y| (x - mean_x) * (y - mean_y)) / spread;
        let scatter = sum(&|x, y| (y - mean_y - slope * (x - mean_x)).powi(2));
        let degrees = points.len() as f64 - 2.0;
        let (widen, straight_p) = if degrees > 0.0 {
            ((scatter / degrees).sqrt().max(1.0), chi2_upper(scatter, degrees))
        } else {
            (1.0, f64::NAN)
        };
        Ok(Slope { slope, intercept: mean_y - slope * mean_x, std_error: widen / spread.sqrt(), straight_p })
    }
    /// Lower and upper end of a confidence interval of the slope, `confidence` as 0.95.
    pub fn interval(&self, confidence: f64) -> (f64, f64) {
        let half = self.std_error * normal_quantile(0.5 + 0.5 * confidence);
        (self.slope - half, self.slope + half)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::{assert_between, count};

    fn line(f: impl Fn(f64) -> f64) -> Vec<Point> {
        (4..11).map(|k| f64::from(1 << k)).map(|x| Point { x, y: f(x), std_error: 0.1 * f(x) }).collect()
    }
    #[test]
    fn a_power_law_gives_its_power() {
        let fit = Slope::new(&line(|x| 3.0 / x.sqrt())).unwrap();
        assert!((fit.slope + 0.5).abs() < 1e-12 && (fit.intercept - 3f64.ln()).abs() < 1e-12, "{fit:?}");
        // Seven equal weights of 100, log x = k ln 2 with sum (k - mean)^2 = 28.
        assert!((fit.std_error - 1.0 / (100.0 * 28.0f64).sqrt() / 2f64.ln()).abs() < 1e-12);
        assert!((fit.straight_p - 1.0).abs() < 1e-9);
    }
    #[test]
    fn units_of_work_and_error_do_not_matter() {
        let points = line(|x| 3.0 / x.powf(0.4) + 0.1);
        let scaled: Vec<Point> =
            points.iter().map(|p| Point { x: 60.0 * p.x, y: 7.0 * p.y, std_error: 7.0 * p.std_error }).collect();
        let (a, b) = (Slope::new(&points).unwrap(), Slope::new(&scaled).unwrap());
        assert!((a.slope - b.slope).abs() < 1e-12 && (a.std_error - b.std_error).abs() < 1e-12);
    }
    #[test]
    fn a_point_with_a_large_error_weighs_little() {
        let mut points = line(|x| 1.0 / x);
        points[6].y *= 10.0;
        points[6].std_error = 1e6;
        assert!((Slope::new(&points).unwrap().slope + 1.0).abs() < 1e-6);
    }
    #[test]
    fn the_interval_holds_the_truth_as_often_as_it_says() {
        // Known errors.
        let hit = |fit: Slope| (fit.interval(0.95).0..fit.interval(0.95).1).contains(&-0.5);
        let hits = count(1, 2000, |rng| {
            let noisy =
                line(|x| 3.0 / x.sqrt()).into_iter().map(|p| Point { y: p.y * (0.1 * rng.normal()).exp(), ..p });
            let points: Vec<Point> = noisy.map(|p| Point { std_error: 0.1 * p.y, ..p }).collect();
            hit(Slope::new(&points).unwrap())
        });
        assert_between(hits, 2000, 0.95, 0.98);
        // Errors estimated from 16 replicates of an MSE over some 20 independent pixels.
        let hits = count(2, 2000, |rng| {
            let mse = |rng: &mut crate::rng::Rng, x: f64| (0..20).map(|_| rng.normal().powi(2) / 20.0).sum::<f64>() / x;
            let points: Vec<Point> = (4..11)
                .map(|k| f64::from(1 << k))
                .map(|x| Point::root_of_mean(x, &(0..16).map(|_| mse(rng, x)).collect()))
                .collect();
            hit(Slope::new(&points).unwrap())
        });
        assert_between(hits, 2000, 0.91, 0.98);
    }
    #[test]
    fn a_bias_floor_is_not_straight_and_not_one_half() {
        let floor = |x: f64| (1.0 / x + 0.004f64).sqrt();
        let points: Vec<Point> = line(floor).iter().map(|p| Point { std_error: 0.01 * p.y, ..*p }).collect();
        let fit = Slope::new(&points).unwrap();
        assert!(fit.straight_p < 1e-6 && fit.interval(0.99).0 > -0.5, "{fit:?}");
    }
    #[test]
    fn what_makes_no_line_is_refused() {
        let p = Point { x: 1.0, y: 1.0, std_error: 0.1 };
        assert_eq!(Slope::new(&[p, Point { y: 0.0, ..p }]), Err(StatsError::BadPoint { index: 1 }));
        assert_eq!(Slope::new(&[p, Point { std_error: f64::NAN, ..p }]), Err(StatsError::BadPoint { index: 1 }));
        assert_eq!(Slope::new(&[p, p]), Err(StatsError::NoSlope));
        assert_eq!(Slope::new(&[]), Err(StatsError::NoSlope));
    }
}
