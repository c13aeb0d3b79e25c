//! What a study says: means with intervals over runs, slopes, efficiencies, and which method is best.
//!
//! The run is the unit: all of a run's passes share nothing with another run's.

use super::{Cost, Row, Study};
use manylight_stats::{Alternative, MeanTest, Moments, holm, student_quantile};
use serde::Serialize;

/// Family-wise probability of calling a difference significant that is none.
const ALPHA: f64 = 0.05;

/// A mean over runs with a confidence interval of 95 %.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// Mean over runs.
    pub mean: f64,
    /// Lower end; `None` of a single run.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
}

impl Estimate {
    /// mean +- t s: for what may have either sign.
    fn linear(values: impl Iterator<Item = f64>) -> Option<Estimate> {
        let m: Moments = values.collect();
        let half = half_width(&m);
        (m.count() > 0).then(|| Estimate {
            mean: m.mean(),
            low: half.map(|h| m.mean() - h),
            high: half.map(|h| m.mean() + h),
        })
    }
    /// mean x exp(+- t s / mean): for errors, which are positive and skewed; linear where the mean is not positive.
    fn positive(values: impl Iterator<Item = f64> + Clone) -> Option<Estimate> {
        let linear = Estimate::linear(values.clone())?;
        let m: Moments = values.collect();
        let relative = half_width(&m).map(|h| h / m.mean());
        if !(m.mean() > 0.0) {
            return Some(linear);
        }
        Some(Estimate {
            mean: m.mean(),
            low: relative.map(|h| m.mean() * (-h).exp()),
            high: relative.map(|h| m.mean() * h.exp()),
        })
    }
    /// With another error, independent of that over runs.
    pub(crate) fn widened(self, half: f64) -> Estimate {
        let wide = |end: f64| (end - self.mean).hypot(half);
        Estimate { low: self.low.map(|l| self.mean - wide(l)), high: self.high.map(|h| self.mean + wide(h)), ..self }
    }
    /// The exponential of all three: of logarithms of ratios.
    fn exp(self) -> Estimate {
        Estimate { mean: self.mean.exp(), low: self.low.map(f64::exp), high: self.high.map(f64::exp) }
    }
}

fn half_width(m: &Moments) -> Option<f64> {
    (m.count() > 1).then(|| m.std_error() * student_quantile(0.975, m.count() as f64 - 1.0))
}

/// A method at a budget, over all runs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// The method.
    pub method: String,
    /// What it might spend.
    pub budget: Cost,
    /// Runs.
    pub runs: usize,
    /// Passes.
    pub passes: Option<f64>,
    /// Time. \[s\]
    pub seconds: f64,
    /// Part of the time before the first tiles.
    pub preparing: Option<f64>,
    /// Rays of all kinds.
    pub rays: Option<f64>,
    /// Relative mean squared error as measured.
    pub relmse: Estimate,
    /// The same without the reference's variance: what ranks are made of.
    pub relmse_net: Estimate,
    /// The squared bias in it. Its interval tells whether any is seen.
    pub bias: Option<Estimate>,
    /// The rest.
    pub noise: Option<Estimate>,
    /// sqrt(mean (I - R)^2).
    pub rmse: Estimate,
    /// Mean absolute relative error.
    pub mape: Estimate,
    /// LDR-FLIP.
    pub flip: Option<Estimate>,
    /// 99.9th percentile of the pixels' relative errors.
    pub percentile_999: Estimate,
    /// Slope of log sqrt(relmse_net) over log seconds, through all budgets: -1/2 for noise, 0 for bias.
    pub slope: Option<Estimate>,
    /// 1 / (relmse_net x seconds). \[1/s\]
    pub efficiency: Option<f64>,
    /// Efficiency over the baseline's at this budget: how many times faster it is where both errors go with 1 / time.
    pub speedup: Option<Estimate>,
    /// Samples that were not finite, all runs together.
    pub non_finite: u64,
}

