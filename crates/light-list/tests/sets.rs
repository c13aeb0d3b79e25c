//! The two sets against their definition, with toy lights that carry what they give.

use manylight_framework::{BuildError, Contribute, LightSet, Occlusion, Picks, Plan, VirtualLight};
use manylight_light_list::{All, Power};
use manylight_math::{Aabb, Spectrum};
use manylight_sampling::{Purpose, Stream};
use manylight_scene::Edge;
use manylight_stats::{BlockTest, Reference, Runs, chi2_goodness_of_fit};

#[derive(Clone, Copy, Debug)]
struct Toy {
    power: f32,
    gives: Spectrum,
}
impl VirtualLight for Toy {
    fn intensity(&self) -> f32 {
        self.power
    }
    fn edges(&self) -> u32 {
        1
    }
}
/// Counts the questions.
#[derive(Default)]
struct Ask(usize);
impl Contribute<Toy> for Ask {
    fn contribution(&mut self, light: &Toy, _: &mut Stream) -> Spectrum {
        self.0 += 1;
        light.gives
    }
}
struct Clear;
impl Occlusion for Clear {
    fn transmittance(&self, _: &Edge, _: &mut Stream) -> Spectrum {
        Spectrum::ONE
    }
    fn extent(&self) -> Aabb {
        Aabb::EMPTY
    }
}
fn stream(seed: u64) -> Stream {
    Stream::new(seed, [0; 3], Purpose::TEST)
}
fn build<P: Plan<Vec<Toy>>>(plan: P, lights: &[Toy]) -> Result<P::Set, BuildError> {
    plan.build(lights.to_vec(), &Clear, &mut stream(0))
}
/// Lights whose powers and contributions are unrelated, one of them without power and contribution.
fn toys(n: usize) -> Vec<Toy> {
    let mut s = stream(9);
    let toy = |s: &mut Stream| {
        let gives = Spectrum::rgb(s.next_f32(), 10f32.powf(s.next_f32()), 0.0);
        Toy { power: 10f32.powf(s.next_f32() - 0.5), gives }
    };
    let mut toys: Vec<Toy> = (0..n).map(|_| toy(&mut s)).collect();
    toys[n / 2] = Toy { power: 0.0, gives: Spectrum::BLACK };
    toys
}
/// Neumaier's compensated sum of one channel.
fn sum(lights: &[Toy], channel: usize) -> f64 {
    let (mut sum, mut lost) = (0.0f64, 0.0f64);
    for x in lights.iter().map(|l| l.gives.to_array()[channel] as f64) {
        let t = sum + x;
        lost += if sum.abs() >= x.abs() { (sum - t) + x } else { (x - t) + sum };
        sum = t;
    }
    sum + lost
}

#[test]
fn all_is_the_sum_whatever_the_number_of_lights() {
    // Below, at and beyond the batches in which lights are asked.
    for n in (1..200).chain([255, 256, 257, 1000]) {
        let lights = toys(n);
        let mut ask = Ask::default();
        let all = build(All, &lights).unwrap().radiance(&mut ask, &mut stream(1)).to_array();
        assert_eq!(ask.0, n);
        for (k, c) in all.into_iter().enumerate() {
            let expected = sum(&lights, k) as f32;
            assert!((c - expected).abs() <= 1e-7 * expected, "{c} is not {expected}");
        }
    }
}

#[test]
fn a_million_lights_lose_no_digit() {
    let mut s = stream(2);
    let mut lights: Vec<Toy> = (0..1_000_000)
        .map(|_| Toy { power: 1.0, gives: Spectrum::rgb(0.123_456_79, 10f32.powf(-8.0 + 12.0 * s.next_f32()), 1e-30) })
        .collect();
    lights[0].gives.0.z = 1e-20;
    let all = build(All, &lights).unwrap().radiance(&mut Ask::default(), &mut s).to_array();
    assert!((all[0] as f64 / (0.123_456_79f32 as f64 * 1e6) - 1.0).abs() < 1e-6);
    for (k, c) in all.into_iter().enumerate() {
        assert!((c as f64 / sum(&lights, k) - 1.0).abs() < 1e-7, "channel {k}: {c} is not {}", sum(&lights, k));
    }
    // A sum in f32 would be caught.
    let f32_sum = lights.iter().fold(0.0f32, |s, l| s + l.gives.0.x) as f64;
    assert!((f32_sum / sum(&lights, 0) - 1.0).abs() > 1e-5);
}

