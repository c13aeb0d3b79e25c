//! Points on two segments: densities, what they cancel, and what they integrate to. Fixed seeds.

use manylight_math::{DVec3, Ray, Vec3};
use manylight_sampling::along::{Across, Angular, delta};
use manylight_sampling::{Purpose, Stream};
use manylight_stats::{Moments, chi2_goodness_of_fit};
use manylight_vrl::{Drawn, draw_pair};

fn ray(o: [f64; 3], d: [f64; 3], length: f64) -> Ray {
    let d = DVec3::from(d).normalize().as_vec3();
    Ray { t_max: length as f32, ..Ray::new(DVec3::from(o).as_vec3(), d) }
}
/// Name, camera, light, the integral of 1/w^2 over both (quadrature), largest relative deviation of a sample.
fn cases() -> Vec<(&'static str, Ray, Ray, f64, f64)> {
    let r3 = 3f64.sqrt();
    let x = [1.0, 0.0, 0.0];
    vec![
        ("A", ray([-1., 0., 0.], x, 2.), ray([0., -1., 1.], [0., 1., 0.], 2.), 2.5580414075, 0.08),
        ("B", ray([-1., 0., 0.], x, 2.), ray([0., -1., 0.01], [0., 1., 0.], 2.), 29.6267045223, 0.16),
        ("C", ray([-3., 0., 0.], x, 5.), ray([-0.5, -0.5 * r3, 0.1], [0.5, 0.5 * r3, 0.], 4.), 21.3680021651, 0.5),
        ("D", ray([0.; 3], x, 4.), ray([1., 0.5, 0.], x, 2.), 10.4376969212, 0.2),
        ("E", ray([0.; 3], x, 4.), ray([1., 0.5, 0.], [1., 1e-4, 0.], 2.), 10.4352097603, 0.2),
        ("F", ray([0.; 3], x, 4.), ray([2., 1e-6, 0.], [0., 0., 1.], 3.), 46.481745963, 0.15),
        ("G", ray([0.; 3], x, 4.), ray([2., 1., 0.3], [0.3, 0.4, 1.], 1e-3), 2.0866461e-3, 0.01),
        ("H", ray([0.; 3], x, 4.), ray([-1., -2., 0.2], [0., 1., 0.], 4.), 2.3397378559, 0.55),
    ]
}
fn pair(camera: &Ray, light: &Ray, s: &mut Stream) -> Option<Drawn> {
    draw_pair(camera, light, |along, _| along, [s.next_f64(), s.next_f64()])
}

#[test]
fn the_mean_of_the_cancelled_weight_is_the_integral() {
    for (seed, (name, camera, light, truth, deviation)) in cases().into_iter().enumerate() {
        // Either may be the camera.
        for (order, a, b) in [("", &camera, &light), (" swapped", &light, &camera)] {
            let mut s = Stream::new(1, [seed as u64, 0, 0], Purpose::TEST);
            let m: Moments = (0..200_000).map(|_| pair(a, b, &mut s).unwrap().inverse).collect();
            let relative = m.std_dev() / m.mean();
            println!("{name}{order}: {} (truth {truth}), relative deviation {relative:.3}", m.mean());
            // 16 means: 3.7 standard errors is 0.0034 for all of them. Positions are f32: B lies 0.01 away, and F 1e-6.
            assert!(
                (m.mean() - truth).abs() < 3.7 * m.std_error() + 3e-6 * truth,
                "{name}{order}: {} {truth}",
                m.mean()
            );
            assert!(!order.is_empty() || relative < deviation, "{name}: {relative}");
        }
    }
}

#[test]
fn the_weight_is_one_over_the_square_and_both_densities() {
    for (name, camera, light, _, _) in cases() {
        let mut s = Stream::new(2, [0; 3], Purpose::TEST);
        let mut worst = 0.0f64;
        for _ in 0..20_000 {
            let Drawn { u, v, inverse } = pair(&camera, &light, &mut s).unwrap();
            let across = Across::new(&light, &camera).unwrap();
            let at = |r: &Ray, t: f64| r.origin.as_dvec3() + r.dir.as_dvec3().normalize() * t;
            // The kernel's own point is along the f32 direction, whose length is one within rounding.
            let y = light.origin.as_dvec3() + light.dir.as_dvec3() * v;
            let w2 = (at(&camera, u) - y).length_squared();
            let naive = 1.0 / (w2 * across.pdf(v) * Angular::new(&camera, y).unwrap().pdf(u));
            worst = worst.max((inverse / naive - 1.0).abs());
        }
        println!("{name}: {worst:.1e}");
        // F: the foot is 1e-6 m away, and u counts metres.
        let limit = if name == "F" { 1e-6 } else { 1e-9 };
        assert!(worst < limit, "{name}: {worst}");
    }
}

type Of = Box<dyn Fn(f64) -> f64>;