/// The best against another.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Duel {
    /// The other.
    pub method: String,
    /// Its relmse_net over the best's, paired by run.
    pub ratio: Estimate,
    /// Probability of such a ratio between equals, adjusted for all duels of the budget (Holm); `None` of a single run.
    pub adjusted_p: Option<f64>,
    /// Is it below 0.05?
    pub significant: bool,
}

/// Which method has the least error at a budget.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Verdict {
    /// What all might spend.
    pub budget: Cost,
    /// Smallest mean relmse_net.
    pub best: String,
    /// Against the others, the nearest first.
    pub duels: Vec<Duel>,
    /// Methods that took much longer than the budget allows, since a pass is never cut and two always finish: they are not ranked.
    pub late: Vec<String>,
    /// Methods that cannot be held against the best: too few runs in common with an error above the reference's own noise.
    pub untold: Vec<String>,
}

/// Time over the budget from which on a method is late.
const LATE: f64 = 1.25;

impl Study {
    /// Each method at each budget.
    pub fn summary(&self) -> Vec<Summary> {
        let of = |method: &str| -> Vec<Cost> {
            let mut budgets: Vec<Cost> = Vec::new();
            self.rows.iter().filter(|r| r.method == method).for_each(|r| {
                if !budgets.contains(&r.budget) {
                    budgets.push(r.budget);
                }
            });
            budgets
        };
        let pairs = self.subjects.iter().flat_map(|s| of(&s.method).into_iter().map(|b| (s.method.as_str(), b)));
        pairs.filter_map(|(m, b)| self.summarise(m, b)).collect()
    }
    fn summarise(&self, method: &str, budget: Cost) -> Option<Summary> {
        let rows: Vec<&Row> = self.rows(method, budget).collect();
        let mean = |f: fn(&Row) -> Option<f64>| {
            let values: Option<Vec<f64>> = rows.iter().map(|r| f(r)).collect();
            values.and_then(|v| Estimate::linear(v.into_iter())).map(|e| e.mean)
        };
        let positive = |f: fn(&Row) -> f64| Estimate::positive(rows.iter().map(|r| f(r)));
        let every = |f: fn(&Row) -> Option<f64>| rows.iter().map(|r| f(r)).collect::<Option<Vec<f64>>>();
        let relmse_net = positive(|r| r.relmse_net)?;
        let seconds = mean(|r| Some(r.seconds))?;
        let log_cost = |r: &Row| (r.relmse_net > 0.0 && r.seconds > 0.0).then(|| (r.relmse_net * r.seconds).ln());
        let speedup =
            (method != self.baseline).then(|| self.paired(method, &self.baseline, budget, log_cost)).flatten();
        Some(Summary {
            method: method.into(),
            budget,
            runs: rows.len(),
            passes: mean(|r| r.passes.map(|n| n as f64)),
            seconds,
            preparing: mean(|r| r.seconds_preparing.map(|s| s / r.seconds)),
            rays: mean(|r| Some((r.camera_rays? + r.path_rays? + r.shadow_rays?) as f64)),
            relmse: positive(|r| r.relmse)?,
            relmse_net,
            bias: every(|r| r.bias).and_then(|v| Estimate::linear(v.into_iter())),
            noise: every(|r| r.noise).and_then(|v| Estimate::linear(v.into_iter())),
            rmse: positive(|r| r.rmse)?,
            mape: positive(|r| r.mape)?,
            flip: every(|r| r.flip).and_then(|v| Estimate::positive(v.into_iter())),
            percentile_999: positive(|r| r.percentile_999)?,
            slope: self.slope(method),
            efficiency: (relmse_net.mean > 0.0 && seconds > 0.0).then(|| 1.0 / (relmse_net.mean * seconds)),
            speedup: speedup.map(|(ratio, _)| ratio),
            non_finite: rows.iter().map(|r| r.non_finite).sum(),
        })
    }
    /// exp(mean over runs of f(b) - f(a)) with its interval, and the p value of a mean of zero.
    fn paired(
        &self,
        a: &str,
        b: &str,
        budget: Cost,
        f: impl Fn(&Row) -> Option<f64>,
    ) -> Option<(Estimate, Option<f64>)> {
        let partner = |r: &Row| self.rows(b, budget).find(|o| o.run == r.run).and_then(&f);
        // Runs that both have, and where both say something: a study may have been interrupted.
        let differences: Vec<f64> = self.rows(a, budget).filter_map(|r| Some(partner(r)? - f(r)?)).collect();
        if differences.is_empty() {
            return None;
        }
        let m: Moments = differences.iter().copied().collect();
        let p = (m.count() > 1).then(|| MeanTest::one_sample(&m, 0.0, Alternative::Different).p_value);
        Some((Estimate::linear(differences.into_iter())?.exp(), p))
    }
    /// A line for each run, through its own points: those of one run share passes, those of two do not.
    fn slope(&self, method: &str) -> Option<Estimate> {
        let mut runs: Vec<u32> = self.rows.iter().filter(|r| r.method == method).map(|r| r.run).collect();
        runs.dedup();
        runs.sort_unstable();
        runs.dedup();
        let line = |run: u32| {
            let rows = self.rows.iter().filter(|r| r.method == method && r.run == run);
            let points: Option<Vec<(f64, f64)>> =
                rows.map(|r| (r.relmse_net > 0.0).then(|| (r.seconds.ln(), 0.5 * r.relmse_net.ln()))).collect();
            least_squares(&points?)
        };
        Estimate::linear(runs.into_iter().map(line).collect::<Option<Vec<f64>>>()?.into_iter())
    }
    /// The best at each budget that all rendered methods share.
    pub fn verdict(&self) -> Vec<Verdict> {
        let summary = self.summary();
        let at = |budget: Cost| -> Option<Verdict> {
            let in_time = |s: &&Summary| match budget {
                Cost::Seconds(t) => s.seconds <= LATE * t,
                Cost::Passes(_) => true,
            };
            let all = summary.iter().filter(|s| s.budget == budget && s.passes.is_some());
            let (mut there, late): (Vec<&Summary>, Vec<&Summary>) = all.partition(in_time);
            there.sort_by(|a, b| a.relmse_net.mean.total_cmp(&b.relmse_net.mean));
            let (best, others) = there.split_first()?;
            let log = |r: &Row| (r.relmse_net > 0.0).then(|| r.relmse_net.ln());
            let found: Vec<(&str, Estimate, Option<f64>)> = others
                .iter()
                .filter_map(|o| {
                    self.paired(&best.method, &o.method, budget, log).map(|(e, p)| (o.method.as_str(), e, p))
                })
                .collect();
            let untold =
                others.iter().filter(|o| found.iter().all(|f| f.0 != o.method)).map(|o| o.method.clone()).collect();
            let late = late.iter().map(|s| s.method.clone()).collect();
            let adjusted = holm(&found.iter().map(|f| f.2.unwrap_or(1.0)).collect::<Vec<_>>());
            let duels = found.iter().zip(adjusted).map(|((method, ratio, p), adjusted)| Duel {
                method: (*method).into(),
                ratio: *ratio,
                adjusted_p: p.map(|_| adjusted),
                significant: p.is_some() && adjusted < ALPHA,
            });
            Some(Verdict { budget, best: best.method.clone(), duels: duels.collect(), late, untold })
        };
        self.budgets.iter().filter_map(|b| at(*b)).collect()
    }
}

