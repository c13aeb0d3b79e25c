//! Media that emit: closed forms, and grids against quadrature. Fixed seeds.

use manylight_math::{DAffine3, DVec3, Ray, Spectrum, Vec3};
use manylight_media::{
    Glow, Grid, HenyeyGreenstein, Heterogeneous, Homogeneous, Interpolation, Medium, MediumError, Volume, blackbody,
};
use manylight_sampling::{Purpose, Stream};
use manylight_stats::Moments;

const ISO: HenyeyGreenstein = HenyeyGreenstein::ISOTROPIC;

#[test]
fn a_homogeneous_run_emits_its_closed_form() {
    let (sigma, j) = (Spectrum::rgb(0.5, 2.0, 0.0), Spectrum::rgb(3.0, 0.0, 0.0));
    let m = Homogeneous::new(Spectrum::BLACK, sigma, ISO).unwrap().emitting(j).unwrap();
    for t in [1e-6f32, 0.3, 4.0, f32::INFINITY] {
        let expected = 3.0 * (1.0 - (-0.5 * f64::from(t)).exp()) / 0.5;
        let got = m.emitted(t).to_array();
        assert!((f64::from(got[0]) / expected - 1.0).abs() < 1e-3 && got[1..] == [0.0, 0.0], "{t}: {got:?}");
    }
    assert!(Medium::from(m).emits() && !Medium::from(Homogeneous { emission: Spectrum::BLACK, ..m }).emits());
    // An endless clear ray were endlessly bright.
    for bad in [Spectrum::gray(1.0), Spectrum::rgb(-1.0, 0.0, 0.0), Spectrum::rgb(f32::NAN, 0.0, 0.0)] {
        assert_eq!(m.emitting(bad), Err(MediumError::Emission));
    }
}

fn placed(turn: f64) -> DAffine3 {
    DAffine3::from_translation(DVec3::new(-0.4, 0.2, -0.7))
        * DAffine3::from_rotation_y(turn)
        * DAffine3::from_scale(DVec3::new(1.5, 1.0, 2.0))
}
/// Clumps with gaps between them.
fn clumps(seed: u64, channels: Spectrum, turn: f64) -> Grid {
    let size = [11, 9, 19];
    let mut s = Stream::new(seed, [0; 3], Purpose::TEST);
    let value = |s: &mut Stream| if s.next_f32() < 0.5 { 0.0 } else { 4.0 * s.next_f32() };
    let values = (0..size.iter().product::<usize>()).map(|_| channels * value(&mut s)).collect();
    Grid::new(size, values, &placed(turn), Interpolation::Trilinear).unwrap()
}

#[test]
fn a_grid_emits_what_quadrature_says_and_one_that_lets_everything_through_does_not() {
    // Emission where there is no smoke, smoke where there is no emission; grids of different places; colours.
    let smoke = clumps(1, Spectrum::rgb(1.0, 0.4, 0.0), 0.5);
    let glow = Glow::new(clumps(2, Spectrum::rgb(0.1, 2.0, 1.0), -0.2), 3.0).unwrap();
    let m = Heterogeneous::new(smoke, 0.7, Volume::Constant(Spectrum::gray(0.3)), ISO).unwrap().emitting(glow.clone());
    assert!(Medium::from(m.clone()).emits());
    let towards = |a: [f32; 3], b: [f32; 3]| Ray::new(a.into(), (Vec3::from(b) - Vec3::from(a)).normalize());
    let rays = [
        (towards([-2.0, 0.3, -1.0], [0.5, 0.6, 0.5]), 5.0),
        (towards([0.5, 0.5, 0.3], [0.7, 1.5, 0.9]), 0.4),
        (towards([0.2, 3.0, 0.1], [0.4, 0.0, 0.2]), 9.0),
    ];
    for (ray, to) in rays {
        let n = 100_000;
        let dt = to / n as f64;
        let (mut depth, mut truth, mut all) = ([0.0f64; 3], [0.0f64; 3], [0.0f64; 3]);
        for i in 0..n {
            let p = ray.at(((i as f64 + 0.5) * dt) as f32);
            let (t, j) = (m.extinction(p).to_array(), glow.at(p).to_array());
            for c in 0..3 {
                truth[c] += f64::from(j[c]) * (-depth[c] - 0.5 * f64::from(t[c]) * dt).exp() * dt;
                all[c] += f64::from(j[c]) * dt;
                depth[c] += f64::from(t[c]) * dt;
            }
        }
        let mut s = Stream::new(7, [0; 3], Purpose::TEST);
        let mut moments = [Moments::default(); 3];
        let runs = 40_000;
        for _ in 0..runs {
            let got = m.emitted(&ray, 0.0, to as f32, &mut s);
            moments.iter_mut().zip(got.to_array()).for_each(|(m, x)| m.push(f64::from(x)));
        }
        for c in 0..3 {
            let z = (moments[c].mean() - truth[c]) / moments[c].std_error();
            println!("channel {c}: {} by quadrature {}, z = {z:.2}", moments[c].mean(), truth[c]);
            // Nine comparisons at 0.01 together: 3.3 standard errors each.
            assert!(z.abs() < 3.3, "channel {c}: {} against {}", moments[c].mean(), truth[c]);
            // Where smoke is in the way, a medium that let all through would be seen.
            assert!(depth[c] < 0.05 || (all[c] - truth[c]) / moments[c].std_error() > 10.0);
        }
    }
}

