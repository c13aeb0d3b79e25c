//! Small steps on the torus of random numbers.

/// Smallest and largest step, as fractions of the torus (Kelemen et al. 2002).
const NEAREST: f64 = 1.0 / 1024.0;
const FARTHEST: f64 = 1.0 / 16.0;

/// Moves both halves of a number a little: each is a torus of its own, since [`next_2d`] makes a coordinate of each, and steps
/// are exponential between 1/1024 and 1/16 of it, up or down alike (so that the step back is as probable). `by` is uniform.
///
/// [`next_2d`]: manylight_sampling::Stream::next_2d
pub fn perturb(number: u64, by: u64) -> u64 {
    let half = |x: u64, by: u64| (x as u32).wrapping_add(step(by as u32)) as u64;
    half(number >> 32, by >> 32) << 32 | half(number & 0xffff_ffff, by & 0xffff_ffff)
}

/// One bit for the sign, the others for the length.
fn step(by: u32) -> u32 {
    let u = (by >> 1) as f64 / (1u64 << 31) as f64;
    let length = (FARTHEST * (NEAREST / FARTHEST).powf(u) * (1u64 << 32) as f64) as u32;
    if by & 1 == 0 { length } else { length.wrapping_neg() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use manylight_sampling::{Purpose, Stream};

    #[test]
    fn a_step_and_the_step_back_are_equally_probable() {
        let mut s = Stream::new(1, [0; 3], Purpose::TEST);
        for _ in 0..10_000 {
            let (x, by) = (s.next_u64(), s.next_u64());
            // The other sign of both halves leads back.
            assert_eq!(perturb(perturb(x, by), by ^ 0x1_0000_0001), x);
            let far = |shift: u32| {
                let d = ((perturb(x, by) >> shift) as u32).wrapping_sub((x >> shift) as u32) as i32;
                d.unsigned_abs() as f64 / (1u64 << 32) as f64
            };
            for shift in [0, 32] {
                assert!((NEAREST * 0.999..=FARTHEST).contains(&far(shift)), "{}", far(shift));
            }
        }
    }
}