#[test]
fn power_has_the_sum_as_its_mean_for_any_number_of_samples() {
    // Family-wise 0.01 by Holm over the channels.
    let lights = toys(50);
    let exact: Vec<f64> = (0..2).map(|k| sum(&lights, k)).collect();
    for samples in [0, 1, 3, 16, 64] {
        let set = build(Power { samples }, &lights).unwrap();
        let rows = (0..40_000).map(|i| {
            let mut ask = Ask::default();
            let c = set.radiance(&mut ask, &mut Stream::new(5, [i, 0, 0], Purpose::TEST)).to_array();
            assert_eq!((ask.0, c[2]), (samples.max(1) as usize, 0.0));
            vec![c[0] as f64, c[1] as f64]
        });
        let verdict = BlockTest::default().run(&Runs::new(rows.collect()).unwrap(), Reference::Exact(&exact)).unwrap();
        println!("{samples} samples: {verdict}");
        assert!(verdict.passes(), "{samples} samples: {verdict}");
    }
}

#[test]
fn what_gives_in_proportion_to_its_power_is_summed_without_noise() {
    // Then c / p is the same for all: a weight that were off by any factor shows in each estimate.
    let lights: Vec<Toy> =
        toys(50).iter().map(|t| Toy { power: t.power, gives: Spectrum::gray(3.0 * t.power) }).collect();
    let truth: f64 = sum(&lights, 0);
    let mut s = stream(3);
    for samples in [1, 7, 100] {
        let c = build(Power { samples }, &lights).unwrap().radiance(&mut Ask::default(), &mut s);
        assert!((c.0.x as f64 / truth - 1.0).abs() < 1e-6);
    }
}

#[test]
fn strata_give_each_light_its_whole_share() {
    // Eight equal lights and eight strata: each is asked exactly once.
    let lights: Vec<Toy> = (0..8).map(|i| Toy { power: 0.7, gives: Spectrum::gray(8f32.powi(i - 4)) }).collect();
    let set = build(Power { samples: 8 }, &lights).unwrap();
    for seed in 0..100 {
        let c = set.radiance(&mut Ask::default(), &mut stream(seed));
        assert!((c.0.x as f64 / sum(&lights, 0) - 1.0).abs() < 1e-6, "{c:?}");
    }
}

#[test]
fn picks_follow_the_probabilities_that_are_told_and_these_sum_to_one() {
    let lights = toys(40);
    let set = build(Power { samples: 4 }, &lights).unwrap();
    let pmf: Vec<f64> = (0..40).map(|i| set.pmf(&mut (), i)).collect();
    let total: f64 = lights.iter().map(|l| l.power as f64).sum();
    assert!((pmf.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    for (l, p) in lights.iter().zip(&pmf) {
        assert!((l.power as f64 / total - p).abs() < 1e-12 && (l.power > 0.0) == (*p > 0.0));
    }
    let (mut s, n) = (stream(4), 200_000);
    let mut seen = vec![0u64; 40];
    for _ in 0..n {
        let (i, p) = set.pick(&mut (), &mut s).unwrap();
        assert_eq!(p, pmf[i]);
        seen[i] += 1;
    }
    let expected: Vec<f64> = pmf.iter().map(|p| p * n as f64).collect();
    let test = chi2_goodness_of_fit(&seen, &expected, 0);
    assert!(test.p_value > 0.001, "{test:?}");
}

#[test]
fn without_lights_or_power_there_is_nothing_and_nobody_is_asked() {
    let dark = Toy { power: 0.0, gives: Spectrum::BLACK };
    for lights in [vec![], vec![dark; 3]] {
        let mut ask = Ask::default();
        let set = build(Power { samples: 4 }, &lights).unwrap();
        assert!(set.radiance(&mut ask, &mut stream(1)).is_black() && ask.0 == 0);
        assert!(set.pick(&mut (), &mut stream(1)).is_none());
        assert!((0..lights.len()).all(|i| set.pmf(&mut (), i) == 0.0));
        assert!(build(All, &lights).unwrap().radiance(&mut ask, &mut stream(1)).is_black());
    }
}

#[test]
fn a_light_that_is_not_finite_is_named() {
    for bad in [f32::NAN, f32::INFINITY, -1.0] {
        let mut lights = toys(10);
        lights[7].power = bad;
        assert_eq!(build(All, &lights).err(), Some(BuildError::NotFinite { light: 7 }));
        assert_eq!(build(Power { samples: 1 }, &lights).err(), Some(BuildError::NotFinite { light: 7 }));
    }
}
