//! Which level counts for how much at which distance.

/// B_l(d) of level `level` of levels 0..=`top`, whose radius is r_l: for each distance the levels' weights sum to one. Level 0 counts
/// fully from the receiver on, the top level to infinity; the others rise from r_l / 2 to r_l and fall until 2 r_l.
pub fn weight(level: u32, top: u32, radius: f64, d: f64) -> f64 {
    if d <= radius {
        // (A receiver and a light at one place: level 0.)
        if level == 0 { 1.0 } else { (2.0 * d / radius - 1.0).max(0.0) }
    } else if level == top {
        1.0
    } else {
        (2.0 - d / radius).max(0.0)
    }
}

/// Beyond which distances, inner and outer, a level's weight is zero.
pub fn support(level: u32, top: u32, radius: f64) -> (f64, f64) {
    (if level == 0 { 0.0 } else { 0.5 * radius }, if level == top { f64::INFINITY } else { 2.0 * radius })
}

#[cfg(test)]
mod tests {
    use super::*;
    use manylight_sampling::{Purpose, Stream};

    #[test]
    fn weights_are_a_partition_of_unity_at_every_distance() {
        let mut s = Stream::new(3, [0; 3], Purpose::TEST);
        for top in [0u32, 1, 2, 5] {
            let radius = |l: u32| 0.37 * f64::from(1 << l);
            for i in 0..100_000 {
                // Small distances too: half of them within the lowest levels.
                let d = s.next_f64() * radius(top) * if i % 2 == 0 { 100.0 } else { 2.0 };
                let weights: Vec<f64> = (0..=top).map(|l| weight(l, top, radius(l), d)).collect();
                assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12, "top {top}, d {d}: {weights:?}");
                assert!(weights.iter().filter(|w| **w > 0.0).count() <= 2);
                for (l, w) in weights.iter().enumerate() {
                    let (inner, outer) = support(l as u32, top, radius(l as u32));
                    assert!((0.0..=1.0).contains(w) && (*w == 0.0 || (inner..=outer).contains(&d)));
                }
            }
        }
    }
    #[test]
    fn weights_are_continuous_where_their_pieces_meet() {
        let (top, r) = (3, 0.8);
        for level in 0..=top {
            for d in [0.5 * r, r, 2.0 * r] {
                let (below, above) = (weight(level, top, r, d * (1.0 - 1e-9)), weight(level, top, r, d * (1.0 + 1e-9)));
                assert!((below - above).abs() < 1e-8, "level {level} at {d}: {below} and {above}");
            }
        }
    }
}
