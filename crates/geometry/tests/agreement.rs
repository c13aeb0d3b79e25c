//! What rays meet: by AVX2, by arrays, and by another tree (of obvhs) with a test in f64.
//!
//! ```text
//! MANYLIGHT_EFFORT=50 cargo test --release -p manylight-geometry --test agreement -- --nocapture      ten million rays
//! ```

use manylight_geometry::{Disk, Geometry, Hit, Occluders, ShapeGeometry, Simd, Sphere, TriangleMesh};
use manylight_math::{Aabb, DVec3, Frame, Ray, Vec3};
use manylight_sampling::{Purpose, Stream, warp};
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;

fn effort(n: usize) -> usize {
    std::env::var("MANYLIGHT_EFFORT").map_or(n, |e| n * e.parse::<usize>().expect("MANYLIGHT_EFFORT is a whole number"))
}

/// Another tree over the triangles of the first shape, and another test.
struct Oracle {
    bvh: Bvh2,
    corners: Vec<[Vec3; 3]>,
}

struct Padded(obvhs::aabb::Aabb);
impl obvhs::Boundable for Padded {
    fn aabb(&self) -> obvhs::aabb::Aabb {
        self.0
    }
}

impl Oracle {
    fn new(mesh: &TriangleMesh) -> Self {
        let corners: Vec<_> = (0..mesh.triangles.len()).map(|t| mesh.corners(t)).collect();
        // Wider than rounding, which decides nothing here: the test does.
        let pad = mesh.bounds().lo.abs().max(mesh.bounds().hi.abs()).max_element() * 1e-5;
        let padded = |c: &[Vec3; 3]| {
            let b = Aabb::around(*c);
            Padded(obvhs::aabb::Aabb::new((b.lo - pad).into(), (b.hi + pad).into()))
        };
        let boxes: Vec<Padded> = corners.iter().map(padded).collect();
        let bvh = build_bvh2(&boxes, obvhs::BvhBuildParams::fast_build(), &mut Default::default());
        Oracle { bvh, corners }
    }
    /// The first hit, and how far from an edge or from being seen edge-on the nearest call was: a share of the triangle.
    fn intersect(&self, ray: &Ray) -> (Option<(f64, u32)>, f64) {
        let (mut best, mut margin) = (None, f64::INFINITY);
        let r = obvhs::ray::Ray::new(ray.origin.into(), ray.dir.into(), 0.0, ray.t_max * 1.00001);
        self.bvh.ray_traverse_anyhit(r, |_, i| {
            let id = self.bvh.primitive_indices[i];
            let (t, near) = test(&self.corners[id as usize], ray);
            margin = margin.min(near);
            if let Some(t) = t.filter(|t| best.is_none_or(|(b, _)| *t < b)) {
                best = Some((t, id));
            }
        });
        (best, margin)
    }
}

/// How well a triangle says where a ray meets it: one if seen from above and as wide as long, zero for slivers and edge-on.
fn condition(c: &[Vec3; 3], ray: &Ray) -> f64 {
    let [a, b, c] = c.map(|p| p.as_dvec3());
    let (e1, e2) = (b - a, c - a);
    let longest = e1.length().max(e2.length()).max((e2 - e1).length());
    (e1.cross(e2).dot(ray.dir.as_dvec3()) / (longest * longest)).abs()
}

/// Möller and Trumbore's test in f64.
fn test(c: &[Vec3; 3], ray: &Ray) -> (Option<f64>, f64) {
    let [a, b, c] = c.map(|p| p.as_dvec3() - ray.origin.as_dvec3());
    let d = ray.dir.as_dvec3();
    let (e1, e2) = (b - a, c - a);
    let p = d.cross(e2);
    let det = e1.dot(p);
    let (u, v) = (-a.dot(p) / det, d.dot((-a).cross(e1)) / det);
    let t = e2.dot((-a).cross(e1)) / det;
    // f32 cannot tell where a ray passes by an edge at less than its own precision: in shares of a triangle seen at a slant.
    let slant = (det / (e1.length() * e2.length()).max(1e-300)).abs();
    let size = (a.length().max(b.length()).max(c.length()) / e1.length().min(e2.length()).max(1e-300)).max(1.0);
    let near = [u.abs(), v.abs(), (1.0 - u - v).abs()].into_iter().fold(f64::INFINITY, f64::min) * slant / size;
    let near = if t * d.length() < 0.0 && t.abs() > 1e-6 * a.length() { f64::INFINITY } else { near };
    let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
    let hit = inside && t > 0.0 && t < ray.t_max as f64;
    (hit.then_some(t), near)
}

