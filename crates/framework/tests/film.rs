//! The film of one pass: the same whatever the order of its tiles, and honest about samples that are no radiance.

use manylight_framework::{Film, Image, Probe, Scheduler, Sequential, TILE};
use manylight_math::{DAffine3, Spectrum};
use manylight_sampling::{Purpose, Stream};
use manylight_scene::{Camera, Filter, FilterSampler};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

const SIZE: (u32, u32) = (50, 37);

/// Tiles from the last to the first, from the middle outwards, or by chance.
struct InOrder(fn(usize) -> Vec<usize>);
impl Scheduler for InOrder {
    fn run(&self, count: usize, task: &(dyn Fn(usize) + Sync)) {
        (self.0)(count).into_iter().for_each(task);
    }
}
fn shuffled(count: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    let mut s = Stream::new(1, [0; 3], Purpose::TEST);
    (1..count).for_each(|i| order.swap(i, s.next_below(i + 1)));
    order
}
fn fill(
    scheduler: &dyn Scheduler,
    filter: Filter,
    spp: u32,
    radiance: impl Fn(&mut Probe, &mut Stream) -> Spectrum + Sync,
) -> (Image, Probe) {
    let camera = Camera::perspective(DAffine3::IDENTITY, 40.0, SIZE).unwrap();
    let filter = FilterSampler::new(filter);
    let mut film = Film::new(camera, &filter, 7, 3, spp, scheduler);
    let mut probe = Probe::default();
    film.fill(&mut probe, &|_, probe, s| radiance(probe, s));
    (film.image, probe)
}
fn noise(probe: &mut Probe, s: &mut Stream) -> Spectrum {
    probe.shadow_rays += s.next_below(5) as u64;
    let x = s.next_f32();
    probe.note("x", x);
    Spectrum::rgb(x, s.next_f32(), if x > 0.999 { f32::NAN } else { 0.5 })
}

#[test]
fn the_image_and_all_counts_are_the_same_in_any_order_of_the_tiles() {
    let (image, probe) = fill(&Sequential, Filter::Box, 3, noise);
    assert!(probe.non_finite.count > 0, "none to compare");
    for order in [shuffled as fn(usize) -> Vec<usize>, |n| (0..n).rev().collect()] {
        let (other, counted) = fill(&InOrder(order), Filter::Box, 3, noise);
        assert!(image == other);
        assert_eq!((probe.shadow_rays, &probe.non_finite), (counted.shadow_rays, &counted.non_finite));
        assert_eq!(probe.mean("x"), counted.mean("x"), "sums are made in the tiles' order");
    }
}

#[test]
fn each_pixel_has_as_many_samples_as_asked_for_and_is_their_mean() {
    for (spp, expected) in [(0, 1), (1, 1), (5, 5), (64, 64)] {
        let calls = AtomicUsize::new(0);
        let (image, probe) = fill(&Sequential, Filter::Box, spp, |_, _| {
            calls.fetch_add(1, Relaxed);
            Spectrum::rgb(0.25, 1e-30, 3e30)
        });
        assert_eq!(calls.into_inner(), image.pixels.len() * expected);
        assert_eq!(probe.camera_rays as usize, image.pixels.len() * expected);
        assert!(image.pixels.iter().all(|p| *p == Spectrum::rgb(0.25, 1e-30, 3e30)));
    }
    // The mean of the samples of the pixel's own streams.
    let (image, _) = fill(&Sequential, Filter::Box, 4, |_, s| Spectrum::gray(s.next_f32()));
    let at = 11 * SIZE.0 as usize + 23;
    let mean: f64 = (0..4)
        .map(|sample| {
            let mut s = Stream::new(7, [3, at as u64, sample], Purpose::CAMERA);
            s.next_2d(); // the place on the film
            s.next_f32() as f64 / 4.0
        })
        .sum();
    assert_eq!(image.pixels[at].0.x, mean as f32);
}

#[test]
fn a_sample_that_is_no_radiance_is_black_and_reported_with_its_place() {
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1e-9];
    for value in bad {
        // Sample 2 of the pixel (33, 20), and no other: found by its stream.
        let at = 20 * SIZE.0 as usize + 33;
        let mut theirs = Stream::new(7, [3, at as u64, 2], Purpose::CAMERA);
        theirs.next_2d();
        let mark = theirs.next_u64();
        let (image, probe) = fill(&Sequential, Filter::Box, 4, |_, s| {
            let value = if s.next_u64() == mark { value } else { 1.0 };
            Spectrum::rgb(1.0, value, 1.0)
        });
        assert_eq!((probe.non_finite.count, &probe.non_finite.first), (1, &vec![(3, at, 2)]), "{value}");
        for (i, p) in image.pixels.iter().enumerate() {
            assert_eq!(*p, Spectrum::gray(if i == at { 0.75 } else { 1.0 }), "pixel {i}");
        }
    }
}

#[test]
fn lobes_of_a_filter_below_zero_are_no_bad_samples() {
    let (image, probe) = fill(&Sequential, Filter::Lanczos { lobes: 3.0 }, 256, |_, _| Spectrum::ONE);
    assert_eq!(probe.non_finite.count, 0);
    let mean = image.pixels.iter().map(|p| p.0.x as f64).sum::<f64>() / image.pixels.len() as f64;
    assert!((mean - 1.0).abs() < 0.01, "{mean}");
}

#[test]
fn what_is_cancelled_stays_black_and_what_was_done_stays_done() {
    struct Stops(AtomicUsize);
    impl Scheduler for Stops {
        fn run(&self, count: usize, task: &(dyn Fn(usize) + Sync)) {
            (0..count).for_each(task);
        }
        fn cancelled(&self) -> bool {
            self.0.load(Relaxed) > 300
        }
    }
    let stops = Stops(AtomicUsize::new(0));
    let (image, probe) = fill(&stops, Filter::Box, 1, |_, _| {
        stops.0.fetch_add(1, Relaxed);
        Spectrum::ONE
    });
    let lit = |p: &&Spectrum| **p == Spectrum::ONE;
    assert_eq!(image.pixels.iter().filter(lit).count(), 301);
    assert_eq!(probe.camera_rays, 301);
    // The first tile is whole.
    assert!((0..TILE).all(|y| (0..TILE).all(|x| image.pixels[y * SIZE.0 as usize + x] == Spectrum::ONE)));
}
