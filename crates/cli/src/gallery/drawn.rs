//! Drawings of the parts themselves.

use super::figures::Drawn;
use crate::failure::Failure;
use manylight_compensation::BoundPlan;
use manylight_framework::{BoundingPlan, Clustered, Gather, Generator, Occlusion, Plan, Probe, VirtualLight};
use manylight_lgh::{Hierarchy, Lattice, weight};
use manylight_light_tree::{LightTree, StochasticLightcuts};
use manylight_math::{Aabb, Ray, Spectrum, Vec2, Vec3};
use manylight_report::{Drawing, Mark};
use manylight_sampling::along::{Angular, Seen};
use manylight_sampling::{Purpose, Stream};
use manylight_scene::{Edge, HenyeyGreenstein, Mode, Scene};
use manylight_scene_io::{LoadOptions, load};
use manylight_volume_lights::VolumeLights;
use manylight_vpl::{Emission, Keller, Points, Vpl};
use std::path::Path;

fn scene(scenes: &Path, name: &str) -> Result<Scene, Failure> {
    let options = LoadOptions { size: Some((64, 64)), ..LoadOptions::default() };
    Ok(load(&scenes.join(name).join("scene.xml"), &options).map_err(Failure::mistake)?.scene)
}

/// Steps of the curves.
const STEPS: usize = 400;

/// The product of 1/d^2 and both phase functions along a ray, and the densities that points are drawn with.
pub fn phase_functions(_: &Path) -> Result<Drawn, Failure> {
    let (mut drawings, mut rows) = (Vec::new(), Vec::new());
    for g in [0.55f32, 0.95] {
        let phase = HenyeyGreenstein::new(g).ok_or_else(|| Failure::Mistake(format!("{g} is no mean cosine")))?;
        let ray = Ray { t_max: 4.0, ..Ray::new(Vec3::ZERO, Vec3::X) };
        // Beside the ray; light came to it at an angle, and the eye is at the ray's beginning.
        let (y, came_from) = (Vec3::new(1.6, 0.5, 0.0), Vec3::new(-0.8, 0.6, 0.0));
        let lobe = |at: &Seen| {
            let w = at.direction.as_vec3();
            f64::from(phase.eval(-ray.dir, -w) * phase.eval(came_from, w))
        };
        let none = || Failure::Mistake("the ray has no length".into());
        let plain = Angular::new(&ray, y.as_dvec3()).ok_or_else(none)?;
        let table = plain.following(lobe, plain.nearest((-came_from).as_dvec3()));
        let (from, to) = plain.angles();
        let at = |k: usize| plain.seen(from + (to - from) * (k as f64 + 0.5) / STEPS as f64);
        // Over the distance t, at points that are even over the angle: dt = d^2 / D dphi.
        let step = |s: &Seen| s.distance * s.distance / plain.distance() * (to - from) / STEPS as f64;
        let target = |s: &Seen| lobe(s) / (s.distance * s.distance);
        let total: f64 = (0..STEPS).map(at).map(|s| target(&s) * step(&s)).sum();
        let pdf = |of: &Angular, s: &Seen| 1.0 / (of.inverse(s.t) * s.distance * s.distance);
        let curve = |name: &str, colour: usize, of: &dyn Fn(&Seen) -> f64| Mark::Line {
            points: (0..STEPS).map(at).map(|s| (s.t, of(&s))).collect(),
            name: name.into(),
            colour,
        };
        let marks = vec![
            curve("what counts, normalised", 0, &|s| target(s) / total),
            curve("drawn by angle", 1, &|s| pdf(&plain, s)),
            curve("drawn by angle and a table", 2, &|s| pdf(&table, s)),
        ];
        let highest = (0..STEPS).map(at).map(|s| (target(&s) / total).max(pdf(&table, &s))).fold(0.0, f64::max);
        // Relative variance of one draw, int p^2 / q - 1.
        let variance = |of: &Angular| {
            (0..STEPS).map(at).map(|s| (target(&s) / total).powi(2) / pdf(of, &s) * step(&s)).sum::<f64>() - 1.0
        };
        rows.push(vec![format!("{g}"), format!("{:.3}", variance(&plain)), format!("{:.4}", variance(&table))]);
        let labels = ("distance along the ray".into(), "density".into());
        let drawing = Drawing { size: (760, 340), labels, x: (0.0, 4.0), y: (0.0, 1.08 * highest), marks };
        drawings.push((drawing, format!("mean cosine g = {g}, the light half a unit beside the ray")));
    }
    let head = ["g", "variance by angle", "by angle and a table"].map(String::from).into();
    Ok((drawings, (head, rows)))
}

