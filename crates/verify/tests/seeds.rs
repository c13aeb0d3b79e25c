//! Right methods pass and liars are caught, whatever the seed: one here, and `MANYLIGHT_EFFORT` of them, twenty at most, where that is set.

use manylight_compensation::BoundPlan;
use manylight_framework::{
    Batch, Claim, Compensation, Connection, GenerateError, Generator, Kernel, KnobSet, Method, Probe, Promise,
};
use manylight_light_list::All;
use manylight_many_lights::ManyLights;
use manylight_sampling::Stream;
use manylight_scene::{Edge, EmitterPoint, Scatter, Scene, Vertex};
use manylight_verify::{Built, Effort, Knobs, Made, Place, Subject, Verifier};
use manylight_vpl::{Emission, Keller, Points, Vpl};

type Change = fn(&mut Batch<Vec<Vpl>>);

/// Keller's lights, and something done to them.
struct Changed {
    walk: Keller,
    change: Change,
    claim: Claim,
}
impl Promise for Changed {
    fn claim(&self) -> Claim {
        self.claim
    }
}
impl Generator for Changed {
    type Lights = Vec<Vpl>;
    fn generate(&self, s: &Scene, pass: u64, seed: u64, p: &mut Probe) -> Result<Batch<Vec<Vpl>>, GenerateError> {
        let mut batch = self.walk.generate(s, pass, seed, p)?;
        (self.change)(&mut batch);
        Ok(batch)
    }
}

/// The honest kernel, which may forget shadows.
struct Seeing {
    through_walls: bool,
}
impl Promise for Seeing {
    fn claim(&self) -> Claim {
        Points.claim()
    }
}
impl Kernel<Vertex, Vpl> for Seeing {
    fn connect(&self, scene: &Scene, r: &Vertex, l: &Vpl, s: &mut Stream) -> Option<Connection> {
        let c = Points.connect(scene, r, l, s)?;
        let distant = matches!(l.vertex.scatter, Scatter::Emitter(EmitterPoint::Distant { .. }));
        let here = l.vertex.end();
        Some(if self.through_walls && !distant { Connection { edge: Edge::Between(here, here), ..c } } else { c })
    }
}

#[derive(Clone, Copy)]
struct Recipe {
    change: Change,
    claim: Claim,
    through_walls: bool,
    bound: BoundPlan,
}
const HONEST: Recipe = Recipe { change: |_| (), claim: Claim::UNBIASED, through_walls: false, bound: BoundPlan::NONE };

impl Recipe {
    fn subject(self, name: &str) -> impl Subject + use<> {
        Made { name: name.into(), make: move |scene: &Scene, knobs: &Knobs| self.build(scene, knobs) }
    }
    fn build(&self, scene: &Scene, knobs: &Knobs) -> Result<Built, String> {
        if scene.has_media() {
            return Err("it knows no media".into());
        }
        let paths = knobs.iter().find(|k| k.0 == "paths").map_or(Ok(64), |k| k.1.parse()).map_err(|_| "paths")?;
        let max_edges = scene.max_depth().unwrap_or(u32::MAX);
        let walk = Keller { paths, max_edges: Some(max_edges), certain_edges: 1, emission: Emission::Full };
        let method: Box<dyn Method> = Box::new(ManyLights {
            generator: Box::new(Changed { walk, change: self.change, claim: self.claim }),
            plan: All,
            kernel: Seeing { through_walls: self.through_walls },
            bounding: self.bound,
            compensation: Compensation::None,
            max_edges,
            min_edges: 1,
            sharp: 0.0,
        });
        Ok(Built { method, spp: 1 })
    }
}

/// Multiplies the flux of all lights.
macro_rules! times {
    ($factor:expr) => {
        |b| b.lights.iter_mut().for_each(|l| l.flux *= $factor)
    };
}

#[test]
fn right_methods_pass_and_liars_are_caught() {
    let bounded = Recipe { bound: BoundPlan::AUTO, ..HONEST };
    let vanishes = Claim { brightens: false, ..Claim::consistent(KnobSet::PATHS) };
    let no_promise = Claim { bias: f32::INFINITY, brightens: true, ..Claim::UNBIASED };
    let by_lights: Change = |b| {
        let wrong = b.paths as f32 / b.lights.len().max(1) as f32;
        b.lights.iter_mut().for_each(|l| l.flux *= wrong);
    };
    let not_finite: Change = |b| b.lights.iter_mut().take(1).for_each(|l| l.flux *= f32::NAN);
    let right = [("unbounded", HONEST), ("bounded", bounded)];
    let wrong = [
        ("a tenth too much flux", Recipe { change: times!(1.1), ..HONEST }),
        ("says it darkens, and brightens", Recipe { change: times!(1.15), ..bounded }),
        ("a bias that is said to vanish, and stays", Recipe { change: times!(0.8), claim: vanishes, ..bounded }),
        ("sees through walls", Recipe { through_walls: true, ..HONEST }),
        ("divides by lights, not by paths", Recipe { change: by_lights, ..HONEST }),
        ("is not finite, and promises nothing", Recipe { change: not_finite, claim: no_promise, ..HONEST }),
    ];
    let seeds = std::env::var("MANYLIGHT_EFFORT").map_or(1, |t| t.parse::<u64>().unwrap()).min(20);
    for seed in 0..seeds {
        let verifier = Verifier::new(Place::standard().unwrap(), Effort::QUICK, 100 + seed);
        let report = |name: &str, recipe: Recipe| verifier.verify(&recipe.subject(name)).unwrap();
        for (name, recipe) in right {
            let found = report(name, recipe);
            assert!(!found.fails() && found.says_something(), "seed {seed}: {found}");
        }
        for (name, recipe) in wrong {
            let found = report(name, recipe);
            assert!(found.fails(), "seed {seed}: {found}");
        }
    }
}
