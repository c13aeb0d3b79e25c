//! What is right passes Manylight's suite, and what is not is caught: three seeds each, or `MANYLIGHT_EFFORT` of them.

use manylight_compensation::BoundPlan;
use manylight_framework::{
    Batch, BuildError, Claim, Compensation, Contribute, GenerateError, Generator, LightSet, Method, Occlusion, Plan,
    Probe, Promise, Unshadowed, VirtualLight,
};
use manylight_light_list::All;
use manylight_many_lights::ManyLights;
use manylight_math::Spectrum;
use manylight_sampling::Stream;
use manylight_scene::Scene;
use manylight_verify::{Built, Effort, Knobs, Made, Place, Report, Subject, Verifier};
use manylight_vpl::{Emission, Keller, Points, Vpl};
use outside::{Lambert, Reservoir, Sorted, Two};

/// Keeps lights as [`Sorted`] does, and all of them, the diffuse ones too, as what they were: those count twice.
struct Twice(Sorted);
impl Promise for Twice {
    fn claim(&self) -> Claim {
        self.0.claim()
    }
}
impl Generator for Twice {
    type Lights = (Vec<Lambert>, Vec<Vpl>);
    fn generate(&self, s: &Scene, pass: u64, seed: u64, p: &mut Probe) -> Result<Batch<Self::Lights>, GenerateError> {
        let (diffuse, batch) = (self.0.generate(s, pass, seed, p)?.lights.0, self.0.0.generate(s, pass, seed, p)?);
        Ok(Batch { lights: (diffuse, batch.lights), paths: batch.paths, covers_direct: batch.covers_direct })
    }
}

/// [`Reservoir`] as it is easily written: the sum of the targets is divided by the candidates that give anything, not by all.
struct Forgetful(u32);
struct Remembered<L>(Vec<L>, u32);
impl Promise for Forgetful {
    fn claim(&self) -> Claim {
        Claim::UNBIASED // it says
    }
}
impl<L: VirtualLight> Plan<Vec<L>> for Forgetful {
    type Set = Remembered<L>;
    fn build(&self, lights: Vec<L>, _: &dyn Occlusion, _: &mut Stream) -> Result<Remembered<L>, BuildError> {
        Ok(Remembered(lights, self.0))
    }
}
impl<L: VirtualLight, Q: Unshadowed<L> + Contribute<L>> LightSet<Q> for Remembered<L> {
    fn radiance(&self, ask: &mut Q, s: &mut Stream) -> Spectrum {
        let (mut kept, mut sum, mut some) = (None, 0.0, 0);
        for _ in 0..if self.0.is_empty() { 0 } else { self.1 } {
            let light = &self.0[s.next_below(self.0.len())];
            let target = ask.unshadowed(light, s).luminance();
            sum += target;
            some += u32::from(target > 0.0);
            if target > 0.0 && s.next_f32() * sum < target {
                kept = Some((light, target));
            }
        }
        let Some((light, target)) = kept else { return Spectrum::BLACK };
        ask.contribution(light, s) * (self.0.len() as f32 * sum / (some as f32 * target))
    }
}

fn keller(scene: &Scene) -> Keller {
    Keller { paths: 64, max_edges: Some(edges(scene)), certain_edges: 1, emission: Emission::Full }
}
fn edges(scene: &Scene) -> u32 {
    scene.max_depth().unwrap_or(u32::MAX)
}

/// A subject whose lights are two lists.
fn lights<G>(name: &str, generator: fn(Keller) -> G) -> Box<dyn Subject>
where
    G: Generator<Lights = (Vec<Lambert>, Vec<Vpl>)> + 'static,
{
    subject(name, move |scene| {
        Box::new(ManyLights {
            generator: Box::new(generator(keller(scene))),
            plan: (All, All),
            kernel: Two,
            bounding: BoundPlan::NONE,
            compensation: Compensation::None,
            max_edges: edges(scene),
            min_edges: 1,
            sharp: 0.0,
        })
    })
}

/// A subject whose light set is a plan.
fn set<P>(name: &str, plan: fn() -> P) -> Box<dyn Subject>
where
    P: Plan<Vec<Vpl>> + 'static,
    ManyLights<Vec<Vpl>, P, Points, BoundPlan>: Method,
{
    subject(name, move |scene| {
        Box::new(ManyLights {
            generator: Box::new(keller(scene)),
            plan: plan(),
            kernel: Points,
            bounding: BoundPlan::NONE,
            compensation: Compensation::None,
            max_edges: edges(scene),
            min_edges: 1,
            sharp: 0.0,
        })
    })
}

fn subject(name: &str, method: impl Fn(&Scene) -> Box<dyn Method> + Sync + 'static) -> Box<dyn Subject> {
    let make = move |scene: &Scene, _: &Knobs| match scene.has_media() {
        true => Err("it knows no media".to_string()),
        false => Ok(Built { method: method(scene), spp: 1 }),
    };
    Box::new(Made { name: name.into(), make })
}

fn reports(subject: &dyn Subject) -> Vec<Report> {
    let seeds = std::env::var("MANYLIGHT_EFFORT").map_or(3, |text| text.parse::<u64>().unwrap());
    let each = |seed| Verifier::new(Place::standard().unwrap(), Effort::QUICK, 500 + seed).verify(subject).unwrap();
    (0..seeds).map(each).collect()
}

#[test]
fn a_right_light_and_a_right_light_set_keep_their_claims() {
    for right in [lights("sorted", Sorted), set("reservoir", || Reservoir { candidates: 16 })] {
        for report in reports(&*right) {
            assert!(!report.fails() && report.says_something(), "{report}");
        }
    }
}

#[test]
fn a_light_and_a_light_set_that_lie_are_caught() {
    for liar in [lights("twice", |k| Twice(Sorted(k))), set("forgetful", || Forgetful(16))] {
        for report in reports(&*liar) {
            assert!(report.fails(), "{report}");
        }
    }
}
