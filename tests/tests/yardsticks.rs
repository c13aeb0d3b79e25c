//! Light tracing and bidirectional path tracing: every strategy alone, all together, and against what virtual lights bring.
//!
//! Family-wise significance 0.01 by Holm within each verdict; seeds are fixed.

use manylight_geometry::{ShapeGeometry, TriangleMesh};
use manylight_integration::rooms::{built, camera, diffuse, furnace, hollow_ball, hollow_cube, place};
use manylight_integration::{
    block_runs, blocks, effort, load_scene, our_scene, pass, recipe, reference_blocks, shared,
};
use manylight_math::{DAffine3, DVec3, Spectrum, Vec3};
use manylight_reference::{BidirectionalPathTracer, Combine, PathTracer};
use manylight_scene::{Camera, Emitter, Scene, Spot};
use manylight_stats::{BlockTest, Reference, Runs, Verdict};

fn verdict(a: &Runs, reference: Reference) -> Verdict {
    BlockTest::default().run(a, reference).unwrap()
}
fn alone(s: u32, t: u32) -> BidirectionalPathTracer {
    BidirectionalPathTracer { certain_edges: 99, combine: Combine::Alone(s, t), ..Default::default() }
}
/// A plate in the middle of a room, and a camera that sees the plate alone: what lights it lies on walls, at a distance.
fn plate(emitter: Emitter, eye: Camera) -> Scene {
    let mut b = Scene::builder();
    let (walls, white) = (diffuse(&mut b, Spectrum::rgb(0.7, 0.5, 0.3)), diffuse(&mut b, Spectrum::gray(0.8)));
    place(&mut b, hollow_cube(1.0), walls, None);
    let plate = TriangleMesh::rectangle(&DAffine3::from_scale(DVec3::splat(0.4)));
    place(&mut b, ShapeGeometry::Mesh(plate), white, None);
    b.emitter(emitter);
    b.camera(eye);
    built(b)
}
/// Lights below the plate, which has no direct light, and cameras of each kind.
fn plates() -> [(&'static str, Scene); 3] {
    let (eye, size) = (DVec3::new(0.2, 0.1, 0.9), (8, 8));
    let position = Vec3::new(0.5, -0.4, -0.5);
    let point = Emitter::Point { position, intensity: Spectrum::ONE };
    let spot = Spot::new(Vec3::new(0.5, -0.3, 0.8).normalize(), 0.7, 0.4).unwrap();
    let spot = Emitter::Spot { position, intensity: Spectrum::ONE, spot };
    let pinhole = camera(eye, DVec3::ZERO, 20.0, size);
    // Out of focus, but no wider than the plate.
    let lens = camera(eye, DVec3::ZERO, 12.0, size).with_lens(0.08, 0.6).unwrap();
    // Turned round: it looks along -z.
    let turned = DAffine3::from_translation(DVec3::new(0.05, 0.02, 0.9))
        * DAffine3::from_rotation_y(std::f64::consts::PI)
        * DAffine3::from_scale(DVec3::new(0.3, 0.2, 1.0));
    let parallel = Camera::orthographic(turned, size).unwrap();
    [
        ("a point and a pinhole", plate(point, pinhole)),
        ("a spot and a lens", plate(spot.clone(), lens)),
        ("a spot and parallel rays", plate(spot, parallel)),
    ]
}

#[test]
fn every_strategy_alone_integrates_to_the_same() {
    // Radiance after k edges is 0.5^(k - 1), whoever finds it.
    let scene = furnace(hollow_ball(1.0), 1.0, Spectrum::gray(0.5), Spectrum::ONE, (8, 8));
    for edges in 2..=3u32 {
        for s in 0..=edges {
            let runs = block_runs(&scene, &alone(s, edges + 1 - s), 4, 7, effort(48), 1);
            let v = verdict(&runs, Reference::Exact(&[0.5f64.powi(edges as i32 - 1); 3]));
            println!("{edges} edges, {s} vertices from the light: {v}");
            assert!(v.passes(), "{edges} edges, s = {s}: {v}");
        }
    }
}

#[test]
fn instant_radiosity_is_the_strategy_with_two_eye_vertices() {
    for (name, scene) in plates() {
        for edges in 3..=if name.contains("pinhole") { 5 } else { 3 } {
            let lengths = [format!("min-depth={edges}"), format!("max-depth={edges}")];
            let ir = recipe("instant-radiosity", &["bound=none", "paths=1024", &lengths[0], &lengths[1]], &scene);
            let ours = BidirectionalPathTracer { max_edges: edges, ..alone(edges - 1, 2) };
            let ours = block_runs(&scene, &ours, 64, 8, effort(64), 2);
            let v = verdict(&block_runs(&scene, &*ir.method, 1, 9, effort(64), 2), Reference::Runs(&ours));
            println!("{name}, {edges} edges: {v}");
            assert!(v.passes(), "{name}, {edges} edges: {v}");
            // Nor do they agree by doing nothing: a path tracer finds the same light, and so does what light paths leave on the film.
            let path = PathTracer { min_edges: edges, max_edges: edges, ..PathTracer::default() };
            let v = verdict(&block_runs(&scene, &path, 16, 10, effort(64), 2), Reference::Runs(&ours));
            assert!(v.passes(), "{name}, {edges} edges, path tracing: {v}");
            if edges > 3 {
                continue;
            }
            for (what, combine) in
                [("seen from the camera", Combine::Alone(3, 1)), ("all strategies", Combine::Balance)]
            {
                let all = BidirectionalPathTracer { min_edges: 3, max_edges: 3, combine, ..Default::default() };
                let v = verdict(&block_runs(&scene, &all, 64, 11, effort(64), 2), Reference::Runs(&ours));
                println!("{name}, {what}: {v}");
                assert!(v.passes(), "{name}, {what}: {v}");
            }
        }
    }
}

#[test]
fn all_strategies_together_are_the_path_tracer() {
    for (name, size, grid) in [("cornell-box", (16, 16), 2), ("ajar", (16, 10), 1), ("corner", (16, 16), 2)] {
        let scene = our_scene(name, size);
        let path = recipe("path", &[], &scene);
        let truth = block_runs(&scene, &*path.method, 96, 5, effort(32), grid).with_mean();
        for (method, heuristic) in [("bidirectional", "balance"), ("bidirectional", "power"), ("light-tracing", "")] {
            let params = format!("heuristic={heuristic}");
            let given: Vec<&str> = if heuristic.is_empty() { vec![] } else { vec![&params] };
            let r = recipe(method, &given, &scene);
            let v =
                verdict(&block_runs(&scene, &*r.method, 8, 6, effort(48), grid).with_mean(), Reference::Runs(&truth));
            println!("{name}, {method} {heuristic}: {v}");
            assert!(v.passes(), "{name}, {method} {heuristic}: {v}");
        }
    }
}

#[test]
fn direct_light_counted_twice_is_caught() {
    let scene = our_scene("cornell-box", (16, 16));
    let path = recipe("path", &[], &scene);
    let truth = block_runs(&scene, &*path.method, 96, 5, effort(32), 1);
    let honest = BidirectionalPathTracer { max_edges: scene.max_depth().unwrap_or(u32::MAX), ..Default::default() };
    let runs = block_runs(&scene, &honest, 16, 6, effort(48), 1);
    assert!(verdict(&runs, Reference::Runs(&truth)).passes());
    // Next-event estimation once more, on top of all others.
    let direct = block_runs(&scene, &alone(1, 2), 16, 6, effort(48), 1);
    let twice = runs.rows().iter().zip(direct.rows()).map(|(a, b)| a.iter().zip(b).map(|(a, b)| a + b).collect());
    let v = verdict(&Runs::new(twice.collect()).unwrap(), Reference::Runs(&truth));
    assert!(v.rejected(), "{v}");
}

#[test]
fn bidirectional_path_tracing_agrees_with_mitsuba() {
    let (Some(scenes), Some(references)) = (shared("scenes"), shared("references")) else { return };
    let scene = load_scene(&scenes.join("veach-ajar").join("scene.xml"), (320, 180));
    let r = recipe("bidirectional", &[], &scene);
    let runs = block_runs(&scene, &*r.method, 1, 31, effort(6), 2);
    let (mean, std_error) = reference_blocks(&references.join("veach-ajar.exr"), 2);
    let v = verdict(&runs, Reference::Estimate { mean: &mean, std_error: &std_error, degrees: f64::INFINITY });
    println!("veach-ajar: {v}");
    assert!(v.passes(), "{v}");
}

#[test]
fn a_pass_is_the_same_whoever_renders_it() {
    let scene = our_scene("cornell-box", (40, 24));
    let r = recipe("bidirectional", &[], &scene);
    let one = pass(&scene, &*r.method, 2, 3, 1).0;
    assert_eq!(one, pass(&scene, &*r.method, 2, 3, 1).0);
    assert!(blocks(&one, 1)[0] > 0.0);
}
