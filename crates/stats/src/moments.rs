//! Mean and variance of a stream of numbers.

/// Count, mean and variance by Welford's update (1962); two merge by Chan et al. (1979).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    count: u64,
    mean: f64,
    squares: f64,
}

impl Moments {
    /// Adds one number.
    pub fn push(&mut self, x: f64) {
        self.count += 1;
        let before = x - self.mean;
        self.mean += before / self.count as f64;
        self.squares += before * (x - self.mean);
    }
    /// Adds all that `other` saw.
    pub fn merge(&mut self, other: &Moments) {
        if other.count == 0 {
            return;
        }
        let (n, m) = (self.count as f64, other.count as f64);
        let apart = other.mean - self.mean;
        self.count += other.count;
        self.mean += apart * m / (n + m);
        self.squares += other.squares + apart * apart * n * m / (n + m);
    }
    /// How many numbers there were.
    pub fn count(&self) -> u64 {
        self.count
    }
    /// Their mean; 0 if there were none.
    pub fn mean(&self) -> f64 {
        self.mean
    }
    /// Unbiased estimate of the variance; NaN below two numbers.
    pub fn variance(&self) -> f64 {
        if self.count < 2 { f64::NAN } else { self.squares / (self.count - 1) as f64 }
    }
    /// Standard deviation; NaN below two numbers.
    pub fn std_dev(&self) -> f64 {
        self.variance().sqrt()
    }
    /// Standard error of the mean, sqrt(variance / count); NaN below two numbers.
    pub fn std_error(&self) -> f64 {
        (self.variance() / self.count as f64).sqrt()
    }
}

impl FromIterator<f64> for Moments {
    fn from_iter<I: IntoIterator<Item = f64>>(numbers: I) -> Self {
        let mut moments = Moments::default();
        numbers.into_iter().for_each(|x| moments.push(x));
        moments
    }
}

/// The moments of each block of an image over its runs.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockMoments(Vec<Moments>);

impl BlockMoments {
    /// Of nothing yet.
    pub fn new(blocks: usize) -> Self {
        BlockMoments(vec![Moments::default(); blocks])
    }
    /// Adds one run.
    ///
    /// # Panics
    /// If it has another number of blocks.
    pub fn push(&mut self, run: &[f64]) {
        assert_eq!(run.len(), self.0.len(), "as many numbers as blocks");
        self.0.iter_mut().zip(run).for_each(|(moments, x)| moments.push(*x));
    }
    /// Adds all runs that `other` saw.
    ///
    /// # Panics
    /// If it has another number of blocks.
    pub fn merge(&mut self, other: &BlockMoments) {
        assert_eq!(other.0.len(), self.0.len(), "as many blocks in both");
        self.0.iter_mut().zip(&other.0).for_each(|(moments, o)| moments.merge(o));
    }
    /// Block by block.
    pub fn blocks(&self) -> &[Moments] {
        &self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn by_hand() {
        let m: Moments = [2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0].into_iter().collect();
        assert_eq!((m.count(), m.mean()), (8, 5.0));
        assert!((m.variance() - 32.0 / 7.0).abs() < 1e-14);
        assert!((m.std_error() - (32.0f64 / 7.0 / 8.0).sqrt()).abs() < 1e-15);
    }
    #[test]
    fn one_number_has_no_variance() {
        let m: Moments = [3.0].into_iter().collect();
        assert!(m.variance().is_nan() && m.std_error().is_nan() && m.mean() == 3.0);
    }
    #[test]
    fn a_large_offset_does_not_drown_the_variance() {
        let m: Moments = (0..1000).map(|i| 1e9 + (i % 2) as f64).collect();
        assert!((m.variance() - 250.0 / 999.0).abs() < 1e-9, "{}", m.variance());
    }
    #[test]
    fn blocks_are_kept_apart() {
        let (mut all, mut half) = (BlockMoments::new(2), BlockMoments::new(2));
        all.push(&[1.0, 10.0]);
        half.push(&[3.0, 10.0]);
        all.merge(&half);
        assert_eq!(all.blocks()[0], [1.0, 3.0].into_iter().collect());
        assert_eq!((all.blocks()[1].mean(), all.blocks()[1].variance()), (10.0, 0.0));
    }
}
