//! Picking one of many with given weights.

/// Picks index `i` with probability `weight[i] / sum` in constant time (Walker 1977, Vose 1991). Built in f64.
#[derive(Clone, Debug)]
pub struct AliasTable {
    slots: Vec<(f64, u32)>,
    pmf: Vec<f64>,
    total: f64,
}

impl AliasTable {
    /// `None` if there is no weight, the sum is not positive and finite, or any weight is negative or NaN.
    pub fn new(weights: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut pmf: Vec<f64> = weights.into_iter().collect();
        let total: f64 = pmf.iter().sum();
        if !(total > 0.0 && total.is_finite()) || pmf.iter().any(|w| !(*w >= 0.0)) || pmf.len() > u32::MAX as usize {
            return None;
        }
        let n = pmf.len() as f64;
        pmf.iter_mut().for_each(|w| *w /= total);
        let mut scaled: Vec<f64> = pmf.iter().map(|p| p * n).collect();
        let mut slots: Vec<(f64, u32)> = (0..pmf.len() as u32).map(|i| (1.0, i)).collect();
        let (mut small, mut large): (Vec<usize>, Vec<usize>) = (0..pmf.len()).partition(|&i| scaled[i] < 1.0);
        while let (Some(&s), Some(&l)) = (small.last(), large.last()) {
            small.pop();
            slots[s] = (scaled[s], l as u32);
            scaled[l] -= 1.0 - scaled[s];
            if scaled[l] < 1.0 {
                large.pop();
                small.push(l);
            }
        }
        // What is left in `small` is full up to rounding; an entry of zero weight must never be picked all the same.
        if let Some(heaviest) = (0..pmf.len()).max_by(|&a, &b| pmf[a].total_cmp(&pmf[b])) {
            for s in small {
                if pmf[s] == 0.0 {
                    slots[s] = (0.0, heaviest as u32);
                }
            }
        }
        Some(AliasTable { slots, pmf, total })
    }
    /// One index from one uniform number, which should have 53 bits.
    pub fn sample(&self, u: f64) -> usize {
        let x = u * self.slots.len() as f64;
        let i = (x as usize).min(self.slots.len() - 1);
        let (keep, alias) = self.slots[i];
        if x - (i as f64) < keep { i } else { alias as usize }
    }
    /// Probability of `i`.
    pub fn pmf(&self, i: usize) -> f64 {
        self.pmf[i]
    }
    /// Number of entries.
    pub fn len(&self) -> usize {
        self.pmf.len()
    }
    /// Never true: a table of nothing cannot be made.
    pub fn is_empty(&self) -> bool {
        self.pmf.is_empty()
    }
    /// Sum of the weights it was made of.
    pub fn total(&self) -> f64 {
        self.total
    }
}

/// Picks by inverting a cumulative sum: logarithmic time, but it keeps the order, so what is left of the number can be reused.
#[derive(Clone, Debug)]
pub struct Cdf {
    sums: Vec<f64>,
}

impl Cdf {
    /// `None` as for `AliasTable::new`.
    pub fn new(weights: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut sums = vec![0.0];
        for w in weights {
            if !(w >= 0.0) {
                return None;
            }
            sums.push(sums[sums.len() - 1] + w);
        }
        let total = sums[sums.len() - 1];
        (total > 0.0 && total.is_finite()).then_some(Cdf { sums })
    }
    /// An index and the number within it, uniform in [0, 1).
    pub fn sample(&self, u: f64) -> (usize, f64) {
        let x = u * self.total();
        let mut i = self.sums.partition_point(|s| *s <= x).clamp(1, self.sums.len() - 1) - 1;
        // Rounding may land on an entry without weight at the end: step back to one that has some.
        while self.sums[i + 1] == self.sums[i] && i > 0 {
            i -= 1;
        }
        let width = self.sums[i + 1] - self.sums[i];
        (i, ((x - self.sums[i]) / width).clamp(0.0, 1.0 - f64::EPSILON))
    }
    /// Probability of `i`.
    pub fn pmf(&self, i: usize) -> f64 {
        (self.sums[i + 1] - self.sums[i]) / self.total()
    }
    /// Sum of the weights.
    pub fn total(&self) -> f64 {
        self.sums[self.sums.len() - 1]
    }
    /// Number of entries.
    pub fn len(&self) -> usize {
        self.sums.len() - 1
    }
    /// Never true: a sum of nothing cannot be inverted.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Purpose, Stream};
    use manylight_stats as stats;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_table_holds_exactly_its_weights(weights in prop::collection::vec(prop_oneof![Just(0.0), 1e-6f64..1e6], 1..60)) {
            let Some(table) = AliasTable::new(weights.clone()) else { prop_assert!(weights.iter().all(|w| *w == 0.0)); return Ok(()) };
            let n = weights.len() as f64;
            let mut mass = vec![0.0; weights.len()];
            for (i, (keep, alias)) in table.slots.iter().enumerate() {
                mass[i] += keep / n;
                mass[*alias as usize] += (1.0 - keep) / n;
            }
            for (i, m) in mass.iter().enumerate() {
                prop_assert!((m - table.pmf(i)).abs() < 1e-12 * n);
                prop_assert!(weights[i] > 0.0 || *m == 0.0, "an entry without weight can be picked");
            }
        }
        #[test]
        fn a_cdf_never_picks_nothing(weights in prop::collection::vec(prop_oneof![Just(0.0), 1e-6f64..1e6], 1..60), u in 0.0f64..1.0) {
            if let Some(cdf) = Cdf::new(weights.clone()) {
                for u in [u, 0.0, 1.0 - f64::EPSILON / 2.0] {
                    let (i, rest) = cdf.sample(u);
                    prop_assert!(weights[i] > 0.0 && (0.0..1.0).contains(&rest), "{} {}", i, rest);
                }
            }
        }
    }
    #[test]
    fn both_follow_their_weights() {
        let weights = [5.0, 0.0, 1.0, 10.0, 0.25, 3.75];
        let (table, cdf) = (AliasTable::new(weights).unwrap(), Cdf::new(weights).unwrap());
        let mut s = Stream::new(5, [0; 3], Purpose::TEST);
        let (mut a, mut b) = ([0u64; 6], [0u64; 6]);
        for _ in 0..200_000 {
            a[table.sample(s.next_f64())] += 1;
            b[cdf.sample(s.next_f64()).0] += 1;
        }
        let expected: Vec<f64> = weights.iter().map(|w| w / 20.0 * 200_000.0).collect();
        for seen in [a, b] {
            assert_eq!(seen[1], 0);
            assert!(stats::chi2_goodness_of_fit(&seen, &expected, 0).p_value > 0.001);
        }
    }
    #[test]
    fn bad_weights_make_no_table() {
        for bad in [vec![], vec![0.0, 0.0], vec![1.0, -1.0], vec![f64::NAN, 1.0], vec![f64::INFINITY]] {
            assert!(AliasTable::new(bad.clone()).is_none() && Cdf::new(bad).is_none());
        }
    }
}
