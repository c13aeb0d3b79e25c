//! Counter-based random streams.

use manylight_math::Vec2;

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
}

/// A stream of uniform numbers that is a pure function of (seed, place, purpose): whatever the threads, tiles and order of
/// evaluation, the same place gives the same numbers.
///
/// The n-th number is a mix of a 64-bit key and the counter n (the finaliser of SplitMix64, Steele et al. 2014).
#[derive(Clone, Debug)]
pub struct Stream {
    key: u64,
    counter: u64,
}

impl Stream {
    /// `at` is \[pass, pixel or path, sample\].
    pub fn new(seed: u64, at: [u64; 3], purpose: Purpose) -> Self {
        // Were `x` mixed before it is added, seed and pass would be interchangeable: mix(seed) ^ mix(pass).
        let key = at.iter().chain([&purpose.0]).fold(mix(seed), |h, &x| mix(h ^ x));
        Stream { key, counter: 0 }
    }
    /// 64 uniform bits.
    pub fn next_u64(&mut self) -> u64 {
        self.counter += 1;
        mix(self.key ^ mix(self.counter))
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

fn mix(z: u64) -> u64 {
    let z = z.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
