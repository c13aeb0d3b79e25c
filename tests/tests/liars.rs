//! Broken twins of the methods, composed through the same traits, which the tests must reject. Each is wrong in one place.
//!
//! Family-wise significance 0.01 by Holm within each verdict; seeds are fixed.

use manylight_compensation::BoundPlan;
use manylight_framework::{Batch, Claim, Compensation, Connection, GenerateError, Generator, Kernel, Probe, Promise};
use manylight_integration::rooms::{furnace, hollow_ball};
use manylight_integration::{block_runs, our_scene, recipe};
use manylight_light_list::All;
use manylight_many_lights::ManyLights;
use manylight_math::Spectrum;
use manylight_sampling::Stream;
use manylight_scene::{Edge, EmitterPoint, Scatter, Scene, Vertex};
use manylight_stats::{BlockTest, Reference, Runs, Verdict};
use manylight_vpl::{Emission, Emitters, Keller, Points, Sum, Vpl};

type Lights = Box<dyn Generator<Lights = Vec<Vpl>>>;

const HONEST: Keller = Keller { paths: 64, max_edges: None, certain_edges: 1, emission: Emission::Full };

/// A room whose radiance is 2 everywhere.
fn room() -> Scene {
    furnace(hollow_ball(1.0), 1.0, Spectrum::gray(0.5), Spectrum::ONE, (8, 8))
}
fn composed<K>(generator: Lights, kernel: K) -> ManyLights<Vec<Vpl>, All, K, BoundPlan> {
    let compensation = Compensation::None;
    let (bounding, max_edges, min_edges) = (BoundPlan::NONE, u32::MAX, 1);
    ManyLights { generator, plan: All, kernel, bounding, compensation, max_edges, min_edges, sharp: 0.0 }
}
/// Against the exact radiance, of all paths.
fn verdict<K: Kernel<Vertex, Vpl> + Send + 'static>(generator: Lights, kernel: K) -> Verdict {
    against(&composed(generator, kernel), 2.0)
}
/// The same for indirect light alone, which the lights bring without any noise of direct light.
fn indirect<K: Kernel<Vertex, Vpl> + Send + 'static>(generator: Lights, kernel: K) -> Verdict {
    against(&ManyLights { min_edges: 3, ..composed(generator, kernel) }, 0.5)
}
fn against(method: &dyn manylight_framework::Method, truth: f64) -> Verdict {
    let runs = block_runs(&room(), method, 1, 5, 64, 1);
    BlockTest::default().run(&runs, Reference::Exact(&[truth; 3])).unwrap()
}

/// A generator that does something wrong to the honest one's work.
struct Twisted<F>(F);
impl<F> Promise for Twisted<F> {
    fn claim(&self) -> Claim {
        Claim::UNBIASED
    }
}
impl<F> Generator for Twisted<F>
where
    F: Fn(&Scene, u64, u64, &mut Probe) -> Result<Batch<Vec<Vpl>>, GenerateError> + Send + Sync,
{
    type Lights = Vec<Vpl>;
    fn generate(&self, s: &Scene, pass: u64, seed: u64, p: &mut Probe) -> Result<Batch<Vec<Vpl>>, GenerateError> {
        (self.0)(s, pass, seed, p)
    }
}

/// A kernel that does something wrong to the honest one's connections.
struct Bent(fn(&Vertex, &Vpl, Connection) -> Connection);
impl Promise for Bent {
    fn claim(&self) -> Claim {
        Points.claim()
    }
}
impl Kernel<Vertex, Vpl> for Bent {
    fn connect(&self, scene: &Scene, r: &Vertex, l: &Vpl, s: &mut Stream) -> Option<Connection> {
        Points.connect(scene, r, l, s).map(|c| (self.0)(r, l, c))
    }
}

#[test]
fn the_honest_method_passes() {
    let v = verdict(Box::new(HONEST), Points);
    assert!(v.passes(), "{v}");
    let v = verdict(Box::new(Sum(vec![Box::new(HONEST), Box::new(Emitters { paths: 64 })])), Points);
    assert!(v.passes(), "{v}");
    let v = indirect(Box::new(HONEST), Bent(|_, _, c| c));
    assert!(v.passes(), "{v}");
}

