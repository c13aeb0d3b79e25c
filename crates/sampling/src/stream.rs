//! Counter-based random streams.
//!
//! The generator behind rand's traits is our own: its numbers depend on their place alone, and are the same on every platform.

use manylight_math::Vec2;
use rand::TryRng;
use rand::rand_core::utils::fill_bytes_via_next_word;
use std::convert::Infallible;
use std::fmt;
use std::sync::Arc;

/// What a stream is drawn for. Streams of different purposes never share a number, so that one part of a method can be
/// changed without moving the random numbers of another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Purpose(pub u64);

impl Purpose {
    /// Camera samples and what they meet.
    pub const CAMERA: Purpose = Purpose(0);
    /// Light paths.
    pub const LIGHT_PATHS: Purpose = Purpose(1);
    /// Building light sets.
    pub const BUILD: Purpose = Purpose(2);
    /// Compensation of a whole frame.
    pub const FRAME: Purpose = Purpose(3);
    /// Tests.
    pub const TEST: Purpose = Purpose(4);
    /// What a light would bring to the camera, and whether it is kept.
    pub const IMPORTANCE: Purpose = Purpose(5);
    /// Steps of Markov chains.
    pub const CHAINS: Purpose = Purpose(6);
}

/// A stream of uniform numbers that is a pure function of (seed, place, purpose): whatever the threads, tiles and order of
/// evaluation, the same place gives the same numbers.
///
/// The n-th number is a mix of a 64-bit key and the counter n (the finaliser of SplitMix64, Steele et al. 2014).
///
/// It is a [`rand::Rng`], so that whatever draws from one draws from it. It is no `SeedableRng`: a stream comes from its place.
///
/// ```
/// use manylight_sampling::{Purpose, Stream};
/// use rand::{RngExt, seq::SliceRandom};
/// let mut stream = Stream::new(1, [0, 42, 0], Purpose::TEST);
/// let die = stream.random_range(1..=6);
/// let mut order = [0, 1, 2, 3];
/// order.shuffle(&mut stream);
/// assert!((1..=6).contains(&die));
/// ```
#[derive(Clone)]
pub struct Stream {
    key: u64,
    counter: u64,
    /// What the numbers are instead, where someone else says so.
    given: Option<Numbers>,
}

/// The n-th number of a stream, from 0 on: 64 uniform bits.
pub type Numbers = Arc<dyn Fn(u64) -> u64 + Send + Sync>;

impl fmt::Debug for Stream {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let given = self.given.is_some();
        f.debug_struct("Stream").field("key", &self.key).field("drawn", &self.counter).field("given", &given).finish()
    }
}

impl Stream {
    /// `at` is \[pass, pixel or path, sample\].
    pub fn new(seed: u64, at: [u64; 3], purpose: Purpose) -> Self {
        // Were `x` mixed before it is added, seed and pass would be interchangeable: mix(seed) ^ mix(pass).
        let key = at.iter().chain([&purpose.0]).fold(mix(seed), |h, &x| mix(h ^ x));
        Stream { key, counter: 0, given: None }
    }
    /// A stream of given numbers, drawn in order: a path becomes a function of them, that one can perturb (Metropolis sampling
    /// in the space of primary samples). Both halves of a number are used by `next_2d`, the upper one before the lower.
    pub fn of(numbers: Numbers) -> Self {
        Stream { key: 0, counter: 0, given: Some(numbers) }
    }
    /// 64 uniform bits.
    pub fn next_u64(&mut self) -> u64 {
        let number = self.nth(self.counter);
        self.counter += 1;
        number
    }
    /// The n-th number, from 0 on, without drawing it.
    pub fn nth(&self, n: u64) -> u64 {
        match &self.given {
            None => mix(self.key ^ mix(n + 1)),
            Some(numbers) => numbers(n),
        }
    }
    /// How many numbers have been drawn.
    pub fn drawn(&self) -> u64 {
        self.counter
    }
    /// Uniform in [0, 1), 24 bits.
    pub fn next_f32(&mut self) -> f32 {
        (self.next_u64() >> 40) as f32 * (1.0 / (1u64 << 24) as f32)
    }
    /// Uniform in [0, 1), 53 bits: a number that is reused down a tree, or looked up in a long table, needs them.
    pub fn next_f64(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }
    /// Uniform in the unit square: both halves of one draw.
    pub fn next_2d(&mut self) -> Vec2 {
        let bits = self.next_u64();
        let scale = 1.0 / (1u64 << 24) as f32;
        Vec2::new((bits >> 40) as f32 * scale, (bits >> 8 & 0xff_ffff) as f32 * scale)
    }
    /// Uniform in 0..n. `n` must be positive.
    pub fn next_below(&mut self, n: usize) -> usize {
        // The bias of the multiply-shift is n / 2^64: never seen.
        ((self.next_u64() as u128 * n as u128) >> 64) as usize
    }
}

/// [`rand::Rng`] follows from this.
impl TryRng for Stream {
    type Error = Infallible;

    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        Ok((self.next_u64() >> 32) as u32)
    }
    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        Ok(self.next_u64())
    }
    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        fill_bytes_via_next_word(bytes, || self.try_next_u64())
    }
}

