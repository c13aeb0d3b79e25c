//! Rays per second against Embree 4, in one process and by turns, so that a busy machine slows both.
//!
//! ```text
//! EMBREE4_LIB=/path/to/libembree4.so cargo bench -p manylight-embree --profile fast
//! ```
//!
//! Each figure is the median over turns of a millisecond of the ratio within the turn: rays per second of ours over Embree's, so that above
//! one ours is faster. Without `EMBREE4_LIB` our own figures are printed alone.

use manylight_embree::rays::{RayKinds, sphere_in_a_room};
use manylight_embree::{Embree, Mode, Scene};
use manylight_geometry::{Geometry, ShapeGeometry, Simd, TriangleMesh};
use manylight_math::Ray;
use std::hint::black_box;
use std::time::Instant;

fn seconds(f: impl FnOnce() -> usize) -> f64 {
    let start = Instant::now();
    black_box(f());
    start.elapsed().as_secs_f64()
}

fn median(mut x: Vec<f64>) -> f64 {
    x.sort_by(f64::total_cmp);
    x[x.len() / 2]
}

/// One way to trace the rays of one kind.
type Tracer<'a> = (&'static str, Box<dyn Fn(&[Ray]) -> usize + 'a>);

fn closest(geometry: &Geometry) -> impl Fn(&[Ray]) -> usize {
    |rays| rays.iter().filter(|r| geometry.intersect(r).is_some()).count()
}
fn any(geometry: &Geometry) -> impl Fn(&[Ray]) -> usize {
    |rays| rays.iter().filter(|r| geometry.occluded(r)).count()
}
fn embree_closest<'a>(scene: &'a Scene) -> impl Fn(&[Ray]) -> usize + 'a {
    |rays| rays.iter().filter(|r| scene.intersect(r.origin.to_array(), r.dir.to_array(), r.t_max).is_some()).count()
}
fn embree_any<'a>(scene: &'a Scene) -> impl Fn(&[Ray]) -> usize + 'a {
    |rays| rays.iter().filter(|r| scene.occluded(r.origin.to_array(), r.dir.to_array(), r.t_max)).count()
}
fn embree_packets<'a>(scene: &'a Scene) -> impl Fn(&[Ray]) -> usize + 'a {
    |rays| {
        let packet = |eight: &[Ray]| {
            let eight: Vec<_> = eight.iter().map(|r| (r.origin.to_array(), r.dir.to_array(), r.t_max)).collect();
            scene.occluded8(&eight).count_ones() as usize
        };
        rays.chunks(8).map(packet).sum()
    }
}

/// Rays that one takes before the next has its turn: about a millisecond, so that what else the machine does slows few turns,
/// and those of all alike.
const TURN: usize = 4096;

/// Prints how fast the first is, and how much faster than each other.
fn compare(kind: &str, rays: &[Ray], rounds: usize, tracers: &[Tracer]) {
    let turns = |_| rays.chunks(TURN).filter(|c| c.len() == TURN.min(rays.len()));
    let times: Vec<Vec<f64>> = (0..rounds)
        .flat_map(turns)
        .map(|rays| tracers.iter().map(|(_, trace)| seconds(|| trace(rays))).collect())
        .collect();
    let speed = TURN.min(rays.len()) as f64 / median(times.iter().map(|t| t[0]).collect());
    print!("  {kind:12} {:6.2} M rays/s", speed * 1e-6);
    for (k, (name, _)) in tracers.iter().enumerate().skip(1) {
        print!("; {:.2} of {name}", median(times.iter().map(|t| t[k] / t[0]).collect()));
    }
    println!();
}

fn run(rows: u32, side: u32, rounds: usize, embree: Option<&Embree>) {
    let shapes = sphere_in_a_room(rows);
    let start = Instant::now();
    let ours = Geometry::build(shapes.clone()).expect("the mesh is sound");
    let built = start.elapsed().as_secs_f64();
    let mut portable = Geometry::build(shapes).expect("the mesh is sound");
    portable.set_simd(Simd::Portable);
    let n = ours.primitive_count();
    println!("{n} triangles: built in {built:.2} s, {:.0} bytes each", ours.bytes() as f64 / n as f64);
    let kinds = RayKinds::new(&ours, side);
    let (vertices, triangles) = soup(&ours);
    let scenes = embree.map(|e| {
        let start = Instant::now();
        let fast = e.scene(&vertices, &triangles, Mode::Fast);
        println!("  Embree built one in {:.2} s", start.elapsed().as_secs_f64());
        (fast, e.scene(&vertices, &triangles, Mode::Robust))
    });
    for (kind, rays, shadow) in kinds.all() {
        let mut tracers: Vec<Tracer> = Vec::new();
        if shadow {
            tracers.push(("ours", Box::new(any(&ours))));
            tracers.push(("portable", Box::new(any(&portable))));
        } else {
            tracers.push(("ours", Box::new(closest(&ours))));
            tracers.push(("portable", Box::new(closest(&portable))));
        }
        if let Some((fast, robust)) = &scenes {
            if shadow {
                tracers.push(("Embree robust", Box::new(embree_any(robust))));
                tracers.push(("Embree fast", Box::new(embree_any(fast))));
                tracers.push(("its packets of 8", Box::new(embree_packets(fast))));
            } else {
                tracers.push(("Embree robust", Box::new(embree_closest(robust))));
                tracers.push(("Embree fast", Box::new(embree_closest(fast))));
            }
        }
        // All of them agree, but for what starts or ends on an edge; Embree's fast mode lets rays through more of them.
        let counts: Vec<usize> = tracers.iter().map(|(_, trace)| trace(rays)).collect();
        let spread = counts.iter().max().unwrap_or(&0) - counts.iter().min().unwrap_or(&0);
        assert!(counts[0] == counts[1] && spread <= 1 + rays.len() / 1000, "{kind}: {counts:?}");
        compare(kind, rays, rounds, &tracers);
    }
}

/// All triangles over vertices of their own meshes.
fn soup(geometry: &Geometry) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    let meshes = geometry.shapes().iter().filter_map(|s| match s {
        ShapeGeometry::Mesh(mesh) => Some(mesh),
        _ => None,
    });
    for TriangleMesh { positions, triangles: t, .. } in meshes {
        let base = vertices.len() as u32;
        vertices.extend(positions.iter().map(|p| p.to_array()));
        triangles.extend(t.iter().map(|t| t.map(|v| v + base)));
    }
    (vertices, triangles)
}

fn main() {
    let measure = std::env::args().any(|a| a == "--bench");
    let embree = match std::env::var_os("EMBREE4_LIB") {
        None => {
            println!("no comparison with Embree: EMBREE4_LIB names no libembree4.so");
            None
        }
        Some(path) => Some(Embree::open(path.as_ref()).unwrap_or_else(|e| panic!("EMBREE4_LIB: {e}"))),
    };
    if measure {
        run(224, 256, 31, embree.as_ref());
        run(708, 256, 31, embree.as_ref());
    } else {
        run(16, 16, 1, embree.as_ref());
    }
}