#[test]
fn dividing_by_the_lights_instead_of_the_paths_is_caught() {
    let liar = Twisted(|s: &Scene, pass, seed, p: &mut Probe| {
        let mut batch = HONEST.generate(s, pass, seed, p)?;
        let wrong = HONEST.paths as f32 / batch.lights.len() as f32;
        batch.lights.iter_mut().for_each(|l| l.flux *= wrong);
        Ok(batch)
    });
    let v = indirect(Box::new(liar), Points);
    assert!(v.rejected(), "{v}");
}

#[test]
fn stopping_on_a_count_of_lights_is_caught() {
    // "Until there are four lights", dividing by the paths that it took: + 17 % of the indirect light.
    let liar = Twisted(|s: &Scene, pass, seed, p: &mut Probe| {
        let mut lights: Vec<Vpl> = Vec::new();
        // Sixteen such counts side by side, for the sake of a lighter tail.
        for k in 0..16 {
            let (mut found, mut paths) = (Vec::new(), 0u64);
            while found.len() < 4 {
                let one = Keller { paths: 1, ..HONEST };
                found.extend(one.generate(s, (pass * 16 + k) * 100 + paths, seed, p)?.lights);
                paths += 1;
            }
            found.iter_mut().for_each(|l| l.flux *= 1.0 / (16 * paths) as f32);
            lights.extend(found);
        }
        Ok(Batch { lights, paths: 64, covers_direct: false })
    });
    let v = indirect(Box::new(liar), Points);
    assert!(v.rejected(), "{v}");
}

#[test]
fn the_same_lights_in_every_pass_are_caught() {
    let liar = Twisted(|s: &Scene, _, seed, p: &mut Probe| HONEST.generate(s, 0, seed, p));
    let v = indirect(Box::new(liar), Points);
    assert!(v.rejected(), "{v}");
}

#[test]
fn emission_both_sampled_and_in_the_lights_is_caught() {
    let liar = Twisted(|s: &Scene, pass, seed, p: &mut Probe| {
        let both = Sum(vec![Box::new(HONEST), Box::new(Emitters { paths: 64 })]);
        Ok(Batch { covers_direct: false, ..both.generate(s, pass, seed, p)? })
    });
    let v = verdict(Box::new(liar), Points);
    assert!(v.rejected(), "{v}");
}

#[test]
fn the_light_s_cosine_twice_is_caught() {
    let v = verdict(
        Box::new(HONEST),
        Bent(|r, l, c| {
            let w = (r.p - l.vertex.p).normalize_or_zero();
            Connection { value: c.value * l.vertex.cosine(w), ..c }
        }),
    );
    assert!(v.rejected(), "{v}");
}

#[test]
fn half_a_per_cent_is_caught() {
    let r = recipe("path", &["spp=64"], &room());
    let rows = block_runs(&room(), &*r.method, r.spp, 4, 64, 1).rows().to_vec();
    for factor in [1.005, 0.995] {
        let runs = Runs::new(rows.iter().map(|row| row.iter().map(|x| x * factor).collect()).collect()).unwrap();
        let v = BlockTest::default().run(&runs, Reference::Exact(&[2.0; 3])).unwrap();
        assert!(v.rejected(), "{factor}: {v}");
    }
}

#[test]
fn lights_without_shadows_are_caught() {
    // Everything is seen from the light's own end: no edge is ever blocked.
    let no_shadow = Bent(|_, l, c| {
        let distant = matches!(l.vertex.scatter, Scatter::Emitter(EmitterPoint::Distant { .. }));
        let here = l.vertex.end();
        Connection { edge: if distant { c.edge } else { Edge::Between(here, here) }, ..c }
    });
    let scene = our_scene("ajar", (16, 10));
    let runs = |method: &dyn manylight_framework::Method| block_runs(&scene, method, 1, 5, 64, 1);
    let bounded = |kernel| {
        let mut method = composed(Box::new(Keller { max_edges: Some(12), ..HONEST }), kernel);
        (method.bounding, method.max_edges, method.min_edges) = (BoundPlan::fixed(1.0), 12, 3);
        method
    };
    let (honest, liar) = (runs(&bounded(Bent(|_, _, c| c))), runs(&bounded(no_shadow)));
    let v = BlockTest::default().run(&liar, Reference::Runs(&honest)).unwrap();
    assert!(v.rejected(), "{v}");
}
