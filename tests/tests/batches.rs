//! Lights asked together give what they give alone, bit for bit: shadows, media and masks included.

use manylight_compensation::BoundPlan;
use manylight_framework::{BoundingPlan, Contribute, Gather, Generator, Probe};
use manylight_integration::our_scene;
use manylight_math::{Spectrum, Vec2, Vec3};
use manylight_sampling::{Purpose, Stream, warp};
use manylight_scene::{Edge, Mode, Scene, Simd, Vertex};
use manylight_vpl::{Emission, Keller, Points, Vpl, connect_vertices};

fn stream(k: u64) -> Stream {
    Stream::new(1, [k, 0, 0], Purpose::TEST)
}

fn receivers(scene: &Scene) -> Vec<Vertex> {
    let (w, h) = scene.camera().size;
    let pixels = (0..w * h).map(|i| Vec2::new((i % w) as f32 + 0.5, (i / w) as f32 + 0.5));
    pixels.filter_map(|p| scene.intersect(&scene.camera().ray(p), Mode::Radiance)).filter(Vertex::connects).collect()
}

fn lights(scene: &Scene) -> Vec<Vpl> {
    let keller = Keller { paths: 100, max_edges: None, certain_edges: 1, emission: Emission::Full };
    keller.generate(scene, 0, 1, &mut Probe::default()).expect("the scene has lamps").lights
}

#[test]
fn lights_give_together_what_they_give_alone() {
    for name in ["cornell-box", "kitchen", "ajar", "smoky-room"] {
        let mut scene = our_scene(name, (24, 24));
        let (receivers, lights) = (receivers(&scene), lights(&scene));
        let bounding = &BoundPlan::AUTO.at(&scene, 0, 100);
        let (mut lit, mut dark) = (0, 0);
        // One probe for all, so that what stopped one receiver's rays is tried for the next one's.
        let (mut together, mut alone) = (Probe::default(), Probe::default());
        for (k, receiver) in receivers.iter().enumerate() {
            scene.set_simd(if k % 2 == 0 { Simd::Auto } else { Simd::Portable });
            let (edges_left, edges_least, scene, kernel) = (u32::MAX, 0, &scene, &Points);
            let (probe, alone) = (&mut together, &mut alone);
            let mut out = vec![Spectrum::gray(7.0); lights.len()];
            let mut ask = Gather { scene, receiver, kernel, bounding, edges_left, edges_least, probe };
            ask.contributions(&lights, &mut out, &mut stream(k as u64));
            let mut ask = Gather { probe: alone, ..ask };
            let mut s = stream(k as u64);
            for (light, out) in lights.iter().zip(&out) {
                let c = ask.contribution(light, &mut s);
                assert_eq!(c, *out, "{name}, receiver {k}");
                lit += !c.is_black() as u32;
                dark += c.is_black() as u32;
            }
        }
        assert_eq!((together.shadow_rays, together.evaluations), (alone.shadow_rays, alone.evaluations));
        assert!(lit > 1000 && dark > 1000, "{name}: {lit} lit, {dark} dark");
    }
}

#[test]
fn what_is_left_out_early_is_black() {
    for name in ["cornell-box", "kitchen"] {
        let scene = our_scene(name, (24, 24));
        let (receivers, lights) = (receivers(&scene), lights(&scene));
        let mut s = stream(0);
        let (mut away, mut pairs) = (0, 0);
        for x in receivers.iter().chain(lights.iter().map(|l| &l.vertex)) {
            for k in 0..200 {
                // Of any length, and level with the surface.
                let w = warp::sphere(s.next_2d());
                let n = x.normal().unwrap_or(Vec3::Z);
                let w = if k % 2 == 0 { w } else { (w - n * (n.dot(w) + 1e-6 * s.next_f32())).normalize_or(w) };
                if x.turns_away(w * 10f32.powf(8.0 * s.next_f32() - 4.0)) {
                    assert!(x.eval(w).is_black());
                    away += 1;
                }
            }
        }
        // The formula, in its order.
        for (x, l) in receivers.iter().flat_map(|x| lights.iter().map(move |l| (x, l))) {
            let d = l.vertex.p - x.p;
            let w = d / d.length_squared().sqrt();
            let g = x.cosine(w) * l.vertex.cosine(-w) / d.length_squared();
            let value = x.lobe_at(w) * l.vertex.lobe_at(-w) * l.flux * g;
            let found = connect_vertices(x, &l.vertex, l.flux).map_or(Spectrum::BLACK, |c| c.value);
            assert_eq!(found, value, "{name}");
            pairs += !value.is_black() as u32;
        }
        assert!(away > 10_000 && pairs > 1000, "{name}: {away}, {pairs}");
    }
}

#[test]
fn edges_together_let_through_what_they_do_alone() {
    // To points and to infinity, and such without length.
    let scene = our_scene("ajar", (16, 16));
    let (receivers, mut s) = (receivers(&scene), stream(3));
    let mut probe = Probe::default();
    for x in receivers.windows(2) {
        let mut edges = vec![Edge::Between(x[0].end(), x[0].end()), Edge::Between(x[0].end(), x[1].end())];
        edges.extend((0..30).map(|_| Edge::ToInfinity(x[0].end(), warp::sphere(s.next_2d()))));
        edges.extend((0..30).map(|_| Edge::Between(x[0].end(), receivers[s.next_below(receivers.len())].end())));
        let mut out = vec![Spectrum::gray(7.0); edges.len()];
        scene.transmittances(&edges, &mut out, &mut probe.occluders, &mut s);
        for (edge, out) in edges.iter().zip(out) {
            assert_eq!(scene.transmittance(edge, &mut s), out);
        }
    }
}