/// Triangles of all sizes and shapes in the unit cube, slivers among them, and a grid whose edges rays can be aimed along.
fn rubble(s: &mut Stream, scale: f32, at: Vec3) -> TriangleMesh {
    let mut mesh = TriangleMesh::default();
    let mut add = |corners: [Vec3; 3]| {
        let base = mesh.positions.len() as u32;
        mesh.positions.extend(corners.map(|p| at + p * scale));
        mesh.triangles.push([base, base + 1, base + 2]);
    };
    for i in 0..600 {
        let p = Vec3::new(s.next_f32(), s.next_f32(), s.next_f32());
        let size = 0.3 * (0.02f32).powf(s.next_f32());
        let (e, f) = (warp::sphere(s.next_2d()) * size, warp::sphere(s.next_2d()) * size);
        let f = if i % 5 == 0 { f * 1e-3 } else { f };
        add([p, p + e, p + f]);
    }
    for i in 0..20 {
        for j in 0..20 {
            let p = |i: i32, j: i32| Vec3::new(i as f32 / 20.0, 0.5, j as f32 / 20.0);
            add([p(i, j), p(i + 1, j), p(i, j + 1)]);
            add([p(i + 1, j), p(i + 1, j + 1), p(i, j + 1)]);
        }
    }
    mesh
}

/// Random rays, rays aimed at corners and edges, and such along axes.
fn aimed(s: &mut Stream, mesh: &TriangleMesh, scale: f32, at: Vec3, k: usize) -> Ray {
    let mut point =
        || at + Vec3::new(s.next_f32(), s.next_f32(), s.next_f32()) * (1.5 * scale) - Vec3::splat(0.25 * scale);
    let (from, to) = (point(), point());
    let c = mesh.corners(s.next_below(mesh.triangles.len()));
    let target = match k % 4 {
        0 => to,
        1 => c[s.next_below(3)],
        2 => c[0].lerp(c[1], s.next_f32()),
        _ => (c[0] + c[1] + c[2]) / 3.0,
    };
    if k % 16 == 15 {
        let axis = [Vec3::X, Vec3::Y, Vec3::Z][s.next_below(3)];
        let dir = if s.next_f32() < 0.5 { axis } else { -axis };
        return Ray::new(c[0] - dir * scale, dir);
    }
    let d = target - from;
    let ray = Ray::new(from, d.try_normalize().unwrap_or(Vec3::X));
    if k.is_multiple_of(3) { Ray { t_max: d.length() * (0.5 + s.next_f32()), ..ray } } else { ray }
}

fn bits(h: &Option<Hit>) -> Option<(u32, u32, u32, [u32; 2])> {
    h.map(|h| (h.t.to_bits(), h.shape, h.triangle, [h.barycentrics.x.to_bits(), h.barycentrics.y.to_bits()]))
}