/// Lights from above, and the boxes of three cuts.
pub fn light_tree(scenes: &Path) -> Result<Drawn, Failure> {
    let scene = scene(scenes, "cornell-box")?;
    let keller = Keller { paths: 48, max_edges: Some(5), certain_edges: 1, emission: Emission::Full };
    let mut probe = Probe::default();
    let lights = keller.generate(&scene, 0, 1, &mut probe)?.lights;
    let plan = StochasticLightcuts::default();
    let bounding = BoundPlan::NONE.at(&scene, 0, keller.paths);
    let mut s = Stream::new(1, [0; 3], Purpose::BUILD);
    let set = plan.build(lights.clone(), &Clear(scene.bounds()), &mut s)?;
    let tree: &LightTree<Vpl> = set.tree();
    let bounds = scene.bounds();
    // From above, or from where the most is seen: the axis of y is up.
    let plane = |p: Vec3| (f64::from(p.x), f64::from(-p.z));
    let largest = lights.iter().map(VirtualLight::intensity).fold(0.0, f32::max);
    let dots = || Mark::Dots {
        points: lights
            .iter()
            .map(|l| {
                let (x, z) = plane(l.vertex.p);
                (x, z, 1.5 + 6.0 * f64::from(l.intensity() / largest).sqrt())
            })
            .collect(),
        name: String::new(),
        colour: 6,
    };
    let mut drawings = Vec::new();
    let mut rows = Vec::new();
    for (i, (pixel, place)) in [
        ((6.0, 40.0), "on the left wall"),
        ((32.0, 58.0), "on the floor in front"),
        ((58.0, 24.0), "on the right wall"),
    ]
    .into_iter()
    .enumerate()
    {
        let ray = scene.camera().ray(Vec2::new(pixel.0, pixel.1));
        let Some(receiver) = scene.intersect(&ray, Mode::Radiance) else { continue };
        let ask = Gather {
            scene: &scene,
            receiver: &receiver,
            kernel: &Points,
            bounding: &bounding,
            edges_left: u32::MAX,
            edges_least: 0,
            probe: &mut probe,
        };
        let cut = set.cut_nodes(&ask);
        let mut marks = vec![];
        for node in &cut {
            let b = tree.cluster(*node).bounds;
            let ((x0, z0), (x1, z1)) = (plane(b.lo), plane(b.hi));
            // A light alone has no extent: a little square.
            let pad = 0.012 * f64::from(bounds.hi.x - bounds.lo.x);
            marks.push(Mark::Box { low: (x0 - pad, z1.min(z0) - pad), high: (x1 + pad, z0.max(z1) + pad), colour: i });
        }
        marks.push(dots());
        let (x, z) = plane(receiver.p);
        let arm = 0.04 * f64::from(bounds.hi.x - bounds.lo.x);
        for (dx, dz) in [(arm, arm), (arm, -arm)] {
            marks.push(Mark::Line { points: vec![(x - dx, z - dz), (x + dx, z + dz)], name: String::new(), colour: 1 });
        }
        let leaves = cut.iter().filter(|n| tree.children(**n).is_none()).count();
        rows.push(vec![place.into(), cut.len().to_string(), leaves.to_string()]);
        let pad = 0.06 * f64::from((bounds.hi - bounds.lo).max_element());
        let (low, high) = (plane(bounds.lo), plane(bounds.hi));
        let drawing = Drawing {
            size: (380, 380),
            labels: Default::default(),
            x: (low.0 - pad, high.0 + pad),
            y: (high.1.min(low.1) - pad, high.1.max(low.1) + pad),
            marks,
        };
        drawings.push((
            drawing,
            format!("the cut at a point {place}: {} clusters, {leaves} of them single lights", cut.len()),
        ));
    }
    drawings.push((dendrogram(tree), format!("the tree: {} lights, {} levels", tree.lights().len(), tree.depth())));
    let head = ["point", "clusters", "single lights"].map(String::from).into();
    Ok((drawings, (head, rows)))
}

