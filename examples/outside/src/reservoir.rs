//! A light set of your own: two types, and two traits.
//!
//! `all` traces a shadow ray to every light. Here each point draws K lights uniformly, keeps one of them in proportion to what
//! it would give if nothing stood between, and traces one shadow ray (Talbot, Cline and Egbert 2005). With n lights, the
//! unshadowed contribution's luminance t_i as target, candidates i_1 .. i_K and i the one that is kept, the estimate is
//!
//! > c_i / t_i  x  (n / K) (t_i1 + .. + t_iK),
//!
//! whose expectation is the sum of the contributions c_i, for any K: the probability of keeping i is in proportion to t_i, which
//! cancels. Only a light with t_i = 0 and c_i > 0 would be lost, and a shadow makes no light brighter.

use manylight_framework::{
    BuildError, Claim, Contribute, LightSet, Occlusion, Plan, Promise, Unshadowed, VirtualLight,
};
use manylight_math::Spectrum;
use manylight_sampling::Stream;

/// The plan: the algorithm's name and its knobs.
#[derive(Clone, Copy, Debug)]
pub struct Reservoir {
    /// K: lights drawn at each point. More of them cost no shadow rays and leave less noise.
    pub candidates: u32,
}

impl Promise for Reservoir {
    fn claim(&self) -> Claim {
        Claim::UNBIASED
    }
}

/// The set: what the plan builds from the lights of one pass. A tree would be built here; this one just keeps them.
pub struct Candidates<L> {
    lights: Vec<L>,
    candidates: u32,
}

impl<L: VirtualLight> Plan<Vec<L>> for Reservoir {
    type Set = Candidates<L>;
    fn build(&self, lights: Vec<L>, _: &dyn Occlusion, _: &mut Stream) -> Result<Candidates<L>, BuildError> {
        // Say whose fault a NaN is now: later it would be a black pixel that nobody can explain.
        match lights.iter().position(|l| !l.intensity().is_finite()) {
            Some(light) => Err(BuildError::NotFinite { light }),
            None => Ok(Candidates { lights, candidates: self.candidates.max(1) }),
        }
    }
}

/// For whoever (`Q`) answers two questions about a light: what it would give here, and what it gives.
impl<L: VirtualLight, Q: Unshadowed<L> + Contribute<L>> LightSet<Q> for Candidates<L> {
    fn radiance(&self, ask: &mut Q, s: &mut Stream) -> Spectrum {
        if self.lights.is_empty() {
            return Spectrum::BLACK;
        }
        let (mut kept, mut sum) = (None, 0.0);
        for _ in 0..self.candidates {
            let light = &self.lights[s.next_below(self.lights.len())];
            let target = ask.unshadowed(light, s).luminance();
            sum += target;
            // The reservoir: replacing what it holds with probability target / sum leaves each in it in proportion to its own.
            if target > 0.0 && s.next_f32() * sum < target {
                kept = Some((light, target));
            }
        }
        // No candidate gives anything, even without shadows: an estimate of zero, and no ray.
        let Some((light, target)) = kept else { return Spectrum::BLACK };
        ask.contribution(light, s) * (self.lights.len() as f32 * sum / (self.candidates as f32 * target))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use manylight_math::{Aabb, Vec3};
    use manylight_sampling::Purpose;
    use manylight_scene::Edge;
    use manylight_stats::{Alternative, MeanTest, Moments};

    /// A light that gives `.0`, and `.1` of that through what stands between. A light set sees no more of any light.
    #[derive(Clone, Copy)]
    struct Toy(Spectrum, f32);
    impl VirtualLight for Toy {
        fn intensity(&self) -> f32 {
            self.0.luminance()
        }
        fn edges(&self) -> u32 {
            1
        }
    }
    /// A receiver: whatever answers the questions.
    struct Here;
    impl Contribute<Toy> for Here {
        fn contribution(&mut self, light: &Toy, _: &mut Stream) -> Spectrum {
            light.0 * light.1
        }
    }
    impl Unshadowed<Toy> for Here {
        fn unshadowed(&mut self, light: &Toy, _: &mut Stream) -> Spectrum {
            light.0
        }
    }
    struct Nothing;
    impl Occlusion for Nothing {
        fn transmittance(&self, _: &Edge, _: &mut Stream) -> Spectrum {
            Spectrum::ONE
        }
        fn extent(&self) -> Aabb {
            Aabb::point(Vec3::ZERO)
        }
    }
    fn estimates(candidates: u32, lights: Vec<Toy>, n: u64) -> [Moments; 3] {
        let mut s = Stream::new(1, [0; 3], Purpose::TEST);
        let set = Reservoir { candidates }.build(lights, &Nothing, &mut s).unwrap();
        let mut moments = [Moments::default(); 3];
        for _ in 0..n {
            let c = set.radiance(&mut Here, &mut s).to_array();
            moments.iter_mut().zip(c).for_each(|(m, c)| m.push(c as f64));
        }
        moments
    }

    #[test]
    fn its_mean_is_the_sum_in_every_channel_whatever_the_number_of_candidates() {
        let lights = vec![
            Toy(Spectrum::rgb(3.0, 0.1, 0.0), 1.0),
            Toy(Spectrum::rgb(0.0, 0.2, 5.0), 0.5),
            Toy(Spectrum::BLACK, 1.0),
            Toy(Spectrum::gray(20.0), 0.0), // bright, and in the shadow
            Toy(Spectrum::gray(0.01), 1.0),
        ];
        let sum = lights.iter().map(|l| l.0 * l.1).sum::<Spectrum>().to_array();
        for candidates in [1, 2, 16] {
            for (m, sum) in estimates(candidates, lights.clone(), 200_000).iter().zip(sum) {
                // Nine tests: together they err once in a hundred times.
                let test = MeanTest::one_sample(m, sum as f64, Alternative::Different);
                assert!(test.p_value > 0.01 / 9.0 && test.std_error < 0.02 * sum as f64, "K = {candidates}: {test:?}");
            }
        }
    }
    #[test]
    fn no_light_or_black_lights_give_nothing() {
        for lights in [vec![], vec![Toy(Spectrum::BLACK, 1.0)]] {
            assert!(estimates(4, lights, 10).iter().all(|m| m.mean() == 0.0 && m.variance() == 0.0));
        }
    }
    #[test]
    fn a_light_that_is_not_a_number_is_named() {
        let lights = vec![Toy(Spectrum::ONE, 1.0), Toy(Spectrum::gray(f32::NAN), 1.0)];
        let built = Reservoir { candidates: 1 }.build(lights, &Nothing, &mut Stream::new(1, [0; 3], Purpose::TEST));
        assert_eq!(built.err(), Some(BuildError::NotFinite { light: 1 }));
    }
}