#[test]
fn all_ways_to_trace_a_ray_agree() {
    let scales = [1e-5f32, 1e-3, 1.0, 1e3, 1e5];
    let n = effort(200_000) / (2 * scales.len());
    for scale in scales {
        for far in [0.0, 30.0] {
            let mut s = Stream::new(4, [scale.to_bits() as u64, far as u64, 0], Purpose::TEST);
            let at = Vec3::new(1.0, -0.7, 0.4) * (far * scale);
            let mesh = rubble(&mut s, scale, at);
            let mut geometry = Geometry::build(vec![ShapeGeometry::Mesh(mesh.clone())]).unwrap();
            geometry.validate().unwrap();
            let ShapeGeometry::Mesh(kept) = &geometry.shapes()[0] else { unreachable!() };
            let oracle = Oracle::new(kept);
            let rays: Vec<Ray> = (0..n).map(|k| aimed(&mut s, &mesh, scale, at, k)).collect();
            let auto: Vec<_> = rays.iter().map(|r| (geometry.intersect(r), geometry.occluded(r))).collect();
            geometry.set_simd(Simd::Portable);
            let (mut hits, mut close) = (0, 0);
            for (ray, (hit, occluded)) in rays.iter().zip(&auto) {
                let portable = geometry.intersect(ray);
                assert_eq!(bits(hit), bits(&portable), "{ray:?}");
                assert_eq!(*occluded, geometry.occluded(ray), "{ray:?}");
                assert_eq!(*occluded, hit.is_some(), "{ray:?}");
                if let Some(hit) = hit {
                    // Its end is not part of a ray.
                    let short = Ray { t_max: hit.t, ..*ray };
                    assert!(!geometry.occluded(&short) && geometry.intersect(&short).is_none(), "{ray:?}");
                    assert!(geometry.occluded(&Ray { t_max: hit.t.next_up(), ..*ray }), "{ray:?}");
                }
                let (expected, margin) = oracle.intersect(ray);
                // Where f64 itself comes within f32's precision of an edge, either answer is right.
                if margin < 5e-7 {
                    close += 1;
                    continue;
                }
                assert_eq!(hit.is_some(), expected.is_some(), "{ray:?}: {hit:?}, {expected:?}, margin {margin}");
                if let (Some(hit), Some((t, id))) = (hit, expected) {
                    hits += 1;
                    let error = (hit.t as f64 - t).abs() / (t.abs() + 2.0 * scale as f64 * (1.0 + far as f64));
                    let worst = condition(&oracle.corners[hit.triangle as usize], ray)
                        .min(condition(&oracle.corners[id as usize], ray));
                    // Another triangle is right where it is as near.
                    assert!(
                        error < 4.0 * f32::EPSILON as f64 * (1.0 + 1.0 / worst),
                        "{ray:?}: {hit:?}, t = {t}, triangle {id}"
                    );
                }
            }
            println!("scale {scale}, at {far}: {n} rays, {hits} hits agree, {close} too close to an edge to tell");
            assert!(hits > n / 6 && close < n * 7 / 10);
        }
    }
}

#[test]
fn spheres_discs_and_triangles_share_a_tree() {
    let mut s = Stream::new(5, [0; 3], Purpose::TEST);
    let mut shapes = Vec::new();
    for k in 0..90 {
        let p = Vec3::new(s.next_f32(), s.next_f32(), s.next_f32()) * 4.0;
        shapes.push(match k % 3 {
            0 => ShapeGeometry::Sphere(Sphere::new(p, 0.1 + 0.2 * s.next_f32())),
            1 => ShapeGeometry::Disk(Disk {
                centre: p,
                radius: 0.1 + 0.2 * s.next_f32(),
                frame: Frame::around(warp::sphere(s.next_2d())),
            }),
            _ => {
                let c = [(); 3].map(|_| p + warp::sphere(s.next_2d()) * 0.3);
                ShapeGeometry::Mesh(TriangleMesh {
                    positions: c.to_vec(),
                    triangles: vec![[0, 1, 2]],
                    ..TriangleMesh::default()
                })
            }
        });
    }
    let all = Geometry::build(shapes.clone()).unwrap();
    all.validate().unwrap();
    let alone: Vec<Geometry> = shapes.iter().map(|s| Geometry::build(vec![s.clone()]).unwrap()).collect();
    let mut hits = 0;
    for _ in 0..effort(5_000) {
        let from = Vec3::splat(2.0) + warp::sphere(s.next_2d()) * 4.0;
        let to = Vec3::new(s.next_f32(), s.next_f32(), s.next_f32()) * 4.0;
        let ray = Ray::new(from, (to - from).normalize());
        let nearest = (0..alone.len() as u32)
            .filter_map(|shape| alone[shape as usize].intersect(&ray).map(|h| Hit { shape, ..h }))
            .min_by(|a, b| a.t.total_cmp(&b.t));
        assert_eq!(bits(&all.intersect(&ray)), bits(&nearest));
        // Of all hits, and of those that are let count.
        let mut every = Vec::new();
        all.every(&ray, |h| every.push(h));
        let mut singly = Vec::new();
        (0..alone.len() as u32)
            .for_each(|shape| alone[shape as usize].every(&ray, |h| singly.push(Hit { shape, ..h })));
        every.sort_by(|a, b| a.t.total_cmp(&b.t));
        singly.sort_by(|a, b| a.t.total_cmp(&b.t));
        assert_eq!(every, singly);
        let odd = |h: &Hit| h.shape % 2 == 1;
        // A sphere's second hit is not asked for: one that does not count is passed as a whole.
        let first = (0..alone.len() as u32)
            .filter_map(|shape| alone[shape as usize].intersect(&ray).map(|h| Hit { shape, ..h }))
            .filter(odd)
            .min_by(|a, b| a.t.total_cmp(&b.t));
        assert_eq!(bits(&all.intersect_where(&ray, odd)), bits(&first));
        assert_eq!(all.occluded_where(&ray, odd), first.is_some());
        hits += nearest.is_some() as usize;
    }
    assert!(hits > 500);
}