#[test]
fn densities_integrate_to_one_and_are_those_of_the_draws() {
    for (i, (name, camera, light, _, _)) in cases().into_iter().enumerate() {
        let across = Across::new(&light, &camera).unwrap();
        let y = light.origin.as_dvec3() + light.dir.as_dvec3() * (0.3 * f64::from(light.t_max));
        let along = Angular::new(&camera, y).unwrap();
        let peaked = along.following(|at| (4.0 * at.direction.x).cos() + 1.1, 0.0);
        let draws: [(&str, f64, Of, Of); 3] = [
            ("across", light.t_max as f64, Box::new(move |u| across.sample(u)), Box::new(move |t| across.pdf(t))),
            ("along", camera.t_max as f64, Box::new(move |u| along.sample(u).t), Box::new(move |t| along.pdf(t))),
            ("table", camera.t_max as f64, Box::new(move |u| peaked.sample(u).t), Box::new(move |t| peaked.pdf(t))),
        ];
        for (k, (what, length, sample, pdf)) in draws.into_iter().enumerate() {
            // Bins from the quantiles of the draws themselves, so that peaks are resolved; the mass of each by quadrature.
            const BINS: usize = 40;
            let mut edges: Vec<f64> = (1..BINS).map(|b| sample(b as f64 / BINS as f64)).collect();
            edges.extend([0.0, length]);
            edges.sort_by(f64::total_cmp);
            let masses: Vec<f64> = edges
                .windows(2)
                .map(|e| {
                    let n = 2000;
                    (0..n).map(|j| pdf(e[0] + (e[1] - e[0]) * (j as f64 + 0.5) / n as f64)).sum::<f64>() * (e[1] - e[0])
                        / n as f64
                })
                .collect();
            let total: f64 = masses.iter().sum();
            assert!((total - 1.0).abs() < 2e-3, "{name} {what}: {total}");
            let mut s = Stream::new(3, [i as u64, k as u64, 0], Purpose::TEST);
            let mut counts = [0u64; BINS];
            let n = 100_000;
            for _ in 0..n {
                let t = sample(s.next_f64());
                assert!((0.0..=length).contains(&t));
                counts[(edges.partition_point(|e| *e <= t).max(1) - 1).min(BINS - 1)] += 1;
            }
            let expected: Vec<f64> = masses.iter().map(|m| m / total * n as f64).collect();
            let p = chi2_goodness_of_fit(&counts, &expected, 0).p_value;
            assert!(p > 0.01 / 24.0, "{name} {what}: p = {p}");
        }
    }
}

#[test]
fn the_difference_of_area_sines_keeps_its_digits() {
    // Against asinh in the naive form where that is exact, and against its limits where it is not.
    for (h, g0, g1) in [(1.0, -2.0, 3.0), (0.3, 0.5, 4.0), (2.0, -7.0, -0.1)] {
        let naive = f64::asinh(g1 / h) - f64::asinh(g0 / h);
        assert!((delta(h, g0, g1) - naive).abs() < 1e-13 * naive, "{h} {g0} {g1}");
    }
    // Near and far: Delta A = ln(g1 / g0) for h -> 0, (g1 - g0) / D for short ones.
    assert!((delta(1e-12, 1.0, 2.0) - 2f64.ln()).abs() < 1e-15);
    assert!((delta(1e-12, -2.0, -1.0) - 2f64.ln()).abs() < 1e-15);
    let short = delta(1.0, 1e6, 1e6 + 1e-3) / (1e-3 / 1e6f64.hypot(1.0));
    assert!((short - 1.0).abs() < 1e-6, "{short}");
}

#[test]
fn lengths_do_not_matter_and_nothing_is_not_a_number() {
    let mut s = Stream::new(5, [0; 3], Purpose::TEST);
    let coordinate = |s: &mut Stream| match s.next_below(4) {
        0 => 0.0,
        1 => 1.0,
        _ => (s.next_f32() - 0.5) * 10f32.powi(s.next_below(7) as i32 - 3),
    };
    let (mut none, n) = (0, 200_000);
    for i in 0..n {
        let mut vector = || Vec3::new(coordinate(&mut s), coordinate(&mut s), coordinate(&mut s));
        let (o, p) = (vector(), vector());
        let (Some(d), Some(e)) = (vector().try_normalize(), vector().try_normalize()) else { continue };
        // Parallel, opposite, touching and coincident ones among them.
        let e = [e, d, -d, e][i % 4];
        let p = [p, p, o, o + d * 0.5][i / 4 % 4];
        let (camera, light) =
            (Ray { t_max: [1.0, 100.0, f32::INFINITY][i % 3], ..Ray::new(o, d) }, Ray { t_max: 2.0, ..Ray::new(p, e) });
        match pair(&camera, &light, &mut s) {
            Some(Drawn { u, v, inverse }) => {
                assert!(u >= 0.0 && u <= f64::from(camera.t_max) && (0.0..=2.0).contains(&v), "{camera:?} {light:?}");
                assert!(inverse > 0.0 && inverse.is_finite(), "{camera:?} {light:?}: {inverse}");
            }
            None => none += 1,
        }
    }
    println!("{none} of {n} without a pair");
    assert!(none < n / 20);
    // I(k x) = I.
    let (_, camera, light, _, _) = cases()[2];
    let scaled = |r: &Ray| Ray { t_max: r.t_max * 1024.0, origin: r.origin * 1024.0, ..*r };
    let (a, b) = (Stream::new(1, [0; 3], Purpose::TEST), Stream::new(1, [0; 3], Purpose::TEST));
    let (mut a, mut b) = (a, b);
    for _ in 0..1000 {
        let (x, y) = (pair(&camera, &light, &mut a).unwrap(), pair(&scaled(&camera), &scaled(&light), &mut b).unwrap());
        assert!((x.inverse / y.inverse - 1.0).abs() < 1e-12);
    }
}