/// The slope of a line through at least two points that differ in x.
fn least_squares(points: &[(f64, f64)]) -> Option<f64> {
    let n = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / n, y + p.1 / n));
    let spread: f64 = points.iter().map(|p| (p.0 - x).powi(2)).sum();
    (spread > 1e-9).then(|| points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>() / spread)
}

#[cfg(test)]
mod tests {
    use crate::study::tests::study;

    #[test]
    fn a_method_that_is_twice_as_good_in_every_run_is_so_significantly() {
        // Errors 1 / t with noise of 2 %, those of `b` doubled.
        let s = study(&[("a", 1.0), ("b", 2.0)], &[1.0, 4.0, 16.0], 4);
        let verdict = s.verdict();
        assert_eq!(verdict.len(), 3);
        for v in &verdict {
            assert_eq!((v.best.as_str(), v.duels[0].method.as_str()), ("a", "b"));
            let d = &v.duels[0];
            assert!(d.significant && (d.ratio.mean - 2.0).abs() < 0.1, "{d:?}");
            assert!(d.ratio.low.unwrap() < d.ratio.mean && d.ratio.mean < d.ratio.high.unwrap());
        }
        let summary = s.summary();
        assert_eq!(summary.len(), 6);
        let b = summary.iter().rfind(|s| s.method == "b").unwrap();
        // sqrt(1 / t): slope -1/2; half as efficient as the baseline `a`.
        let slope = b.slope.unwrap();
        assert!((slope.mean + 0.5).abs() < 0.02 && slope.low.unwrap() < -0.5 + 0.02, "{slope:?}");
        let speedup = b.speedup.unwrap();
        assert!((speedup.mean - 0.5).abs() < 0.03 && speedup.high.unwrap() < 1.0, "{speedup:?}");
        assert!((b.efficiency.unwrap() - 0.5).abs() < 0.03);
        assert_eq!(summary[0].speedup, None);
    }
    #[test]
    fn equals_are_called_different_as_seldom_as_stated() {
        let called = (0..400)
            .filter(|i| {
                study(&[("a", 1.0), ("b", 1.0), (["c", "d"][i % 2], 1.0)], &[1.0 + *i as f64], 4).verdict()[0]
                    .duels
                    .iter()
                    .any(|d| d.significant)
            })
            .count();
        // The best of three is chosen after the fact, so that duels against it are not quite those of the test.
        assert!(called < 400 * 12 / 100, "{called}");
    }
    #[test]
    fn who_took_longer_is_not_ranked_and_runs_without_a_partner_are_left_out() {
        let mut s = study(&[("a", 1.0), ("slow", 0.1), ("c", 2.0)], &[1.0, 16.0], 4);
        s.rows.iter_mut().filter(|r| r.method == "slow").for_each(|r| r.seconds = r.seconds.max(8.0));
        s.rows.retain(|r| !(r.method == "c" && r.run == 3));
        let verdict = s.verdict();
        assert_eq!((verdict[0].best.as_str(), &verdict[0].late[..]), ("a", &["slow".to_string()][..]));
        assert_eq!(verdict[0].duels[0].method, "c");
        assert!(verdict[0].duels[0].significant);
        assert_eq!((verdict[1].best.as_str(), verdict[1].late.len()), ("slow", 0));
        s.rows.iter_mut().filter(|r| r.method == "c").for_each(|r| r.relmse_net = -1e-9);
        let verdict = s.verdict();
        assert_eq!((verdict[0].best.as_str(), &verdict[0].untold[..]), ("c", &["a".to_string()][..]));
    }
    #[test]
    fn a_single_run_says_nothing_of_chance() {
        let s = study(&[("a", 1.0), ("b", 3.0)], &[1.0], 1);
        let (v, summary) = (s.verdict(), s.summary());
        assert!(!v[0].duels[0].significant && v[0].duels[0].adjusted_p.is_none());
        assert!(summary[0].relmse.low.is_none() && summary[0].slope.is_none());
    }
    #[test]
    fn errors_below_zero_have_no_logarithm_and_are_no_speed() {
        let mut s = study(&[("a", 1.0), ("b", 2.0)], &[1.0, 2.0], 2);
        s.rows.iter_mut().filter(|r| r.method == "b").for_each(|r| r.relmse_net = -1e-6);
        let summary = s.summary();
        let b = summary.iter().find(|s| s.method == "b").unwrap();
        assert!(b.efficiency.is_none() && b.speedup.is_none() && b.slope.is_none());
        assert!(s.plot(crate::Axis::RelMse).unwrap().is_some());
        assert!(s.page(&[]).unwrap().contains("error against time"));
    }
}