#[test]
fn marching_is_nearly_exact_and_hardly_noisy() {
    // Smoke and fire of one place, thin and thick; the same grid serves for both.
    for (scale, may) in [(0.7, 0.01), (8.0, 0.06)] {
        let fire = Glow::new(clumps(2, Spectrum::rgb(0.1, 2.0, 1.0), 0.5), 3.0).unwrap();
        let m =
            Heterogeneous::new(clumps(1, Spectrum::ONE, 0.5), scale, Volume::Constant(Spectrum::BLACK), ISO).unwrap();
        let m = m.emitting(fire);
        let ray =
            Ray::new(Vec3::new(-2.0, 0.3, -1.0), (Vec3::new(0.5, 0.6, 0.5) - Vec3::new(-2.0, 0.3, -1.0)).normalize());
        let mut s = Stream::new(9, [0; 3], Purpose::TEST);
        let mut means = [Moments::default(); 4];
        for _ in 0..20_000 {
            let (e, t) = m.marched(&ray, 0.0, 5.0, &mut s).unwrap();
            let drawn = (m.emitted(&ray, 0.0, 5.0, &mut s), m.transmittance(&ray, 0.0, 5.0, &mut s));
            let all = [e.mean(), drawn.0.mean(), t.mean(), drawn.1.mean()];
            means.iter_mut().zip(all).for_each(|(m, x)| m.push(f64::from(x)));
        }
        let [e, drawn, t, through] = means;
        println!(
            "scale {scale}: {} +- {}, drawn {} +- {}; T {} drawn {}",
            e.mean(),
            e.std_dev(),
            drawn.mean(),
            drawn.std_dev(),
            t.mean(),
            through.mean()
        );
        let near = |a: &Moments, b: &Moments| (a.mean() - b.mean()).abs() < may * b.mean() + 3.0 * b.std_error();
        assert!(near(&e, &drawn) && near(&t, &through), "scale {scale}");
        assert!(e.std_dev() < 0.4 * drawn.std_dev());
    }
    // A grid of another place is not marched.
    let apart = Heterogeneous::new(clumps(1, Spectrum::ONE, 0.5), 1.0, Volume::Constant(Spectrum::ONE), ISO).unwrap();
    let apart = apart.emitting(Glow::new(clumps(2, Spectrum::ONE, -0.2), 1.0).unwrap());
    let mut s = Stream::new(9, [0; 3], Purpose::TEST);
    assert!(apart.marched(&Ray::new(Vec3::ZERO, Vec3::X), 0.0, 1.0, &mut s).is_none());
}

#[test]
fn an_even_grid_is_a_homogeneous_medium() {
    let even =
        |v: f32| Grid::new([2, 2, 2], vec![Spectrum::gray(v); 8], &DAffine3::IDENTITY, Interpolation::Nearest).unwrap();
    let grid = Heterogeneous::new(even(1.0), 1.5, Volume::Constant(Spectrum::gray(0.4)), ISO).unwrap();
    assert!(!Medium::from(grid.clone()).emits());
    let grid = grid.emitting(Glow::new(even(2.0), 0.5).unwrap());
    let same =
        Homogeneous::new(Spectrum::gray(0.6), Spectrum::gray(1.5), ISO).unwrap().emitting(Spectrum::ONE).unwrap();
    let ray = Ray::new(Vec3::new(0.5, 0.5, -1.0), Vec3::Z);
    let mut s = Stream::new(3, [0; 3], Purpose::TEST);
    let m: Moments = (0..20_000).map(|_| f64::from(grid.emitted(&ray, 0.0, 10.0, &mut s).mean())).collect();
    let truth = f64::from(same.emitted(1.0).mean());
    assert!((m.mean() - truth).abs() < 3.0 * m.std_error(), "{} +- {} against {truth}", m.mean(), m.std_error());
    // In pieces, as a path meets it: the part beyond 1.3, seen from there.
    let m: Moments = (0..20_000).map(|_| f64::from(grid.emitted(&ray, 1.3, 10.0, &mut s).mean())).collect();
    let truth = f64::from(same.emitted(0.7).mean());
    assert!((m.mean() - truth).abs() < 3.0 * m.std_error(), "{} +- {} against {truth}", m.mean(), m.std_error());
}

#[test]
fn a_glowing_gas_emits_as_much_as_it_absorbs_of_a_black_body() {
    let kelvins =
        Grid::new([1, 1, 2], [1200.0, 0.0].map(Spectrum::gray).to_vec(), &DAffine3::IDENTITY, Interpolation::Nearest)
            .unwrap();
    let glow = Glow::glowing(&kelvins, |_| Spectrum::gray(0.25), 2.0).unwrap();
    let (lower, upper) = (Vec3::new(0.5, 0.5, 0.2), Vec3::new(0.5, 0.5, 0.8));
    assert!((glow.at(lower).0 - blackbody::radiance(1200.0).0 * 0.5).length() < 1e-6 * glow.at(lower).0.length());
    assert!(glow.at(upper).is_black() && glow.at(Vec3::splat(2.0)).is_black());
    // Half of the unit cube.
    assert!((glow.total().0 * 2.0 - glow.at(lower).0).length() < 1e-6 * glow.at(lower).0.length());
    for scale in [-1.0, f32::NAN, f32::INFINITY] {
        assert!(Glow::new(kelvins.clone(), scale).is_err());
    }
}