/// Leaves side by side, parents above.
fn dendrogram(tree: &LightTree<Vpl>) -> Drawing {
    let depth = tree.depth() as f64;
    let mut marks = Vec::new();
    let mut next = 0.0;
    /// Where a node is; its subtree is drawn.
    fn draw(tree: &LightTree<Vpl>, node: u32, level: f64, next: &mut f64, marks: &mut Vec<Mark>) -> f64 {
        let Some(children) = tree.children(node) else {
            *next += 1.0;
            return *next - 1.0;
        };
        let [a, b] = children.map(|c| draw(tree, c, level + 1.0, next, marks));
        let x = 0.5 * (a + b);
        for child in [a, b] {
            let points = vec![(x, -level), (child, -level), (child, -level - 1.0)];
            marks.push(Mark::Line { points, name: String::new(), colour: 6 });
        }
        x
    }
    if let Some(root) = tree.root() {
        draw(tree, root, 0.0, &mut next, &mut marks);
    }
    Drawing { size: (1140, 260), labels: Default::default(), x: (-1.0, next), y: (-depth - 0.5, 0.5), marks }
}

/// Nothing stands between: this set asks for no shadows while it is built.
struct Clear(Aabb);
impl Occlusion for Clear {
    fn transmittance(&self, _: &Edge, _: &mut Stream) -> Spectrum {
        Spectrum::ONE
    }
    fn extent(&self) -> Aabb {
        self.0
    }
}

/// The lights of a fire from the side, the averages of each level, and the weights by distance.
pub fn grids(scenes: &Path) -> Result<Drawn, Failure> {
    let scene = scene(scenes, "explosion")?;
    let lights = VolumeLights::new(&scene, 2).map_err(Failure::mistake)?;
    let levels = 5;
    let lattice = Lattice::around(&lights.bounds(), levels);
    let hierarchy = Hierarchy::new(lights.lights().to_vec(), Some(lattice), 2.0)?;
    let plane = |p: Vec3| (f64::from(p.x), f64::from(p.y));
    // Of what is not worth a dot nothing is drawn.
    let bright = |places: Vec<(Vec3, f32)>| -> Vec<(Vec3, f32)> {
        let largest = places.iter().map(|p| p.1).fold(f32::MIN_POSITIVE, f32::max);
        places.into_iter().filter(|p| p.1 > 3e-3 * largest).map(|(p, i)| (p, i / largest)).collect()
    };
    let all = bright(lights.lights().iter().map(|l| (l.position(), l.intensity())).collect());
    let seen = Aabb::around(all.iter().map(|l| l.0));
    let (low, high) = (plane(seen.lo), plane(seen.hi));
    let pad = 0.3 * (high.0 - low.0).max(high.1 - low.1);
    let panel = |places: Vec<(Vec3, f32)>, colour: usize, size: f64| {
        let dot = |(p, part): &(Vec3, f32)| {
            let (x, y) = plane(*p);
            (x, y, 0.7 + size * f64::from(*part).sqrt())
        };
        let marks = vec![Mark::Dots { points: places.iter().map(dot).collect(), name: String::new(), colour }];
        let (x, y) = ((low.0 - pad, high.0 + pad), (low.1 - pad, high.1 + pad));
        let across = 330.0;
        let height = (across * (y.1 - y.0) / (x.1 - x.0)) as u32;
        Drawing { size: (across as u32, height), labels: Default::default(), x, y, marks }
    };
    let mut drawings = vec![(panel(all, 6, 1.5), format!("level 0: {} lights", lights.lights().len()))];
    for level in 1..=levels {
        let made = bright(hierarchy.level(level as usize).map(|(p, l)| (p, l.intensity())).collect());
        let size = 1.5 * f64::from(1 << level).sqrt();
        drawings.push((
            panel(made, level as usize - 1, size),
            format!("level {level}: averages on a grid of {:.2} m", lattice.spacing(level)),
        ));
    }
    let reach = 24.0;
    let radius = |level: u32| f64::from(1u32 << level);
    let marks = (0..=levels)
        .map(|level| Mark::Line {
            points: (0..=STEPS)
                .map(|k| reach * k as f64 / STEPS as f64)
                .map(|d| (d, weight(level, levels, radius(level), d)))
                .collect(),
            name: format!("level {level}"),
            colour: (level as usize + 6) % 7,
        })
        .collect();
    let labels = ("distance, in reaches of level 0".into(), "weight".into());
    let drawing = Drawing { size: (760, 300), labels, x: (0.0, reach), y: (0.0, 1.05), marks };
    drawings.push((drawing, "how much a level counts".into()));
    let row = |(level, size): (usize, &usize)| vec![level.to_string(), size.to_string()];
    let rows = hierarchy.sizes().iter().enumerate().map(row).collect();
    Ok((drawings, (["level", "lights"].map(String::from).into(), rows)))
}
