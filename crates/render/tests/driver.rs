//! The driver with toy methods: when it stops, what it keeps, and that threads do not matter.

use manylight_framework::{Claim, Film, Image, Method, PassError, Probe, Promise};
use manylight_math::{DAffine3, Spectrum};
use manylight_render::{
    Accumulator, Budget, Observer, Progress, RenderError, Rendering, SampleAt, Session, Settings, Stats, Subject,
    render,
};
use manylight_scene::{Camera, Scene};
use std::sync::Arc;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::Duration;

const SIZE: (u32, u32) = (40, 23);

fn scene() -> Scene {
    let mut builder = Scene::builder();
    builder.camera(Camera::perspective(DAffine3::IDENTITY, 40.0, SIZE).unwrap());
    builder.build().unwrap()
}

/// One plus noise; each sample draws a number of times that depends on it, so that tiles end in another order each time.
struct Noise;
impl Promise for Noise {
    fn claim(&self) -> Claim {
        Claim::UNBIASED
    }
}
impl Method for Noise {
    fn pass(&self, _: &Scene, film: &mut Film, probe: &mut Probe) -> Result<(), PassError> {
        film.fill(probe, &|_, probe, s| {
            probe.shadow_rays += 2;
            let draws = 1 + s.next_below(50);
            Spectrum::gray((0..draws).map(|_| s.next_f32()).sum::<f32>() / draws as f32 + 0.5)
        });
        Ok(())
    }
}

/// A method made of a closure.
struct Toy<F>(F);
impl<F> Promise for Toy<F> {
    fn claim(&self) -> Claim {
        Claim::EXACT
    }
}
impl<F: Fn(&mut Film, &mut Probe) -> Result<(), PassError> + Send + Sync> Method for Toy<F> {
    fn pass(&self, _: &Scene, film: &mut Film, probe: &mut Probe) -> Result<(), PassError> {
        (self.0)(film, probe)
    }
}