#[test]
fn rays_that_go_together_are_stopped_as_alone() {
    for scale in [1e-5f32, 1.0, 1e5] {
        let mut s = Stream::new(7, [scale.to_bits() as u64, 0, 0], Purpose::TEST);
        let mesh = rubble(&mut s, scale, Vec3::ZERO);
        let ball = ShapeGeometry::Sphere(Sphere::new(Vec3::splat(0.5 * scale), 0.2 * scale));
        let mut geometry = Geometry::build(vec![ShapeGeometry::Mesh(mesh.clone()), ball]).unwrap();
        // Few ends, so that what stopped a ray is tried for others, whether it stops them or not.
        let ends: Vec<Vec3> = (0..40).map(|_| Vec3::new(s.next_f32(), s.next_f32(), s.next_f32()) * scale).collect();
        let mut occluders = Occluders::new();
        let mut met = 0;
        for k in 0..effort(600) {
            geometry.set_simd(if k % 3 == 0 { Simd::Portable } else { Simd::Auto });
            let n = 1 + s.next_below(64);
            let shared: Vec<Vec3> = (0..n).map(|_| ends[s.next_below(ends.len())]).collect();
            let mut rays: Vec<Ray> = (0..n).map(|i| aimed(&mut s, &mesh, scale, Vec3::ZERO, i)).collect();
            for (ray, end) in rays.iter_mut().zip(&shared) {
                if k % 2 == 0 {
                    let d = ray.origin - *end;
                    *ray = Ray { t_max: d.length(), ..Ray::new(*end, d.normalize()) };
                }
            }
            rays[0].dir = Vec3::NAN;
            let singly = (0..n).fold(0, |bits, i| bits | (geometry.occluded(&rays[i]) as u64) << i);
            assert_eq!(geometry.occluded_of(&rays, &shared, &mut occluders), singly);
            met += singly.count_ones();
        }
        assert!(met > 5000, "{met}");
    }
}

#[test]
fn of_equally_near_hits_the_first_counts_whatever_the_tree() {
    // The same square of two triangles in each of 300 shapes: the tree is as deep as trees get.
    let quad = TriangleMesh::rectangle(&manylight_math::DAffine3::IDENTITY);
    let shapes = vec![ShapeGeometry::Mesh(quad); 300];
    let mut geometry = Geometry::build(shapes).unwrap();
    geometry.validate().unwrap();
    let mut s = Stream::new(6, [0; 3], Purpose::TEST);
    for simd in [Simd::Auto, Simd::Portable] {
        geometry.set_simd(simd);
        for k in 0..400 {
            let x = Vec3::new(2.0 * s.next_f32() - 1.0, 2.0 * s.next_f32() - 1.0, 0.0);
            // On the diagonal both triangles are hit.
            let x = if k % 2 == 0 { Vec3::new(x.x, x.x, 0.0) } else { x };
            let hit = geometry.intersect(&Ray::new(x + Vec3::Z, Vec3::NEG_Z)).unwrap();
            assert_eq!((hit.shape, hit.triangle), (0, if x.y > x.x { 1 } else { 0 }));
            let without = geometry.intersect_where(&Ray::new(x + Vec3::Z, Vec3::NEG_Z), |h| h.shape >= 17).unwrap();
            assert_eq!(without.shape, 17);
        }
    }
}

#[test]
fn bounds_hold_what_they_bound() {
    // A disc that is almost level with an axis reaches further than sqrt(1 - n^2) says in f32.
    for tilt in [1e-5f32, 1e-4, 3e-4, 1e-2] {
        let n = DVec3::new(tilt as f64, 0.0, 1.0).normalize().as_vec3();
        let disk = Disk { centre: Vec3::ZERO, radius: 1e3, frame: Frame::around(n) };
        let geometry = Geometry::build(vec![ShapeGeometry::Disk(disk)]).unwrap();
        let bounds: Aabb = geometry.bounds();
        assert!(bounds.hi.z >= 0.999 * tilt * 1e3 && bounds.lo.z <= -0.999 * tilt * 1e3, "{bounds:?}");
        let rim = disk.centre + (disk.frame.s * 0.999 + disk.frame.t * 0.02) * disk.radius;
        let ray = Ray::new(rim + Vec3::Z, Vec3::NEG_Z);
        assert!(geometry.intersect(&ray).is_some(), "tilt {tilt}");
    }
}