fn mix(z: u64) -> u64 {
    let z = z.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::distr::StandardUniform;
    use rand::seq::SliceRandom;
    use rand::{Rng, RngExt};
    use std::collections::HashMap;

    /// The same stream twice.
    fn twins() -> (Stream, Stream) {
        let s = Stream::new(7, [1, 2, 3], Purpose::TEST);
        (s.clone(), s)
    }

    #[test]
    fn a_stream_is_a_pure_function_of_its_place() {
        let draw = |at, p| {
            let mut s = Stream::new(7, at, p);
            (0..8).map(|_| s.next_u64()).collect::<Vec<_>>()
        };
        assert_eq!(draw([1, 2, 3], Purpose::TEST), draw([1, 2, 3], Purpose::TEST));
        assert_ne!(draw([1, 2, 3], Purpose::TEST), draw([1, 3, 2], Purpose::TEST));
        assert_ne!(draw([1, 2, 3], Purpose::TEST), draw([1, 2, 3], Purpose::CAMERA));
    }
    #[test]
    fn all_small_seeds_places_and_purposes_have_streams_of_their_own() {
        let mut firsts = Vec::new();
        for i in 0..8u64.pow(5) {
            let [seed, pass, pixel, sample, purpose] = std::array::from_fn(|k| i >> (3 * k) & 7);
            firsts.push(Stream::new(seed, [pass, pixel, sample], Purpose(purpose)).next_u64());
        }
        let count = firsts.len();
        firsts.sort_unstable();
        firsts.dedup();
        assert_eq!(firsts.len(), count);
    }
    #[test]
    fn numbers_stay_below_one() {
        let mut s = Stream::new(0, [0; 3], Purpose::TEST);
        for _ in 0..100_000 {
            let p = s.next_2d();
            assert!(s.next_f32() < 1.0 && s.next_f64() < 1.0 && p.x < 1.0 && p.y < 1.0 && s.next_below(3) < 3);
        }
        assert!((0xff_ffffu32 as f32) / ((1u64 << 24) as f32) < 1.0);
    }
    #[test]
    fn the_numbers_are_these_for_good() {
        let mut s = Stream::new(1, [2, 3, 4], Purpose::TEST);
        assert_eq!([(); 3].map(|()| s.next_u64()), [18297004953243371522, 14460950057096645786, 16302398736872535320]);
    }
    #[test]
    fn a_stream_of_given_numbers_draws_them_in_order() {
        let place = Stream::new(3, [1, 2, 3], Purpose::TEST);
        let mut drawn = place.clone();
        let numbers: Vec<u64> = (0..5).map(|_| drawn.next_u64()).collect();
        assert_eq!(numbers, (0..5).map(|n| place.nth(n)).collect::<Vec<_>>());
        let mut given = Stream::of(Arc::new(move |n| place.nth(n) ^ 1));
        assert_eq!((0..5).map(|_| given.next_u64() ^ 1).collect::<Vec<_>>(), numbers);
        assert_eq!((drawn.drawn(), given.drawn()), (5, 5));
    }
    #[test]
    fn rand_sees_the_numbers_of_the_stream() {
        let (mut ours, mut theirs) = twins();
        assert_eq!(Rng::next_u64(&mut theirs), ours.next_u64());
        assert_eq!(Rng::next_u32(&mut theirs), (ours.next_u64() >> 32) as u32);
        let mut bytes = [0; 11];
        Rng::fill_bytes(&mut theirs, &mut bytes);
        assert_eq!(bytes[..8], ours.next_u64().to_le_bytes());
        assert_eq!(bytes[8..], ours.next_u64().to_le_bytes()[..3]);
        assert_eq!(theirs.random::<f64>(), ours.next_f64());
    }
    #[test]
    fn distributions_and_shuffles_of_rand_draw_from_a_stream() {
        const N: usize = 60_000;
        // Within five standard deviations of the mean.
        let near = |mean: f64, want: f64, deviation: f64| (mean - want).abs() < 5.0 * deviation / (N as f64).sqrt();
        let (mut s, _) = twins();
        let mean = (0..N).map(|_| s.sample::<f64, _>(StandardUniform)).sum::<f64>() / N as f64;
        assert!(near(mean, 0.5, 12f64.sqrt().recip()), "{mean}");
        let mean = (0..N).map(|_| f64::from(s.random_range(-3..=3))).sum::<f64>() / N as f64;
        assert!(near(mean, 0.0, 2.0), "{mean}");
        // Each of the 6 orders equally often.
        let mut counts = HashMap::new();
        for _ in 0..N {
            let mut order = [0, 1, 2];
            order.shuffle(&mut s);
            *counts.entry(order).or_insert(0) += 1;
        }
        assert_eq!(counts.len(), 6);
        assert!(counts.values().all(|&n| near(f64::from(n) / N as f64, 1.0 / 6.0, (5f64 / 36.0).sqrt())), "{counts:?}");
    }
    #[test]
    fn what_rand_draws_is_a_pure_function_of_the_place() {
        let draw = |mut s: Stream| {
            let mut order: [u8; 32] = std::array::from_fn(|i| i as u8);
            order.shuffle(&mut s);
            (order, s.random_range(0..1000), s.random_bool(0.5), s.random::<[u32; 4]>())
        };
        let (a, b) = twins();
        assert_eq!(draw(a), draw(b));
    }
}