fn settings(budget: Budget) -> Settings {
    Settings { budget, seed: 5, spp: 2, threads: Some(2) }
}
fn run(method: &dyn Method, settings: &Settings) -> Rendering {
    render(&scene(), method, settings, &mut |_: &Progress| (), &Arc::default()).unwrap()
}
/// FNV-1a over the bits of the image.
fn hash(image: &Image) -> u64 {
    let bits = image.pixels.iter().flat_map(|p| p.to_array()).flat_map(|x| x.to_bits().to_le_bytes());
    bits.fold(0xcbf2_9ce4_8422_2325, |h, byte| (h ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

#[test]
fn so_many_passes_are_rendered_and_the_observer_hears_of_each() {
    let mut heard = Vec::new();
    let method: &dyn Method = &Noise;
    let settings = settings(Budget::Passes(4));
    let rendering = render(&scene(), method, &settings, &mut |p: &Progress| heard.push(*p), &Arc::default()).unwrap();
    assert_eq!((rendering.passes, rendering.interrupted), (4, false));
    assert_eq!(heard.iter().map(|p| p.passes).collect::<Vec<_>>(), [1, 2, 3, 4]);
    assert!(heard.windows(2).all(|pair| pair[0].elapsed < pair[1].elapsed && pair[0].rays < pair[1].rays));
    assert!(heard[0].estimated_error.is_none());
    assert_eq!(heard[3].estimated_error, rendering.estimated_error);
    let samples = u64::from(SIZE.0 * SIZE.1) * 2 * 4;
    assert_eq!((rendering.probe.camera_rays, rendering.probe.shadow_rays), (samples, 2 * samples));
    assert_eq!(heard[3].rays, 3 * samples);
}
#[test]
fn the_observer_hears_of_tiles_while_a_pass_is_running() {
    #[derive(Default)]
    struct Heard {
        tiles: Vec<(usize, usize)>,
        passes: u64,
    }
    impl Observer for Heard {
        fn after_pass(&mut self, progress: &Progress) {
            self.passes = progress.passes;
        }
        fn during_pass(&mut self, done: usize, tasks: usize) {
            self.tiles.push((done, tasks));
        }
    }
    let mut heard = Heard::default();
    let one_thread = Settings { threads: Some(1), ..settings(Budget::Passes(2)) };
    render(&scene(), &Noise, &one_thread, &mut heard, &Arc::default()).unwrap();
    // 40 x 23 pixels are 3 x 2 tiles.
    let pass = (1..=6).map(|done| (done, 6));
    assert_eq!(heard.tiles, pass.clone().chain(pass).collect::<Vec<_>>());
    assert_eq!(heard.passes, 2);
}
#[test]
fn the_image_is_the_mean_of_the_passes_and_each_pass_is_fresh() {
    let passes = Mutex::new(Vec::new());
    let keep = Toy(|film: &mut Film, probe: &mut Probe| {
        Noise.pass(&scene(), film, probe)?;
        passes.lock().unwrap().push(film.image.clone());
        Ok(())
    });
    let rendering = run(&keep, &settings(Budget::Passes(3)));
    let passes = passes.lock().unwrap();
    let mut mean = Accumulator::new(SIZE.0 as usize, SIZE.1 as usize);
    passes.iter().for_each(|pass| mean.add(pass).unwrap());
    assert!(passes[0] != passes[1] && passes[1] != passes[2]);
    assert_eq!(rendering.image, mean.mean());
    assert_eq!(rendering.standard_error, mean.standard_error());
}
#[test]
fn what_a_method_notes_becomes_a_map_of_means() {
    // Half the samples note the ray's direction; the left column nothing.
    let note = Toy(|film: &mut Film, probe: &mut Probe| {
        let pass = film.pass as f32;
        film.fill(probe, &|ray, probe, s| {
            if ray.dir.x < 0.0 {
                probe.note("east", 1.0 + pass);
                probe.note("where", s.next_f32());
            }
            Spectrum::BLACK
        });
        Ok(())
    });
    let with = |threads| run(&note, &Settings { threads: Some(threads), ..settings(Budget::Passes(3)) });
    let (one, seven) = (with(1), with(7));
    assert_eq!(one.maps, seven.maps);
    let names: Vec<&str> = one.maps.iter().map(|m| m.0.as_str()).collect();
    assert_eq!(names, ["east", "where"]);
    let (width, east) = (SIZE.0 as usize, &one.maps[0].1);
    let half = |first: bool| {
        east.iter().enumerate().filter(move |(i, _)| (i % width < 18) == first && !(18..22).contains(&(i % width)))
    };
    let (a, b) = (half(true).map(|v| *v.1).collect::<Vec<_>>(), half(false).map(|v| *v.1).collect::<Vec<_>>());
    let (noted, silent) = if a[0] > 0.0 { (a, b) } else { (b, a) };
    assert!(noted.iter().all(|v| *v == 2.0) && silent.iter().all(|v| *v == 0.0));
    assert_eq!(one.probe.mean("east"), Some(2.0));
    assert!(run(&Noise, &settings(Budget::Passes(1))).maps.is_empty());
}
#[test]
fn one_hash_for_1_2_and_7_threads() {
    let with = |threads| run(&Noise, &Settings { threads: Some(threads), ..settings(Budget::Passes(3)) });
    let [one, two, seven] = [1, 2, 7].map(with);
    for other in [&two, &seven] {
        assert_eq!(hash(&one.image), hash(&other.image));
        assert_eq!(one.standard_error, other.standard_error);
        assert_eq!(one.estimated_error, other.estimated_error);
        assert_eq!(one.probe.shadow_rays, other.probe.shadow_rays);
    }
    let reseeded = run(&Noise, &Settings { seed: 6, ..settings(Budget::Passes(3)) });
    assert_ne!(hash(&one.image), hash(&reseeded.image));
}
#[test]
fn a_run_has_as_many_threads_as_asked_for() {
    let count = Toy(|film: &mut Film, _: &mut Probe| {
        film.image.pixels[0] = Spectrum::gray(rayon::current_num_threads() as f32);
        Ok(())
    });
    let rendering = run(&count, &Settings { threads: Some(3), ..settings(Budget::Passes(1)) });
    assert_eq!(rendering.image.pixels[0], Spectrum::gray(3.0));
}
#[test]
fn a_time_too_short_still_renders_two_passes_and_the_true_time_is_told() {
    let slow = Toy(|_: &mut Film, _: &mut Probe| {
        std::thread::sleep(Duration::from_millis(20));
        Ok(())
    });
    let rendering = run(&slow, &settings(Budget::Time(Duration::from_millis(1))));
    assert_eq!((rendering.passes, rendering.interrupted), (2, false));
    assert!(rendering.elapsed >= Duration::from_millis(40));
    assert!(rendering.preparing >= Duration::from_millis(40), "there were no tiles");
}
#[test]
fn what_comes_before_the_tiles_is_told_apart_from_them() {
    let method = Toy(|film: &mut Film, probe: &mut Probe| {
        std::thread::sleep(Duration::from_millis(30));
        film.fill(probe, &|_, _, _| Spectrum::ONE);
        std::thread::sleep(Duration::from_millis(100));
        Ok(())
    });
    let rendering = run(&method, &settings(Budget::Passes(2)));
    assert!((60..160).contains(&rendering.preparing.as_millis()), "{:?}", rendering.preparing);
    assert!(rendering.elapsed >= Duration::from_millis(260));
}
#[test]
fn a_time_is_spent_and_not_much_exceeded() {
    let slow = Toy(|_: &mut Film, _: &mut Probe| {
        std::thread::sleep(Duration::from_millis(10));
        Ok(())
    });
    let rendering = run(&slow, &settings(Budget::Time(Duration::from_millis(200))));
    // Generous above: the machine may have other things to do.
    assert!((180..1000).contains(&rendering.elapsed.as_millis()), "{:?}", rendering.elapsed);
    assert!((3..=20).contains(&rendering.passes), "{}", rendering.passes);
}

#[test]
fn what_is_complete_when_cancelled_is_the_result() {
    let cancel = Arc::new(AtomicBool::new(false));
    let mut stop_after_three = |p: &Progress| cancel.store(p.passes == 3, Relaxed);
    let rendering = render(&scene(), &Noise, &settings(Budget::Passes(100)), &mut stop_after_three, &cancel).unwrap();
    assert_eq!((rendering.passes, rendering.interrupted), (3, true));
    let three = run(&Noise, &settings(Budget::Passes(3)));
    assert_eq!(rendering.image, three.image);
    assert_eq!(rendering.probe.camera_rays, three.probe.camera_rays, "the pass thrown away is not counted");
}
#[test]
fn cancelled_in_the_first_pass_the_part_that_is_done_is_the_result() {
    let cancel = Arc::new(AtomicBool::new(false));
    let method = Toy(|film: &mut Film, probe: &mut Probe| {
        film.fill(probe, &|_, _, s| {
            cancel.fetch_or(s.next_below(300) == 0, Relaxed);
            Spectrum::ONE
        });
        Ok(())
    });
    let one_thread = Settings { threads: Some(1), ..settings(Budget::Passes(5)) };
    let rendering = render(&scene(), &method, &one_thread, &mut |_: &Progress| (), &cancel).unwrap();
    assert_eq!((rendering.passes, rendering.interrupted), (0, true));
    assert_eq!((rendering.standard_error, rendering.estimated_error), (None, None));
    let done = rendering.image.pixels.iter().filter(|p| **p == Spectrum::ONE).count();
    assert!(done > 0 && done < rendering.image.pixels.len(), "{done} pixels");
    assert_eq!(rendering.probe.camera_rays, 2 * done as u64);
}
#[test]
fn whoever_cancels_does_not_wait_for_a_tile() {
    let cancel = Arc::new(AtomicBool::new(false));
    let method = Toy(|film: &mut Film, probe: &mut Probe| {
        film.fill(probe, &|_, _, _| {
            cancel.store(true, Relaxed);
            Spectrum::ONE
        });
        Ok(())
    });
    let one_thread = Settings { threads: Some(1), ..settings(Budget::Passes(5)) };
    let rendering = render(&scene(), &method, &one_thread, &mut |_: &Progress| (), &cancel).unwrap();
    assert_eq!(rendering.image.pixels.iter().filter(|p| **p == Spectrum::ONE).count(), 1);
}
#[test]
fn cancelled_before_it_begins_it_ends_with_a_black_image() {
    let rendering = render(
        &scene(),
        &Noise,
        &settings(Budget::Passes(5)),
        &mut |_: &Progress| (),
        &Arc::new(AtomicBool::new(true)),
    );
    let rendering = rendering.unwrap();
    assert_eq!((rendering.passes, rendering.interrupted), (0, true));
    assert!(rendering.image.pixels.iter().all(|p| p.is_black()));
}
#[test]
fn cancelled_after_its_last_tile_a_pass_is_complete() {
    let cancel = Arc::new(AtomicBool::new(false));
    let method = Toy(|film: &mut Film, probe: &mut Probe| {
        Noise.pass(&scene(), film, probe)?;
        cancel.store(film.pass == 1, Relaxed);
        Ok(())
    });
    let rendering = render(&scene(), &method, &settings(Budget::Passes(2)), &mut |_: &Progress| (), &cancel).unwrap();
    assert_eq!((rendering.passes, rendering.interrupted), (2, false));
    cancel.store(false, Relaxed);
    let rendering = render(&scene(), &method, &settings(Budget::Passes(9)), &mut |_: &Progress| (), &cancel).unwrap();
    assert_eq!((rendering.passes, rendering.interrupted), (2, true));
}
#[test]
fn a_method_that_gives_up_when_cancelled_has_not_failed() {
    let cancel = Arc::new(AtomicBool::new(false));
    let method = Toy(|film: &mut Film, probe: &mut Probe| {
        if film.pass == 1 {
            cancel.store(true, Relaxed);
        }
        if film.scheduler().cancelled() {
            return Err(PassError::NotCompensable);
        }
        Noise.pass(&scene(), film, probe)
    });
    let rendering = render(&scene(), &method, &settings(Budget::Passes(9)), &mut |_: &Progress| (), &cancel).unwrap();
    assert_eq!((rendering.passes, rendering.interrupted), (1, true));
}
#[test]
fn a_method_that_fails_says_why_and_one_that_changes_the_size_is_found_out() {
    let fails = Toy(|_: &mut Film, _: &mut Probe| Err(PassError::MergesDepths));
    let go = |method: &dyn Method| {
        render(&scene(), method, &settings(Budget::Passes(2)), &mut |_: &Progress| (), &Arc::default())
    };
    assert!(go(&fails).unwrap_err().to_string().contains("depths"));
    let shrinks = Toy(|film: &mut Film, _: &mut Probe| {
        film.image = Image::new(1, 1);
        Ok(())
    });
    assert!(matches!(go(&shrinks), Err(RenderError::Size { .. })));
}

#[test]
fn samples_that_are_not_finite_are_counted_and_their_places_told() {
    let method = Toy(|film: &mut Film, probe: &mut Probe| {
        let bad = AtomicBool::new(film.pass == 1);
        film.fill(probe, &|ray, _, _| {
            let middle = ray.dir.x.abs() < 0.005 && ray.dir.y.abs() < 0.005;
            Spectrum::gray(if middle && bad.load(Relaxed) { f32::NAN } else { 1.0 })
        });
        Ok(())
    });
    let settings = Settings { spp: 64, ..settings(Budget::Passes(3)) };
    let rendering = run(&method, &settings);
    assert!(rendering.image.pixels.iter().all(|p| p.is_finite()));
    let stats = Stats::new(&subject(), &settings, &rendering);
    assert!(stats.non_finite.count > 0);
    let SampleAt { pass, x, y, .. } = stats.non_finite.first[0];
    assert_eq!((pass, y), (1, 11), "the middle row, in the second pass");
    assert!((19..=20).contains(&x), "{x}");
    let shown = stats.non_finite.first[0].to_string();
    assert!(shown.starts_with(&format!("pixel {x},11, pass 1, sample ")), "{shown}");
}

fn subject() -> Subject {
    Subject {
        method: "noise".into(),
        parameters: vec![("paths".into(), "8".into()), ("bound".into(), "none".into())],
        claim: "unbiased".into(),
        scene_hash: 0xabc,
        load: Duration::from_millis(1500),
        build: Duration::ZERO,
    }
}
#[test]
fn statistics_are_written_as_json_and_into_the_header() {
    let settings = Settings { seed: u64::MAX, ..settings(Budget::Passes(2)) };
    let stats = Stats::new(&subject(), &settings, &run(&Noise, &settings));
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.json");
    stats.write(&path).unwrap();
    let json: serde_json::Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    assert_eq!(json["seed"].as_u64(), Some(u64::MAX));
    assert_eq!(json["parameters"]["paths"], "8");
    assert_eq!(json["scene_hash"], "0000000000000abc");
    assert_eq!(json["seconds"]["load"], 1.5);
    assert_eq!(json["rays"]["camera"].as_u64(), Some(2 * 2 * u64::from(SIZE.0 * SIZE.1)));
    use manylight_render::files::{
        Attribute::{Number, Text},
        Picture, read_exr, write_exr,
    };
    let picture = Picture { attributes: stats.attributes(), ..Image::new(1, 1).into() };
    let path = directory.path().join("a.exr");
    write_exr(&path, &picture).unwrap();
    let header = read_exr(&path).unwrap().attributes;
    assert_eq!(header, picture.attributes);
    assert_eq!(header["seed"], Text(u64::MAX.to_string()));
    assert_eq!(header["parameters"], Text("bound=none paths=8".into()));
    assert_eq!(header["passes"], Number(2.0));
    let Number(seconds) = header["seconds"] else { panic!("seconds are a number") };
    assert!(seconds > 0.0 && seconds < 1.5, "without loading the scene: {seconds}");
}
#[test]
fn one_pass_has_neither_error_nor_null_in_its_statistics() {
    let settings = settings(Budget::Passes(1));
    let stats = Stats::new(&subject(), &settings, &run(&Noise, &settings));
    let json = serde_json::to_string(&stats).unwrap();
    assert!(!json.contains("estimated_error") && !json.contains("null"), "{json}");
}

#[test]
fn sessions_that_take_turns_are_renderings_on_their_own_and_count_their_own_time_alone() {
    let (scene, settings) = (scene(), settings(Budget::Passes(5)));
    let slow = Toy(|film: &mut Film, probe: &mut Probe| {
        std::thread::sleep(Duration::from_millis(20));
        Noise.pass(&self::scene(), film, probe)
    });
    let mut turns = [&Noise as &dyn Method, &slow].map(|m| Session::new(&scene, m, &settings).unwrap());
    for _ in 0..5 {
        for session in &mut turns {
            assert!(session.step(&mut |_: &Progress| (), &Arc::default()).unwrap().is_some());
        }
    }
    let [quick, slow] = turns.map(|s| s.rendering());
    let alone = run(&Noise, &settings);
    assert_eq!((hash(&quick.image), quick.probe.rays(), quick.passes), (hash(&alone.image), alone.probe.rays(), 5));
    assert_eq!(quick.estimated_error, alone.estimated_error);
    assert!(slow.elapsed >= Duration::from_millis(100) && quick.elapsed < slow.elapsed, "{:?}", quick.elapsed);
}
